#include "pipeline/serve/served_scene.hpp"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "host/dataset/states_file.hpp"
#include "host/load/overview.hpp"
#include "host/physics/step/separate_bodies.hpp"
#include "host/render/motion.hpp"
#include "pipeline/episode/shown_scene.hpp"
#include "pipeline/serve/requests.hpp"

namespace pvg {
ServedScene::ServedScene(SceneRun run, const PictureOverrides& pictures, Device& physics, Device* rendering)
    : run_(std::move(run)), physics_(physics), rendering_(rendering) {
  if (run_.scene.separates_start)
    for (const Separation& moved : separate_bodies(run_.scene))
      std::fprintf(stderr, "phyvisgen: %s\n", describe(moved).c_str());
  for (const std::size_t joint : driven_joints(run_.scene)) driven_.push_back(run_.scene.joints[joint].name);
  shown_ = run_.scene;
  complete_for_viewing(shown_);
  for (Camera& camera : shown_.cameras) {
    resize(camera, pictures.width, pictures.height);
    shutter_ = std::max(shutter_, shutter_of(camera));
  }
  if (pictures.samples) run_.render.samples = pictures.samples;
  if (!run_.render.lut.empty()) lut_ = read_lut(run_.render.lut);
  begin();
}

void ServedScene::begin() {
  simulation_ = std::make_unique<Simulation>(physics_, run_.scene);
  targets_.clear();
  for (const std::size_t j : driven_joints(run_.scene)) {
    const Joint& joint = run_.scene.joints[j];
    targets_.push_back(joint.drive.mode == Drive::Mode::position ? joint.initial : 0);
  }
  recent_.clear();
  if (shutter_ > 0) recent_.push_back(state());
  n_steps_ = 0;
  is_at_start_ = true;
}

void ServedScene::reset() {
  if (!is_at_start_) begin();
}

void ServedScene::step_to(std::vector<double> targets) {
  is_at_start_ = false;
  simulation_->step(targets);
  targets_ = std::move(targets);
  ++n_steps_;
  if (shutter_ <= 0) return;
  recent_.push_back(state());
  // the last state at or before the shutter opens stays
  while (recent_.size() > 1 && recent_[1].time <= state().time - shutter_) recent_.pop_front();
}

void ServedScene::step(std::size_t n) {
  const double h = run_.scene.solver.time_step;
  for (std::size_t i = 0; i < n; ++i) step_to(run_.targets_at(double(n_steps_ + 1) * h));  // as `simulate` has them
}

void ServedScene::step(const std::vector<std::vector<double>>& targets) {
  check_targets(run_.scene, targets);
  for (const std::vector<double>& row : targets) step_to(row);
}

std::string ServedScene::intersection() {
  if (!surfaces_) surfaces_ = std::make_unique<Surfaces>(run_.scene);
  return surfaces_->meeting(state());
}

Picture8 ServedScene::picture(std::size_t camera) {
  if (!renderer_) renderer_ = std::make_unique<Renderer>(*rendering_, shown_, settings_of(run_.render));
  // the noise of `render --states`, whose first frame is the state after the first step; and of `render` of the start
  const std::uint32_t frame = n_steps_ == 0 ? 0 : std::uint32_t(n_steps_ - 1);
  renderer_->set_state(state());
  const std::vector<SceneState> states =
      recent_.empty() ? std::vector<SceneState>{state()} : std::vector<SceneState>(recent_.begin(), recent_.end());
  RenderedFrame rendered = renderer_->render(
      int(camera), frame, [&](double time) { return state_at(states, time); }, state().time);
  if (lut_) apply_lut(*lut_, rendered.rgb);
  return encode_srgb8(rendered.rgb, rendered.width, rendered.height);
}

}  // namespace pvg
