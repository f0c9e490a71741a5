// states.h5: everything that one simulated episode was, one row per simulation step, one per rendered frame. A row of a
// step is the state at its end; the target applied in the step stands in the same row. No wall-clock time is in it: the
// same (task, seed, episode) gives the same bytes.
//
//   /time [T, s]  /frame_step [F]  /q /a /torque [T, J]  /T_link [T, L, 3, 4]  /T_rigid [T, R, 3, 4]
//   /disturbance [T, J]   what pushed the targets that the drives followed away from /a; missing where nothing did
//   /X_gripper/<name> /X_deform/<name> [T, V, 3, m]      soft bodies stitched to a rigid one; free ones and cloths
//   /bodies/{source, row, is_fixed}     of every body: the data set its state is in and the row there
//   /bodies/noncolliding [n, 2]         pairs of bodies that never touch: jointed links and those the scene names
//   /mesh/<name>/{rest [V, 3, m], elements [n, 4 or 10] (of a cloth: none), triangles [n, 3], body}
//   /contact/{offset [T + 1], points [C, 3, m], kind, bodies [C, 2], normal [C, 3], gap [C, m], normal_force [C, N],
//             friction_force [C, 3, N]}     kind 0: point-triangle, 1: edge-edge, 2: point-plane; forces act
//                                            on the first body
//   /contact_disabled [n, 9]   kind, two bodies, three vertices of each (-1: fewer)
//   /joint/{position, drive, stop, damping} [T, J of all joints]   coordinate [rad or m] and efforts along it [N m or
//   N] /force/{net [T, B, 3, N], torque [T, B, 3, N m]}   of all contacts on each body, in the order of /bodies
//   /pair_force/{offset [T + 1], bodies [P, 2], normal [P, 3, N], friction [P, 3, N]}   on the first body of each pair
//   /reading [T, D, kg]   of the objects with a display, before it is rounded; missing where there is none
//   /node_step [K]   the steps whose nodes are kept; missing: all
//   /solver/{newton, cg, contacts, retries, residual [m/s], min_gap [m]} [T]
//   /camera/<name>/{K [F, 3, 3], distortion, T_world_camera [F, 4, 4]}
//   /start/{q, T_link, T_rigid, X_gripper/<name>, X_deform/<name>}, /start/camera/<name>/T_world_camera
//     before the first step, one row of each; missing where only steps are on record
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "host/model/scene.hpp"
#include "host/model/task.hpp"
#include "host/model/world_state.hpp"

namespace pvg {

struct EpisodeHeader {
  std::string task;
  std::uint64_t seed = 0, episode = 0;
  std::string configuration;                                  // resolved, as YAML
  std::vector<std::pair<std::string, std::string>> versions;  // name, version
  std::vector<std::pair<std::string, double>> sampled;        // drawn numbers [SI]
  std::vector<std::string> objects;                           // rigid bodies that stand in T_rigid; others: T_link
  // Not `full`: /X_gripper and /X_deform are rounded to whole NODE_GRID and everything is compressed. `frames`: rows of
  // steps that keep_nodes() did not name are NaN there, /node_step [K] holds those that it named.
  RecordedStates states = RecordedStates::full;
  bool is_disturbed = false;  // /disturbance is there
};

// A power of two: a number rounded to it is at most half of it off, 0.95 um, and float32 holds it below 32 m.
inline constexpr double NODE_GRID = 0x1p-19;  // [m]

// Element pairs that may not touch by construction.
struct DisabledPair {
  ContactForce::Kind kind = ContactForce::Kind::point_triangle;
  int first = -1, second = -1;                    // bodies: rigid ones first, then soft ones, then cloths
  std::array<int, 3> first_vertices{-1, -1, -1};  // of the body's mesh
  std::array<int, 3> second_vertices{-1, -1, -1};
};

class StatesFile {
 public:
  StatesFile(const std::filesystem::path& path, const Scene& scene, const EpisodeHeader& header,
             std::span<const DisabledPair> disabled);
  ~StatesFile();
  StatesFile(StatesFile&&) noexcept;

  // Where everything is before the first step. T_world_camera: as in append_frame; none where there are no pictures.
  void write_start(const WorldState& state, std::span<const Eigen::Matrix4d> T_world_camera);
  // target: of each joint with a drive, in the order of Scene::joints [rad or m]; disturbance: what was added to it,
  // likewise, where the header says that there is one
  void append_step(const WorldState& state, const StepReport& report, std::span<const double> target,
                   std::span<const double> disturbance = {});
  // The nodes of the last step appended so far are kept where only those of frames are.
  void keep_nodes();
  // A frame shows the last step appended so far. T_world_camera: of each camera of the scene.
  void append_frame(std::size_t step, std::span<const Eigen::Matrix4d> T_world_camera);
  void close();  // throws if something could not be written

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Soft bodies that a stitch ties to a rigid body: the gripper's.
std::vector<bool> is_stitched(const PhysicalScene& scene);

// Indices of Scene::joints that have a drive: the columns of q, a and torque.
std::vector<std::size_t> driven_joints(const PhysicalScene& scene);

}  // namespace pvg
