// What is done with traced light on the host: its noise filtered by Open Image Denoise, exposed, the sensor's own noise
// added. It does not touch the device, so one picture may be finished while the next one is traced.
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "host/model/scene.hpp"
#include "host/pictures/rendered_frame.hpp"
#include "host/render/image_denoise.hpp"
#include "host/render/renderer.hpp"

namespace pvg {

// of the random numbers of one picture
std::uint32_t picture_key(std::uint64_t seed, std::uint32_t frame, std::uint32_t camera);

class PictureFinish {
 public:
  // on_gpu: of the device that traces
  PictureFinish(const Scene& scene, const RenderSettings& settings, bool on_gpu);
  // by Open Image Denoise; false where it was not asked for or is not there
  bool denoises() const { return image_denoise_.has_value(); }
  // traced: by Renderer::trace of that camera with that number
  void operator()(RenderedFrame& traced, int camera, std::uint32_t frame);

 private:
  std::vector<Camera> cameras_;
  RenderSettings settings_;
  std::optional<ImageDenoise> image_denoise_;
};

}  // namespace pvg
