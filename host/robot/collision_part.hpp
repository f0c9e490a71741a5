// A link or an obstacle as FCL sees it: its triangles in a tree of boxes, and a ball around them.
#pragma once
#include <fcl/geometry/bvh/BVH_model.h>

#include <memory>
#include <string>

#include "host/model/scene.hpp"

namespace pvg {

struct CollisionPart {
  std::string name;
  int link = -1;                 // that it moves with; -1: it stands still
  Pose pose = Pose::Identity();  // to the link; of what stands still to the base
  std::shared_ptr<fcl::BVHModel<fcl::OBBRSSd>> model;
  Vec3 center = Vec3::Zero();  // of a ball around it, in its frame [m]
  double radius = 0;           // [m]
};

CollisionPart make_collision_part(const std::string& name, int link, const Pose& pose, const TriangleMesh& mesh);

// Whether two surfaces, each with the pose of its part's frame, are closer than the clearance [m].
bool are_closer(const CollisionPart& first, const Pose& first_pose, const CollisionPart& second,
                const Pose& second_pose, double clearance);

}  // namespace pvg
