// Materials, textures and lights of a scene as the device reads them.
#pragma once
#include <vector>

#include "host/scene/scene.hpp"
#include "materials/material.h"
#include "render/path.h"

namespace pvg {

struct Look {
  std::vector<Material> materials;         // glass first, see kernels/render/media.cl
  std::vector<std::uint32_t> material_of;  // [Scene::materials] its place in `materials`
  std::vector<TextureInfo> textures;
  std::vector<std::uint32_t> texels;  // RGBA bytes
  std::vector<float> decode;          // sRGB byte to linear [256]
  std::vector<Light> lights;
};

// Refuses colours and coefficients out of their range and textures of the wrong length, naming them.
Look make_look(const Scene& scene);

// sRGB to linear, both in [0, 1] (IEC 61966-2-1)
float srgb_to_linear(float c);
float linear_to_srgb(float c);

}  // namespace pvg
