#include "host/identify/sensing/mask_sight.hpp"

#include "host/identify/data/resolve.hpp"
#include "host/render/camera.hpp"

namespace pvg::diagnose {
namespace {

RenderSettings one_sample() {
  RenderSettings settings;
  settings.samples = 1;
  return settings;
}

}  // namespace

MaskSight::MaskSight(Device& device, const Problem& problem)
    : problem_(&problem), renderer_(device, problem.seen, one_sample()) {
  for (const MaskSource& asked : problem.recording.mask_sources) {
    Source source{index_named(problem.seen.cameras, asked.camera), {false}};
    for (const Visual& visual : problem.seen.visuals) source.is_part.push_back(visual.part == asked.part);
    sources_.push_back(std::move(source));
  }
}

std::vector<std::uint8_t> MaskSight::look(std::size_t number, const SceneState& state, double k1) {
  const Source& source = sources_.at(number);
  renderer_.set_distortion(source.camera, distortion_with(problem_->seen.cameras[std::size_t(source.camera)], k1));
  renderer_.set_state(state);
  const std::vector<std::uint32_t> instances = renderer_.instances(source.camera);
  std::vector<std::uint8_t> mask(instances.size());
  for (std::size_t i = 0; i < mask.size(); ++i) mask[i] = source.is_part[instances[i]];
  return mask;
}

}  // namespace pvg::diagnose
