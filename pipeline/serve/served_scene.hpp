// A scene that someone else steps. Every state has the bits that `simulate` gives for the same targets, every picture
// those of `render`, whatever was done before.
#pragma once
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/device/device.hpp"
#include "host/formats/lut_file.hpp"
#include "host/load/scene_file.hpp"
#include "host/physics/step/simulation.hpp"
#include "host/pictures/picture.hpp"
#include "host/render/renderer.hpp"
#include "pipeline/episode/episode.hpp"
#include "pipeline/serve/surfaces.hpp"

namespace pvg {

class ServedScene {
 public:
  // The scene is at its start. Throws as Simulation does, where it cannot begin. rendering: nothing where no pictures
  // will be asked for. The devices must outlive it.
  ServedScene(SceneRun run, const PictureOverrides& pictures, Device& physics, Device* rendering);

  const SceneRun& run() const { return run_; }
  const Scene& shown() const { return shown_; }  // what cameras see: with those that a scene without any is given
  const std::vector<std::string>& driven() const { return driven_; }  // joints with a drive, in the order of targets

  bool renders() const { return rendering_ != nullptr; }

  // Back to the start; all that follows has the bits that it had the first time.
  void reset();
  // So many steps, in which drives are told what the scene says. A StepFailure where one cannot be done: the scene is
  // then where the step before has led it, and n_steps() says how many were done.
  void step(std::size_t n);
  // As many steps as there are rows. A UsageError, and nothing changes, where they do not fit.  [n][n_driven]
  void step(const std::vector<std::vector<double>>& targets);

  std::size_t n_steps() const { return n_steps_; }  // since the start
  const WorldState& state() const { return simulation_->state(); }
  SceneVelocity velocity() const { return simulation_->velocity(); }
  // of the last step, before the first one what drives start at  [n_driven, rad, m, their rates or efforts]
  const std::vector<double>& targets() const { return targets_; }
  const StepReport& report() const { return simulation_->reports().front(); }  // of the last step
  // Bodies whose surfaces intersect now, such as "cube and floor"; empty: none. By an exact test of its own.
  std::string intersection();
  Picture8 picture(std::size_t camera);  // where renders()

 private:
  void begin();
  void step_to(std::vector<double> targets);

  SceneRun run_;
  Scene shown_;
  Device& physics_;
  Device* rendering_;
  std::vector<std::string> driven_;
  double shutter_ = 0;  // longest time that a camera looks back [s]
  std::optional<Lut> lut_;
  std::unique_ptr<Simulation> simulation_;
  std::unique_ptr<Surfaces> surfaces_;  // where they were asked for
  std::unique_ptr<Renderer> renderer_;
  std::vector<double> targets_;
  std::deque<SceneState> recent_;  // of the last `shutter_`, for pictures of motion
  std::size_t n_steps_ = 0;
  bool is_at_start_ = false;  // nothing was tried yet
};

}  // namespace pvg
