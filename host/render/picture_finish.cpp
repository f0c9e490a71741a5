#include "host/render/picture_finish.hpp"

#include <utility>

#include "host/render/sensor.hpp"

namespace pvg {
namespace {

// as in kernels/shared/rng.cl
std::uint32_t hash_u32(std::uint32_t x) {
  const std::uint32_t state = x * 747796405u + 2891336453u;
  const std::uint32_t word = ((state >> ((state >> 28) + 4u)) ^ state) * 277803737u;
  return (word >> 22) ^ word;
}

}  // namespace

std::uint32_t picture_key(std::uint64_t seed, std::uint32_t frame, std::uint32_t camera) {
  std::uint32_t key = 0;
  for (const std::uint32_t part : {std::uint32_t(seed), std::uint32_t(seed >> 32), frame, camera})
    key = hash_u32(key ^ hash_u32(part));
  return key;
}

PictureFinish::PictureFinish(const Scene& scene, const RenderSettings& settings, bool on_gpu)
    : cameras_(scene.cameras),
      settings_(settings),
      image_denoise_(settings.denoises ? ImageDenoise::find(on_gpu) : std::nullopt) {}

void PictureFinish::operator()(RenderedFrame& traced, int camera, std::uint32_t frame) {
  const Camera& seen_by = cameras_[std::size_t(camera)];
  if (image_denoise_) {
    traced.rgb = image_denoise_->filter({std::uint32_t(traced.width), std::uint32_t(traced.height),
                                         std::move(traced.rgb), traced.albedo, traced.mean_normal});
    for (float& value : traced.rgb) value *= float(seen_by.exposure);
  }
  if (!settings_.notes_features) {
    traced.albedo.clear();
    traced.mean_normal.clear();
  }
  expose_sensor(seen_by, picture_key(settings_.seed, frame, std::uint32_t(camera)), traced.rgb);
}

}  // namespace pvg
