// Materials and textures of a scene as the device reads them.
#pragma once
#include <vector>

#include "host/model/appearance.hpp"
#include "materials/material.h"

namespace pvg {

struct Look {
  std::vector<Material> materials;         // those with an inside first, see kernels/render/media.cl
  std::vector<std::uint32_t> material_of;  // [Appearance::materials] its place in `materials`
  std::vector<TextureInfo> textures;
  std::vector<std::uint32_t> texels;  // RGBA bytes
  std::vector<float> decode;          // byte to linear: as sRGB, as a value [512]
};

// Refuses colours and coefficients out of their range and textures of the wrong length, naming them.
Look make_look(const Appearance& seen);

// its surface is not everywhere there
bool is_cut_out(const VisualMaterial& material);
// no light sample finds the directions into which it sends light: clear glass, a mirror
bool is_mirror_like(const Material& material);
// its surface is a light
bool shines(const VisualMaterial& material);
// over its texture [W/(sr m^2)]
Vec3f mean_emission(const Appearance& seen, const VisualMaterial& material);

}  // namespace pvg
