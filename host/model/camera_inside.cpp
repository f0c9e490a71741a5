#include "host/model/camera_inside.hpp"

#include <Eigen/Geometry>

#include "host/geometry/inside.hpp"

namespace pvg {
namespace {

bool is_opaque(const VisualMaterial& material) {
  return !transmits(material) && material.alpha_mode == VisualMaterial::AlphaMode::opaque;
}

// p: in the frame of the mesh. Only a closed mesh goes around a point once as a whole.
bool is_inside(const VisualMesh& mesh, const Vec3& p) {
  Eigen::AlignedBox3f box;
  for (const Vec3f& point : mesh.points) box.extend(point);
  if (!box.contains(p.cast<float>())) return false;
  std::vector<Vec3> points;
  for (const Vec3f& point : mesh.points) points.push_back(point.cast<double>());
  return winding_number(points, mesh.triangles, p) > 0.99;
}

}  // namespace

std::vector<std::string> cameras_inside(const Scene& scene) {
  const auto body_pose = [&](int rigid) { return scene.rigid_bodies[std::size_t(rigid)].pose; };
  std::vector<std::string> sentences;
  for (const Camera& camera : scene.cameras) {
    const Vec3 place = (camera.rigid >= 0 ? body_pose(camera.rigid) * camera.pose : camera.pose).translation();
    for (const Visual& visual : scene.visuals) {
      if (visual.mesh < 0 || visual.rigid < 0 || visual.material < 0) continue;
      if (!is_opaque(scene.materials[std::size_t(visual.material)])) continue;
      const Pose pose = body_pose(visual.rigid) * visual.pose;
      if (!is_inside(scene.visual_meshes[std::size_t(visual.mesh)], pose.inverse() * place)) continue;
      sentences.push_back("camera " + camera.name + " is inside of `" +
                          scene.rigid_bodies[std::size_t(visual.rigid)].name +
                          "`, which is opaque, and sees nothing else; move one of the two");
      break;
    }
  }
  return sentences;
}

}  // namespace pvg
