#include "host/robot/collision_part.hpp"

#include <fcl/narrowphase/distance.h>

#include <algorithm>

namespace pvg {

CollisionPart make_collision_part(const std::string& name, int link, const Pose& pose, const TriangleMesh& mesh) {
  CollisionPart part{name, link, pose, std::make_shared<fcl::BVHModel<fcl::OBBRSSd>>()};
  Eigen::AlignedBox3d box;
  for (const Vec3& point : mesh.points) box.extend(point);
  part.center = box.center();
  for (const Vec3& point : mesh.points) part.radius = std::max(part.radius, (point - part.center).norm());
  std::vector<fcl::Triangle> triangles;
  for (const Triangle& t : mesh.triangles) triangles.emplace_back(t[0], t[1], t[2]);
  part.model->beginModel(int(triangles.size()), int(mesh.points.size()));
  part.model->addSubModel(mesh.points, triangles);
  part.model->endModel();
  return part;
}

bool are_closer(const CollisionPart& first, const Pose& first_pose, const CollisionPart& second,
                const Pose& second_pose, double clearance) {
  // by the balls around both, which are far apart most of the time
  const double apart = (first_pose * first.center - second_pose * second.center).norm();
  if (apart > first.radius + second.radius + clearance) return false;
  const fcl::DistanceRequestd request;
  fcl::DistanceResultd result;
  return !(fcl::distance(first.model.get(), first_pose, second.model.get(), second_pose, request, result) >= clearance);
}

}  // namespace pvg
