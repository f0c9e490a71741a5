// A scene file (YAML, schema 1): a scene without a task. Besides the sections that it shares with tasks it lists bodies
// of plain shapes, joints and stitches, and says how long it runs and what its drives are told.
//
//   gravity: [0, 0, -9.81]     duration: 2 s     time_step: 10 ms     contact: {..}     solver: {..}
//   bodies:
//     - {name: cube, kind: rigid, shape: {box: {size: [0.1, 0.1, 0.1]}}, density: 1000, pose: {position: [0, 0, 1]}}
//     - {name: floor, kind: static, shape: {square: {size: 4}}}
//     - {name: bar, kind: soft, shape: {bar: {size: [0.1, 0.01, 0.01], divisions: [10, 1, 1], nodes_per_element: 10}},
//        material: {density: 1000, youngs_modulus: 1 MPa, poisson_ratio: 0.45}}
//   joints:
//     - {name: hinge, type: revolute, parent: floor, child: cube, parent_frame: {position: [0, 0, 1]}, axis: [0, 1, 0],
//        drive: {stiffness: 100, damping: 1, target: 30 deg}}
//   stitches:
//     - {soft: bar, rigid: floor, low: [-1, -1, -1], high: [-0.049, 1, 1], stiffness: 1e6}
//     - {cloth: towel, rigid: floor, low: [..], high: [..], stiffness: 1e5}
//   pair_friction:
//     - {first: cube, second: floor, coefficient: 0.3}
//
// A body may have `visuals`, as the objects of tasks do; those of a soft body are carried by its tetrahedra.
// A body of kind `moving` goes its way whatever it meets (path: [{time: 0, position: .., rotation: ..}, ..], or
// velocity and angular_velocity); one of kind `half_space` fills everything below the plane of its `point` and
// `normal`. A drive's mode is position, velocity or torque; its target may be a list over `target_times`. `separate:
// true` moves free bodies apart that intersect at the start.
//   robots:
//     - {name: left, robot: {.. as in tasks ..}, gripper: FILE, path: [{time: 1 s, joints: [..], gripper: 40 mm}, ..]}
//
// Shapes of rigid and static bodies: mesh (a file), box, sphere, cylinder, hexahedron, square (static only); of soft
// ones: bar, ball_octant, or a closed one, which tetgen fills (`filled`): read_shapes.cpp. Cloths: table_physics.cpp.
#pragma once
#include <filesystem>
#include <optional>
#include <vector>

#include "host/load/fields/fields.hpp"

namespace pvg {

// A drive's target over time: straight lines between these points, constant before and after.
struct TargetTable {
  std::vector<double> time;   // ascending [s]
  std::vector<double> value;  // [rad or m]
  double at(double t) const;
};

// Where one of `robots` is told to be: straight lines in joint space between these points; none: at home.
struct RobotPathPoint {
  double time = 0;                // ascending [s]
  std::vector<double> joints;     // [n_arm, rad or m]
  std::optional<double> gripper;  // of a robot with one [m]
};
using RobotPath = std::vector<RobotPathPoint>;

// One of `robots`.
struct SceneRobot {
  RobotCell cell;
  RobotPath path;
};

// What is seen of one of `bodies`.
struct BodyVisuals {
  int rigid = -1, soft = -1;  // of SceneFile::added
  std::vector<VisualSection> visuals;
  Display display;  // width 0: none
};

// What a scene file says.
struct SceneFile {
  Task task;                         // the sections that tasks have too; its solver, contact and pair_friction hold
  PhysicalScene added;               // only gravity, bodies, joints and stitches; indices among themselves
  std::vector<TargetTable> targets;  // [n_driven joints of `added`]
  std::vector<RobotPath> paths;      // of Task::more_robots
  std::vector<BodyVisuals> visuals;
  std::vector<PassingSurface> passing_surfaces;  // of `added`
  double duration = 1;                           // [s]
};

const Fields<SceneFile>& scene_file_fields();  // what tasks do not have
const Fields<SceneRobot>& scene_robot_fields();

SceneFile load_scene_file(const std::filesystem::path& file);

// A scene that is ready to run.
struct SceneRun {
  Scene scene;
  RenderSection render;
  std::vector<TargetTable> targets;  // [n_driven joints], in the order of Scene::joints
  double duration = 0;               // [s]
  std::string configuration;         // for the record: the file's text

  std::size_t n_steps() const;
  std::vector<double> targets_at(double time) const;  // [n_driven, rad or m]
};

// Starts at the middle of every range.
SceneRun load_scene_run(const std::filesystem::path& file);

}  // namespace pvg
