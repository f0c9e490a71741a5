// What `render` shows: a scene or task file, and the states that move it, if any.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "host/dataset/states_reader.hpp"
#include "host/model/scene.hpp"
#include "host/model/task.hpp"
#include "host/render/renderer.hpp"

namespace pvg {

struct ShownScene {
  Scene scene;
  RenderSection render;    // what the file says about pictures
  std::uint64_t seed = 0;  // of the pictures' noise
  bool is_task = false;
  std::vector<std::string> notes;  // for the user, a sentence each
};

// file: a scene, a task or a glTF file, whose pictures are exposed for its KHR_lights_punctual: a white surface in its
// middle that looks to all of them has the value 1. A task's start is drawn as in the episode that `states` holds;
// without states every number is in the middle of its range. has_rigid_grippers: of a task, whose fingers do not bend;
// a UsageError for any other file.
ShownScene load_shown_scene(const std::string& file, const std::string& states, bool has_rigid_grippers = false);

// What a file says of pictures, for the renderer.
RenderSettings settings_of(const RenderSection& section);

// The same view in other pixels; the vertical field of view stays. 0: as it is.
void resize(Camera& camera, int width, int height);

// how far back from its time a picture looks [s]
double shutter_of(const Camera& camera);

// The pictures of a motion, in their order. Without a states file there is one: the start.
class Frames {
 public:
  // rate: pictures per second where the states file names none [1/s]
  Frames(const Scene& scene, const std::string& states, double rate);
  std::size_t size() const { return times_.size(); }
  double time(std::size_t frame) const { return times_.at(frame); }  // [s]
  double rate() const { return rate_; }                              // [1/s]
  bool are_recorded() const { return are_recorded_; }                // the states file names them
  // from the last step at or before `begin` to the first at or after `end` [s]
  std::vector<SceneState> motion(double begin, double end) const;
  // at any time; straight lines between steps, at rest before and after
  SceneState at(double time) const;
  SceneState state(std::size_t frame) const { return at(time(frame)); }

 private:
  SceneState start_;
  std::optional<StatesReader> states_;
  std::vector<double> times_;  // of the frames
  double rate_;
  bool are_recorded_ = false;
};

// "A:B" -> A, B: frames A to B - 1; either may be missing, a single number is one frame. Throws a UsageError where the
// range is empty or beyond n; whose: what it calls that which has the frames.
struct FrameRange {
  std::size_t begin = 0, end = 0;
};
FrameRange parse_frames(const std::string& text, std::size_t n, const std::string& whose = "the motion");

}  // namespace pvg
