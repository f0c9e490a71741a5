// The main job's physics, without pictures: the arm grasps the beaker, lifts it and waits. Checked at every step: no
// intersection by the exact test, no inverted tetrahedron; at the end: what the joints feel of the beaker's weight.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "host/geometry/exact_intersection.hpp"
#include "host/geometry/tet_mesh.hpp"
#include "host/load/build_scene.hpp"
#include "host/load/task_file.hpp"
#include "host/physics/step/simulation.hpp"
#include "pipeline/episode/motion_plan.hpp"

namespace pvg {
namespace {

// up to the lift, then half a second of rest and more
Task grasp_task() {
  Task task = load_task(PVG_DATA_FOLDER "/tasks/weigh_beaker.yaml");
  std::vector<MotionElement> motion;
  for (MotionElement element : task.motion) {
    if (element.type == MotionElement::Type::carry) break;
    if (element.type == MotionElement::Type::approach) element.speed = 0.8;
    motion.push_back(element);
  }
  MotionElement wait;
  wait.type = MotionElement::Type::wait;
  wait.duration = 0.6;
  motion.push_back(wait);
  task.motion = motion;
  return task;
}

int body_named(const Scene& scene, const std::string& name) {
  for (std::size_t b = 0; b < scene.rigid_bodies.size(); ++b)
    if (scene.rigid_bodies[b].name == name) return int(b);
  return -1;
}

// Every collision surface of a scene in one list; connectivity once, points anew for each state.
struct Surfaces {
  explicit Surfaces(const Scene& scene) : scene(scene), n_rigid(scene.rigid_bodies.size()) {
    std::uint32_t first = 0;
    for (std::size_t b = 0; b < n_rigid + scene.soft_bodies.size(); ++b) {
      const bool is_rigid = b < n_rigid;
      const auto& surface =
          is_rigid ? scene.rigid_bodies[b].collision.triangles : scene.soft_bodies[b - n_rigid].mesh.surface;
      const std::size_t n =
          is_rigid ? scene.rigid_bodies[b].collision.points.size() : scene.soft_bodies[b - n_rigid].mesh.points.size();
      std::vector<bool> is_stitched(n, false);
      for (const Stitch& stitch : scene.stitches)
        for (const std::uint32_t node : stitch.nodes)
          if (!is_rigid && std::size_t(stitch.soft) == b - n_rigid) is_stitched[node] = true;
      for (const Triangle& t : surface) {
        triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
        triangle_body.push_back(b);
        triangle_is_stitched.push_back(is_stitched[t[0]] || is_stitched[t[1]] || is_stitched[t[2]]);
        for (int k = 0; k < 3; ++k) {
          edges.push_back({t[k] + first, t[(k + 1) % 3] + first});
          edge_body.push_back(b);
          edge_is_stitched.push_back(is_stitched[t[k]] || is_stitched[t[(k + 1) % 3]]);
        }
      }
      first += std::uint32_t(n);
    }
  }
  std::vector<Vec3> points(const SceneState& state) const {
    std::vector<Vec3> all;
    for (std::size_t b = 0; b < n_rigid; ++b)
      for (const Vec3& x : scene.rigid_bodies[b].collision.points)
        all.push_back(state.rigid[b].leftCols<3>() * x + state.rigid[b].col(3));
    for (const auto& soft : state.soft) all.insert(all.end(), soft.begin(), soft.end());
    return all;
  }
  // jointed links overlap by construction, stitched elements where they are stitched; nothing else is left out
  bool is_excluded(std::uint32_t edge, std::uint32_t triangle) const {
    const int a = int(edge_body[edge]), b = int(triangle_body[triangle]), n = int(n_rigid);
    if (a == b) return a < n;  // soft bodies must not cut themselves either
    const auto is_pair = [&](int i, int j) { return (i == a && j == b) || (i == b && j == a); };
    for (const Joint& joint : scene.joints)
      if (is_pair(joint.parent, joint.child)) return true;
    for (const auto& [i, j] : scene.noncolliding_rigid_bodies)
      if (is_pair(i, j)) return true;
    for (const Stitch& stitch : scene.stitches)
      if (is_pair(stitch.rigid, n + stitch.soft) && (edge_is_stitched[edge] || triangle_is_stitched[triangle]))
        return true;
    return scene.rigid_bodies.size() > std::size_t(std::max(a, b)) && scene.rigid_bodies[a].is_fixed &&
           scene.rigid_bodies[b].is_fixed;
  }

