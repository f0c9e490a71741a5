// Small scenes that several tests of the simulator share: boxes, a rod on a hinge, a box on a rail.
#pragma once
#include "host/physics/step/simulation.hpp"

namespace pvg {

// a box with corners at +-half, 12 triangles facing outward
inline TriangleMesh box_mesh(const Vec3& half) {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.points.push_back(Vec3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1).cwiseProduct(half));
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

inline RigidBody box_body(const std::string& name, const Vec3& half, double density, const Vec3& at) {
  RigidBody body;
  body.name = name;
  body.collision = box_mesh(half);
  body.volume = 8 * half.prod();
  body.mass = density * body.volume;
  const Vec3 square = half.cwiseProduct(half);
  body.inertia =
      body.mass / 3 * Vec3(square.y() + square.z(), square.x() + square.z(), square.x() + square.y()).asDiagonal();
  body.pose.translation() = at;
  return body;
}

inline RigidBody fixed_box(const std::string& name, const Vec3& half, const Vec3& at) {
  RigidBody body = box_body(name, half, 1000, at);
  body.is_fixed = true;
  return body;
}

inline PhysicalScene empty_scene(const std::string& name, double time_step) {
  PhysicalScene scene;
  scene.name = name;
  scene.solver.time_step = time_step;
  scene.solver.velocity_tolerance = 1e-7;
  scene.solver.cg_tolerance = 1e-8;
  return scene;
}

// a rod of 0.16 kg and 0.4 m hanging from a hinge about y at its end, turned by `angle` [rad]
inline PhysicalScene rod_on_hinge(double angle, const Joint& like) {
  PhysicalScene scene = empty_scene("rod", 0.005);
  RigidBody rod = box_body("rod", Vec3(0.01, 0.01, 0.2), 1000, Vec3::Zero());
  const Mat3 turn = Eigen::AngleAxisd(angle, Vec3::UnitY()).toRotationMatrix();
  rod.pose.linear() = turn;
  rod.pose.translation() = Vec3(0, 0, 1) + turn * Vec3(0, 0, -0.2);
  scene.rigid_bodies = {fixed_box("base", Vec3::Constant(0.01), Vec3(0, 0, 1)), rod};
  Joint joint = like;
  joint.name = "hinge";
  joint.type = Joint::Type::revolute;
  joint.parent = 0;
  joint.child = 1;
  joint.child_frame.translation() = Vec3(0, 0, 0.2);
  joint.axis = Vec3::UnitY();
  joint.initial = angle;
  scene.joints = {joint};
  return scene;
}

// a box of 1 kg on a rail along z through its centre, where q = 0
inline PhysicalScene box_on_rail(const Joint& like) {
  PhysicalScene scene = empty_scene("rail", 0.01);
  scene.rigid_bodies = {fixed_box("base", Vec3::Constant(0.01), Vec3::Zero()),
                        box_body("box", Vec3::Constant(0.05), 1000, Vec3::Zero())};
  Joint joint = like;
  joint.name = "rail";
  joint.type = Joint::Type::prismatic;
  joint.parent = 0;
  joint.child = 1;
  scene.joints = {joint};
  return scene;
}

}  // namespace pvg
