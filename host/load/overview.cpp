#include "host/load/overview.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "host/formats/mesh_files.hpp"

namespace pvg {
namespace {

constexpr double FIELD_OF_VIEW = 0.6;  // of the camera, vertical [rad]

VisualMaterial body_material(std::size_t i) {
  // hues a golden angle apart, so that neighbours in the list differ
  const double hue = 2.39996 * double(i);
  VisualMaterial material;
  material.name = "body " + std::to_string(i);
  material.color =
      Vec3(0.45 + 0.25 * std::cos(hue), 0.45 + 0.25 * std::cos(hue + 2.0944), 0.45 + 0.25 * std::cos(hue + 4.18879))
          .cast<float>();
  return material;
}

// of everything but half-spaces, at the start
Eigen::AlignedBox3d bounds(const Scene& scene) {
  Eigen::AlignedBox3d box;
  for (const RigidBody& body : scene.rigid_bodies)
    if (!body.is_half_space)
      for (const Vec3& point : body.collision.points) box.extend(body.pose * point);
  for (const auto& [rigid, surface] : scene.passing_surfaces)
    for (const Vec3& point : surface.points) box.extend(scene.rigid_bodies[std::size_t(rigid)].pose * point);
  for (const SoftBody& body : scene.soft_bodies)
    for (const Vec3& point : body.mesh.points) box.extend(body.pose * point);
  for (const Cloth& cloth : scene.cloths)
    for (const Vec3& point : cloth.mesh.points) box.extend(cloth.pose * point);
  for (const Visual& visual : scene.visuals) {
    if (visual.mesh < 0 || visual.soft >= 0 || !visual.casts_shadow_on_receivers) continue;
    const Pose pose =
        visual.rigid >= 0 ? scene.rigid_bodies[std::size_t(visual.rigid)].pose * visual.pose : visual.pose;
    for (const Vec3f& point : scene.visual_meshes[std::size_t(visual.mesh)].points)
      box.extend(pose * point.cast<double>());
  }
  if (box.isEmpty()) box.extend(Vec3::Constant(-0.5)), box.extend(Vec3::Constant(0.5));
  return box;
}

TriangleMesh square(double half) {
  return {{{-half, -half, 0}, {half, -half, 0}, {half, half, 0}, {-half, half, 0}}, {{0, 1, 2}, {0, 2, 3}}};
}

void add_visual(Scene& scene, const std::string& name, int rigid, int soft, int cloth, const TriangleMesh* surface) {
  Visual visual;
  visual.name = visual.part = name;
  visual.material = int(scene.materials.size());
  scene.materials.push_back(body_material(scene.visuals.size()));
  visual.rigid = rigid;
  visual.soft = soft;
  visual.cloth = cloth;
  visual.subdivision_levels = 0;
  if (surface) {
    visual.mesh = int(scene.visual_meshes.size());
    scene.visual_meshes.push_back(visual_of(*surface));
  }
  scene.visuals.push_back(visual);
}

void add_visuals(Scene& scene, double radius) {
  for (int i = 0; i < int(scene.rigid_bodies.size()); ++i) {
    const RigidBody& body = scene.rigid_bodies[std::size_t(i)];
    const TriangleMesh ground = square(6 * radius);
    const TriangleMesh* surface = body.is_half_space ? &ground : &body.collision;
    if (!surface->triangles.empty()) add_visual(scene, body.name, i, -1, -1, surface);
  }
  for (const auto& [rigid, surface] : scene.passing_surfaces)
    add_visual(scene, scene.rigid_bodies[std::size_t(rigid)].name, rigid, -1, -1, &surface);
  for (int i = 0; i < int(scene.soft_bodies.size()); ++i)
    add_visual(scene, scene.soft_bodies[std::size_t(i)].name, -1, i, -1, nullptr);
  for (int i = 0; i < int(scene.cloths.size()); ++i)
    add_visual(scene, scene.cloths[std::size_t(i)].name, -1, -1, i, nullptr);
}

void add_camera(Scene& scene, const Vec3& center, double radius) {
  Camera camera;
  camera.name = "overview";
  camera.width = 640;
  camera.height = 360;
  camera.fx = camera.fy = camera.height / 2.0 / std::tan(FIELD_OF_VIEW / 2);
  camera.cx = (camera.width - 1) / 2.0;
  camera.cy = (camera.height - 1) / 2.0;
  const Vec3 back = Vec3(0.5, -1, 0.45).normalized();
  Mat3 axes;
  axes.col(2) = -back;
  axes.col(0) = axes.col(2).cross(Vec3::UnitZ()).normalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  camera.pose.linear() = axes;
  camera.pose.translation() = center + back * (radius / std::sin(FIELD_OF_VIEW / 2));
  scene.cameras.push_back(camera);
}

void add_light(Scene& scene, const Vec3& center, double radius) {
  RectangleLight lamp;
  lamp.name = "lamp";
  lamp.edge_u = Vec3(0, 3 * radius, 0);
  lamp.edge_v = Vec3(3 * radius, 0, 0);
  lamp.corner = center + radius * Vec3(-3, -2.5, 6) - (lamp.edge_u + lamp.edge_v) / 2;
  lamp.radiance = Vec3f::Constant(7);
  scene.lights.push_back(lamp);
  scene.environment = Vec3f(0.45f, 0.5f, 0.58f);
}

bool has_light(const Scene& scene) {
  // a lamp of a glTF file shines and reflects nothing
  const auto shines = [](const VisualMaterial& material) {
    return material.kind == VisualMaterial::Kind::emissive || material.kind == VisualMaterial::Kind::shadow_receiver ||
           (material.emission.maxCoeff() > 0 && material.color.isZero());
  };
  return !scene.lights.empty() || !scene.sphere_lights.empty() || scene.environment.maxCoeff() > 0 ||
         std::any_of(scene.visuals.begin(), scene.visuals.end(), [&](const Visual& visual) {
           return visual.material >= 0 && shines(scene.materials[std::size_t(visual.material)]);
         });
}

}  // namespace

std::vector<std::string> complete_for_viewing(Scene& scene) {
  std::vector<std::string> added;
  const Eigen::AlignedBox3d box = bounds(scene);
  const double radius = std::max(1e-3, box.diagonal().norm() / 2);
  if (scene.visuals.empty()) {
    add_visuals(scene, radius);
    added.push_back("the scene has no visuals: the shapes of its bodies are shown");
  }
  if (scene.cameras.empty()) {
    add_camera(scene, box.center(), radius);
    added.push_back("the scene has no cameras: one named overview sees all of it at the start");
  }
  if (!has_light(scene)) {
    add_light(scene, box.center(), radius);
    added.push_back("the scene has no light: a lamp above and an even sky are added");
  }
  return added;
}

}  // namespace pvg
