// A recording of robots without recording.yaml: a set of episodes and the task whose robots made them. What is
// commanded and measured follows from the names of the joints.
#pragma once
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "host/load/recording/recording.hpp"
#include "host/load/scene_file.hpp"

namespace pvg {

// Reads columns of Parquet files, as read_parquet (host/formats/parquet_tables.hpp) does.
using ParquetReader =
    std::function<nlohmann::json(const std::vector<std::filesystem::path>& files, const std::vector<std::string>&)>;

// What one episode says of joints: positions and what they were told.
struct RobotEpisode {
  std::string name;
  std::vector<double> time;                 // [n, s]
  std::vector<std::string> names;           // [n_columns] of joints, or of a gripper's width
  std::vector<std::vector<double>> state;   // [n_columns][n, rad or m]
  std::vector<std::vector<double>> target;  // [n_columns][n, rad or m] at these times
};

// Whether a path is something that load_robot_set reads.
bool is_robot_set(const std::filesystem::path& path);

// set: a states.h5, a folder with one or a set of them, or a LeRobot set (3.0 or 2.1). task: a task file. The last
// quarter of the episodes, one at least where there are two, is held out. Throws a UsageError that names the file, the
// column or the joint, and what to do.
Recording load_robot_set(const std::filesystem::path& set, const std::filesystem::path& task,
                         const ParquetReader& read_parquet);

// The episodes of a LeRobot set (lerobot_set.cpp). An action is where the robot is told to be at the next row.
std::vector<RobotEpisode> read_lerobot_set(const std::filesystem::path& set, const ParquetReader& read_parquet);

// A task's robots without anything else: nothing touches them, and their fingers do not bend.
SceneRun load_robots_alone(const std::filesystem::path& task);

}  // namespace pvg
