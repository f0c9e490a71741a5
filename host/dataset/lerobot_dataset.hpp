// The layouts of LeRobot, 3.0 and 2.1: Parquet tables, videos as they are, JSON. One data file and one video per camera
// and episode in both, so that episodes can be added and taken out by files.
//   observation.state, action [D]       f32 [rad or m]; what they mean: packed_episode.hpp
//   observation.environment_state [E]   f32, where asked for: of objects and cloths, environment_state.hpp
//   observation.images.<camera>         video
//   camera.<camera>.K [9], camera.<camera>.T_world_camera [16]   f32, row by row; OpenCV's conventions
//   timestamp, frame_index, episode_index, index, task_index
// meta/phyvisgen.json says where the episodes come from.
#pragma once
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>

#include "host/dataset/packed_episode.hpp"
#include "host/formats/parquet_tables.hpp"

namespace pvg {

enum class LeRobotVersion { v2_1, v3_0 };

struct LeRobotSettings {
  LeRobotVersion version = LeRobotVersion::v3_0;
  std::string instruction;        // what the robot is told to do; empty: the task's name in words
  nlohmann::ordered_json origin;  // for meta/phyvisgen.json
  bool has_environment = false;   // observation.environment_state is written
};

std::unique_ptr<DataSetWriter> make_lerobot_writer(const std::filesystem::path& folder, const LeRobotSettings& settings,
                                                   const std::function<void(const ParquetTable&)>& write);

}  // namespace pvg
