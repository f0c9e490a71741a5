// An episode as data sets for imitation learning hold it: one row per picture. Every format is written from this.
//
//   row 0       the start, before the first step, at the time 0: what a policy sees when it is asked first
//   row f       picture f - 1, the end of the simulation step s(f) = /frame_step [f - 1], at the time
//               f / frames_per_second
//   state       of the joints at the end of step s(f), which is what the row's picture shows
//   action      the absolute target applied in step s(f + 1): where the robot is told to be when the next picture is
//               taken. In the last row the target of the last step: stand still. Disturbances are in the state, never
//               in the action.
//
// Without the start, which older episodes do not have, row f is picture f and s(f) = /frame_step [f].
//
// The joints of one gripper are one column, its width: the sum of their positions, which is how far the fingers are
// apart.
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "host/dataset/environment_state.hpp"

namespace pvg {

using Rows = std::vector<std::vector<double>>;  // [n_frames][width]

struct PackedCamera {
  std::string name;
  int width = 0, height = 0;           // [pixels]
  std::filesystem::path start, video;  // start: a video of one picture; empty: the rows begin after it
  Rows K;                              // [n_frames][9]
  Rows T_world_camera;                 // [n_frames][16] optical frame, row by row
  bool moves = false;                  // mounted on a robot
};

// The tool frame of a gripper: z along the fingers, y from finger to finger.
struct PackedTool {
  std::string name;                   // of the gripper's base
  std::vector<Eigen::Matrix4d> pose;  // to world  [n_frames]
  std::vector<double> width;          // [n_frames, m]
  std::vector<double> width_action;   // [n_frames, m]
};

struct PackedObject {
  std::string name;
  std::vector<Eigen::Matrix4d> pose;  // affine, to world  [n_frames]
};

struct PackedEpisode {
  std::uint64_t number = 0;
  std::string task, robot;  // names
  double frames_per_second = 0;
  std::vector<std::string> columns;  // names of the joints and widths, without slashes
  std::vector<bool> is_width;        // [n_columns] a gripper's
  Rows state, velocity, action;      // [n_frames][n_columns, rad or m, per s]
  std::vector<PackedTool> tools;
  std::vector<PackedObject> objects;
  std::vector<EnvironmentColumn> environment_columns;  // poses of objects, keypoints of cloths
  Rows environment;                                    // [n_frames][n_environment_columns, m or -]
  std::vector<PackedCamera> cameras;
  std::size_t n_frames() const { return state.size(); }
};

// folder: a finished episode. Cameras: these names, or all where there are none. A UsageError where it has no pictures
// or lacks a camera. has_start: the first row is the start.
PackedEpisode read_packed_episode(const std::filesystem::path& folder, const std::vector<std::string>& cameras,
                                  bool has_start = false);

// The same without cameras: rows are taken at the instants at which pictures would be, whether or not there are any.
PackedEpisode read_packed_states(const std::filesystem::path& folder, bool has_start = false);

// Whether the start is on record, and its picture of each of these cameras (of all where there are none).
bool has_packed_start(const std::filesystem::path& folder, const std::vector<std::string>& cameras);
bool has_packed_start_of_states(const std::filesystem::path& folder);

// Where `generate` leaves the picture of the start, below an episode's folder.
std::filesystem::path start_video(const std::filesystem::path& folder, const std::string& camera);

// A Failure where the videos of a camera hold another number of pictures than its episode has rows.
void demand_frames(const PackedCamera& camera, std::size_t n_frames, std::size_t n_pictures);

// Calls `take` with the picture of every row, as read_video does. A Failure where there are not n_frames.
void read_pictures(const PackedCamera& camera, std::size_t n_frames, int side,
                   const std::function<void(std::span<const std::uint8_t> rgb)>& take);

// What is known of all episodes before the first is written.
struct PackedSet {
  std::size_t n_episodes = 0, n_frames = 0, most_frames = 0;
  std::vector<double> least_action, most_action;  // [n_columns]
};
// Episodes of one set share columns, cameras and rate; a UsageError otherwise.
void add(PackedSet& set, const PackedEpisode& first, const PackedEpisode& episode);

// A format: a folder that is filled episode by episode.
struct DataSetWriter {
  virtual ~DataSetWriter() = default;
  virtual void add(const PackedEpisode& episode) = 0;
  virtual void finish() = 0;
};

}  // namespace pvg
