#include "pipeline/episode/record.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "host/dataset/packed_episode.hpp"

namespace pvg {
namespace {

constexpr std::size_t SHEET_COLUMNS = 8;

}  // namespace

EpisodeRecorder::EpisodeRecorder(const std::filesystem::path& folder, const Scene& scene, RecordSettings settings,
                                 std::span<const DisabledPair> disabled)
    : folder_(folder),
      settings_(std::move(settings)),
      states_(folder / "states.h5", scene, settings_.header, disabled),
      shown_(evenly_spread(settings_.n_frames, SHEET_COLUMNS)) {
  if (!settings_.renders) return;
  for (std::size_t i = 0; i < scene.cameras.size(); ++i) {
    const Camera& camera = scene.cameras[i];
    CameraFiles& files = cameras_.emplace_back();
    files.video = std::make_unique<VideoWriter>(folder / (camera.name + ".mp4"), camera.width, camera.height,
                                                settings_.frames_per_second);
    if (settings_.records_mask.at(i))
      files.masks =
          std::make_unique<MasksFile>(folder / (camera.name + "_masks.h5"), scene, camera.width, camera.height);
    sheet_.rows.push_back(camera.name);
  }
  sheet_.pictures.resize(cameras_.size());
  sheet_.title = settings_.header.task + "  seed " + std::to_string(settings_.header.seed) + "  episode " +
                 std::to_string(settings_.header.episode);
}

void EpisodeRecorder::write_start(const WorldState& state, const FramePictures& pictures) {
  states_.write_start(state, pictures.T_world_camera);
  for (std::size_t i = 0; i < pictures.pictures.size(); ++i) {
    const Picture8& picture = pictures.pictures[i];
    const std::filesystem::path file = start_video(folder_, sheet_.rows.at(i));
    std::filesystem::create_directories(file.parent_path());
    VideoWriter video(file, picture.width, picture.height, settings_.frames_per_second);
    video.write(picture.rgb);
    video.finish();
  }
}

void EpisodeRecorder::append_steps(const std::vector<StepRecord>& steps) {
  for (const StepRecord& step : steps) {
    states_.append_step(step.state, step.report, step.target, step.disturbance);
    time_ = step.state.time;
    element_ = step.element;
    ++n_steps_;
  }
}

void EpisodeRecorder::append_frame(FramePictures pictures) {
  states_.keep_nodes();
  if (!settings_.renders) return;
  states_.append_frame(n_steps_ - 1, pictures.T_world_camera);
  for (std::size_t i = 0; i < cameras_.size(); ++i) {
    cameras_[i].video->write(pictures.pictures[i].rgb);
    if (cameras_[i].masks) cameras_[i].masks->append(pictures.instance[i]);
  }
  if (std::find(shown_.begin(), shown_.end(), n_frames_) != shown_.end()) {
    sheet_.columns.push_back(fmt::format("{:.2f} s  {}", time_, settings_.elements.at(std::size_t(element_))));
    for (std::size_t i = 0; i < cameras_.size(); ++i) sheet_.pictures[i].push_back(std::move(pictures.pictures[i]));
  }
  ++n_frames_;
}

void EpisodeRecorder::finish() {
  states_.close();
  for (CameraFiles& files : cameras_) {
    files.video->finish();
    if (files.masks) files.masks->close();
  }
  if (settings_.renders) write_picture(folder_ / "contact_sheet.png", lay_out(sheet_));
}

}  // namespace pvg
