// Pictures as the cameras of a recording would have taken them in a simulated state, as the luminance of their cells.
// They are path traced with few samples, those of one frame always with the same random numbers, so that what differs
// between two states or two sensors is no noise.
#pragma once
#include <map>
#include <vector>

#include "host/identify/channels/sensing.hpp"
#include "host/identify/data/problem.hpp"
#include "host/pictures/picture_cells.hpp"
#include "host/render/renderer.hpp"

namespace pvg::diagnose {

class VideoSight {
 public:
  VideoSight(Device& device, const Problem& problem);
  // source: of Recording::video_sources;  frame: of the recording, that this is compared with
  PictureCells look(std::size_t source, const SceneState& state, int frame, const CameraError& error = {});
  // One standard deviation of the path tracer's noise, from pictures of one state with other random numbers.
  PictureCells noise(std::size_t source, const SceneState& state);
  int camera(std::size_t source) const { return cameras_.at(source); }  // of Problem::seen
  std::size_t n_rendered() const { return n_rendered_; }

 private:
  const std::vector<float>& light_of(int camera, const SceneState& state, int frame, double k1);
  PictureCells cells_of(int camera, std::vector<float> light, const CameraError& error) const;
  const Problem* problem_;
  std::vector<int> cameras_;  // [n_video_sources]
  Renderer renderer_;
  std::size_t n_rendered_ = 0;
  // What was seen of late: sensors that differ by what comes behind the lens see the same light, whose
  // [height x width x 3] linear values know no vignetting and no noise.
  std::map<std::vector<double>, std::vector<float>> light_;
  std::size_t n_kept_ = 0;  // numbers in it
};

// Adds the noise of our own pictures to that of video's.
void add_noise_of_pictures(VideoSight& sight, Problem& problem);

}  // namespace pvg::diagnose
