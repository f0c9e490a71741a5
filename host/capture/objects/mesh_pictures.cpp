#include "host/capture/objects/mesh_pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host/capture/objects/thickness.hpp"
#include "host/capture/surface_views.hpp"
#include "host/formats/pixel_font.hpp"
#include "host/pictures/srgb.hpp"

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

constexpr int SCALE_WIDTH = 110, BAR_LEFT = 14, BAR_WIDTH = 20, BAR_TOP = 30, BAR_BOTTOM = 300;  // [pixels]
constexpr double THICKEST = 100;  // of the scale, in distances of contact
constexpr double THINNEST = 0.3;

// sRGB
Vec3f thickness_color(double thickness, double reach) {
  if (thickness < reach) return {0.85f, 0.1f, 0.1f};
  const Vec3f stops[] = {{0.98f, 0.85f, 0.2f}, {0.25f, 0.7f, 0.4f}, {0.15f, 0.25f, 0.6f}};
  const double at = 2 * std::clamp(std::log(thickness / reach) / std::log(THICKEST), 0.0, 1.0);
  const std::size_t first = at < 1 ? 0 : 1;
  return stops[first] + float(at - double(first)) * (stops[first + 1] - stops[first]);
}

// each triangle by itself, darker where it leans away from the one who looks along -out or out
VisualMesh thickness_facets(const VisualMesh& visual, const std::vector<WallThickness>& walls, double reach,
                            const Vec3& out) {
  VisualMesh facets;
  for (const Triangle& t : visual.triangles) {
    const Vec3f &a = visual.points[t[0]], &b = visual.points[t[1]], &c = visual.points[t[2]];
    const Vec3f normal = (b - a).cross(c - a);
    if (!(normal.norm() > 0)) continue;
    const Vec3 middle = ((a + b + c) / 3).cast<double>();
    double least = INFINITY, thickness = 0;
    for (const WallThickness& wall : walls)
      if (const double d = (wall.place - middle).squaredNorm(); d < least) {
        least = d;
        thickness = wall.thickness;
      }
    const float light = 0.55f + 0.45f * std::abs(normal.normalized().dot(out.cast<float>()));
    const Vec3f color = (light * thickness_color(thickness, reach)).unaryExpr(&srgb_to_linear);
    const auto first = std::uint32_t(facets.points.size());
    facets.points.insert(facets.points.end(), {a, b, c});
    facets.colors.insert(facets.colors.end(), 3, color);
    facets.triangles.push_back({first, first + 1, first + 2});
  }
  return facets;
}

void draw_scale(Picture8& picture, int left, double reach) {
  constexpr Color8 INK = {30, 30, 30};
  const auto row_of = [](double ratio) {
    const double share = std::log(ratio / THINNEST) / std::log(THICKEST / THINNEST);
    return BAR_BOTTOM - int(std::lround(share * (BAR_BOTTOM - BAR_TOP)));
  };
  for (int y = BAR_TOP; y <= BAR_BOTTOM; ++y) {
    const double ratio = THINNEST * std::pow(THICKEST / THINNEST, double(BAR_BOTTOM - y) / (BAR_BOTTOM - BAR_TOP));
    const Vec3f color = thickness_color(ratio * reach, reach);
    for (int x = 0; x < BAR_WIDTH; ++x)
      for (int k = 0; k < 3; ++k)
        picture.rgb[std::size_t((y * picture.width + left + BAR_LEFT + x) * 3 + k)] = std::uint8_t(255 * color[k]);
  }
  draw_text(picture, left + BAR_LEFT, 8, "wall, mm", 1, INK);
  for (const double ratio : {1.0, 3.0, 10.0, 30.0, 100.0})
    draw_text(picture, left + BAR_LEFT + BAR_WIDTH + 6, row_of(ratio) - 3, fmt::format("{:.3g}", 1e3 * ratio * reach),
              1, INK);
}

}  // namespace

Picture8 picture_of_thickness(Device& device, const VisualMesh& visual, const TriangleMesh& simulation, double reach) {
  const std::vector<WallThickness> walls = wall_thickness(simulation);
  const EnclosingBall ball = ball_around(visual, simulation);
  Picture8 picture{MESH_WIDTH + SCALE_WIDTH, MESH_HEIGHT, {}};
  picture.rgb.assign(std::size_t(picture.width * picture.height) * 3, 235);
  for (const double side : {1.0, -1.0}) {  // from the front above, then from behind below
    const Vec3 out = side * Vec3(0.5, -0.8, 0.45).normalized(), right = Vec3::UnitZ().cross(out).normalized();
    const CapturedSurface surface{thickness_facets(visual, walls, reach, out), {}};
    Camera camera = mesh_camera(ball, out, right);
    camera.width = MESH_WIDTH / 2;
    camera.cx = 0.5 * (camera.width - 1);
    Scene scene = scene_of({&surface, 1}, VisualMaterial::Kind::shadow_receiver, {&camera, 1});
    RenderSettings settings;
    settings.max_depth = 1;
    Renderer renderer(device, scene, settings);
    renderer.set_state(initial_state(scene));
    const RenderedFrame frame = renderer.render(0, 0);
    const Picture8 seen = encode_srgb8(frame.rgb, frame.width, frame.height);
    const int left = side > 0 ? 0 : MESH_WIDTH / 2;
    for (int y = 0; y < seen.height; ++y)
      for (int x = 0; x < seen.width; ++x) {
        const std::size_t from = std::size_t(y * seen.width + x), to = std::size_t(y * picture.width + left + x);
        if (std::isfinite(frame.depth[from]) && frame.depth[from] > 0)
          std::copy_n(&seen.rgb[3 * from], 3, &picture.rgb[3 * to]);
      }
  }
  draw_scale(picture, MESH_WIDTH, reach);
  return picture;
}

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