  const Scene& scene;
  std::size_t n_rigid;
  std::vector<Edge> edges;
  std::vector<Triangle> triangles;
  std::vector<std::size_t> edge_body, triangle_body;
  std::vector<bool> edge_is_stitched, triangle_is_stitched;
};

void expect_no_intersection(const Surfaces& surfaces, const SceneState& state, int step) {
  const auto found = find_intersection(surfaces.points(state), surfaces.edges, surfaces.triangles,
                                       [&](auto edge, auto triangle) { return surfaces.is_excluded(edge, triangle); });
  EXPECT_FALSE(found.has_value()) << "step " << step << ", bodies " << (found ? surfaces.edge_body[found->edge] : 0)
                                  << " and " << (found ? surfaces.triangle_body[found->triangle] : 0);
}

void expect_upright_tetrahedra(const Scene& scene, const SceneState& state, int step) {
  for (std::size_t b = 0; b < scene.soft_bodies.size(); ++b) {
    TetMesh mesh = scene.soft_bodies[b].mesh;
    mesh.points = state.soft[b];
    for (const double volume : element_volumes(mesh)) ASSERT_GT(volume, 0) << scene.soft_bodies[b].name << " " << step;
  }
}

// effort of each arm joint, averaged over the last five steps
std::vector<double> settled_efforts(Device& device, const Scene& scene, const MotionPlan& plan,
                                    const std::vector<int>& arm_joints, bool checks, WorldState& last) {
  Simulation simulation(device, scene);
  const Surfaces surfaces(scene);
  std::vector<double> mean(arm_joints.size(), 0);
  const int n = int(plan.targets.size());
  for (int step = 0; step < n; ++step) {
    simulation.step(plan.targets[step]);
    if (checks) {
      expect_no_intersection(surfaces, simulation.state(), step);
      expect_upright_tetrahedra(scene, simulation.state(), step);
    }
    if (step >= n - 5)
      for (std::size_t j = 0; j < mean.size(); ++j) mean[j] += simulation.state().joint_effort[arm_joints[j]] / 5;
  }
  last = simulation.state();
  return mean;
}

TEST(Grasp, JointsFeelTheWeightOfTheLiftedBeaker) {
  const Task task = grasp_task();
  const TaskScene built = build_scene(task, 0, 0);
  const MotionPlan plan = plan_episode(task, built);
  Device device;
  WorldState held, empty;
  const std::vector<double> with_beaker = settled_efforts(device, built.scene, plan, built.robots[0].arm, true, held);

  const int beaker = body_named(built.scene, "beaker");
  Scene without = built.scene;
  ASSERT_EQ(beaker, int(without.rigid_bodies.size()) - 1);
  without.rigid_bodies.pop_back();
  std::erase_if(without.pair_friction,
                [](const PairFriction& p) { return p.first == "beaker" || p.second == "beaker"; });
  const std::vector<double> without_beaker = settled_efforts(device, without, plan, built.robots[0].arm, false, empty);

  const AffineMap& map = held.rigid[beaker];
  EXPECT_GT(map(2, 3) - built.scene.rigid_bodies[beaker].pose.translation().z(), 0.10) << "the beaker was not lifted";
  const RigidBody& glass = built.scene.rigid_bodies[beaker];
  const Vec3 centre = map.leftCols<3>() * glass.center_of_mass + map.col(3);
  int n_levers = 0;
  for (std::size_t j = 0; j < built.robots[0].arm.size(); ++j) {
    const Joint& joint = built.scene.joints[built.robots[0].arm[j]];
    const AffineMap& parent = held.rigid[joint.parent];
    const Vec3 axis = (parent.leftCols<3>() * joint.parent_frame.linear() * joint.axis).normalized();
    const Vec3 origin = parent.leftCols<3>() * joint.parent_frame.translation() + parent.col(3);
    // the drive holds up  -m g . (axis x r)
    const double lever = axis.cross(centre - origin).z();
    if (std::abs(lever) < 0.1) continue;
    ++n_levers;
    const double expected = glass.mass * 9.81 * lever;
    EXPECT_NEAR(with_beaker[j] - without_beaker[j], expected, 0.05 * std::abs(expected)) << joint.name;
    std::printf("%s: lever %.3f m, expected %.5f N m, measured %.5f N m\n", joint.name.c_str(), lever, expected,
                with_beaker[j] - without_beaker[j]);
  }
  EXPECT_GE(n_levers, 2);
}

}  // namespace
}  // namespace pvg
