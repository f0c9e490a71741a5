// Writes one episode's folder while it happens: states, videos, masks, the contact sheet.
#pragma once
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "host/dataset/contact_sheet.hpp"
#include "host/dataset/masks_file.hpp"
#include "host/dataset/states_file.hpp"
#include "host/formats/video.hpp"
#include "host/render/renderer.hpp"

namespace pvg {

// One simulation step as it goes on record.
struct StepRecord {
  std::vector<double> target;       // [n_driven, rad or m]
  std::vector<double> disturbance;  // likewise: what was added to it; empty: nothing ever is
  int element = 0;                  // motion element under way, of Task::motion
  WorldState state;                 // at the end of the step
  StepReport report;
};

// What the cameras saw in one frame.
struct FramePictures {
  std::vector<Picture8> pictures;                    // [n_cameras]
  std::vector<std::vector<std::uint32_t>> instance;  // [n_cameras][height x width], empty where no mask is asked for
  std::vector<Eigen::Matrix4d> T_world_camera;       // [n_cameras]
};

struct RecordSettings {
  EpisodeHeader header;
  double frames_per_second = 10;
  std::size_t n_frames = 0;           // that will come
  std::vector<bool> records_mask;     // [n_cameras]
  std::vector<std::string> elements;  // names of the motion elements, for the contact sheet
  bool renders = true;                // false: no videos, no masks, no sheet
};

class EpisodeRecorder {
 public:
  EpisodeRecorder(const std::filesystem::path& folder, const Scene& scene, RecordSettings settings,
                  std::span<const DisabledPair> disabled);
  // what is there before the first step
  void write_start(const WorldState& state, const FramePictures& pictures);
  void append_steps(const std::vector<StepRecord>& steps);
  // a frame that shows the last step appended
  void append_frame(FramePictures pictures);
  void finish();

 private:
  struct CameraFiles {
    std::unique_ptr<VideoWriter> video;
    std::unique_ptr<MasksFile> masks;
  };
  std::filesystem::path folder_;
  RecordSettings settings_;
  StatesFile states_;
  std::vector<CameraFiles> cameras_;
  ContactSheet sheet_;
  std::vector<std::size_t> shown_;  // frames on the contact sheet
  std::size_t n_steps_ = 0, n_frames_ = 0;
  double time_ = 0;  // of the last step [s]
  int element_ = 0;
};

}  // namespace pvg
