#include "host/capture/objects/mesh_pictures.hpp"

#include "host/capture/surface_views.hpp"

namespace pvg {
namespace {

constexpr int MESH_WIDTH = 640, MESH_HEIGHT = 320;  // of the picture, a square for each mesh [pixels]
constexpr double APART = 1.1;                       // of each mesh's middle from the picture's, in radii
constexpr double EYE = 8;                           // distance of the camera, in radii

struct EnclosingBall {
  Vec3 center;
  double radius = 0;
};

EnclosingBall ball_around(const VisualMesh& visual, const TriangleMesh& simulation) {
  Vec3 low = Vec3::Constant(INFINITY), high = -low;
  const auto add = [&](const Vec3& p) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  };
  for (const Vec3f& p : visual.points) add(p.cast<double>());
  for (const Vec3& p : simulation.points) add(p);
  return {0.5 * (low + high), 0.5 * (high - low).norm()};
}

// Looks at the middle along -out, level, so that 2 APART radii fill half of the width.
Camera mesh_camera(const EnclosingBall& ball, const Vec3& out, const Vec3& right) {
  Camera camera;
  camera.name = "meshes";
  camera.width = MESH_WIDTH;
  camera.height = MESH_HEIGHT;
  camera.cx = 0.5 * (MESH_WIDTH - 1);
  camera.cy = 0.5 * (MESH_HEIGHT - 1);
  camera.fx = camera.fy = EYE * 0.5 * MESH_WIDTH / (2 * APART);
  camera.pose.linear().col(0) = right;
  camera.pose.linear().col(1) = right.cross(out);
  camera.pose.linear().col(2) = -out;
  camera.pose.translation() = ball.center + EYE * ball.radius * out;
  return camera;
}

// a square of four radii above and in front, toward the middle
RectangleLight mesh_light(const EnclosingBall& ball) {
  const Vec3 from = Vec3(0.3, -0.8, 1).normalized(), u = from.unitOrthogonal(), v = u.cross(from);
  const double side = 4 * ball.radius;
  RectangleLight light;
  light.name = "light";
  light.corner = ball.center + 6 * ball.radius * from - 0.5 * side * (u + v);
  light.edge_u = side * u;
  light.edge_v = side * v;
  light.radiance = Vec3f::Constant(4);
  return light;
}

}  // namespace

Picture8 picture_of_meshes(Device& device, const VisualMesh& visual, const TriangleMesh& simulation) {
  const EnclosingBall ball = ball_around(visual, simulation);
  const Vec3 out = Vec3(0.5, -0.8, 0.45).normalized(), right = Vec3::UnitZ().cross(out).normalized();
  VisualMesh fine = visual, coarse;
  const Vec3f aside = (APART * ball.radius * right).cast<float>();
  for (Vec3f& p : fine.points) p -= aside;
  for (const Vec3& p : simulation.points) coarse.points.push_back(p.cast<float>() + aside);
  coarse.triangles = simulation.triangles;
  coarse.colors.assign(coarse.points.size(), Vec3f(0.3f, 0.45f, 0.7f));
  if (fine.colors.empty()) fine.colors.assign(fine.points.size(), Vec3f::Constant(0.7f));
  const CapturedSurface surfaces[] = {{fine, {}}, {coarse, {}}};
  const Camera camera = mesh_camera(ball, out, right);
  Scene scene = scene_of(surfaces, VisualMaterial::Kind::diffuse, {&camera, 1});
  scene.environment = Vec3f::Constant(0.35f);
  scene.lights = {mesh_light(ball)};
  RenderSettings settings;
  settings.max_depth = 3;
  Renderer renderer(device, scene, settings);
  renderer.set_state(initial_state(scene));
  const RenderedFrame frame = renderer.render(0, 0);
  return encode_srgb8(frame.rgb, frame.width, frame.height);
}

}  // namespace pvg
