// Gaussian splats of 3DGS, PGSR, 2DGS and TSGS files, and the surface that they show. In the files, scales are
// logarithms, opacities logits, quaternions have w first, colours are spherical harmonics about 0.5 (Kerbl et al.
// 2023).
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "capture/splats.h"
#include "host/device/device.hpp"
#include "host/formats/depth_files.hpp"
#include "host/geometry/visual_mesh.hpp"
#include "host/model/appearance.hpp"

namespace pvg {

struct Splats {
  std::string format;         // "3DGS" (also PGSR), "2DGS" or "TSGS"
  std::vector<Splat> splats;  // in metres
  std::vector<Vec3f> colors;  // [n] linear Rec. 709: the harmonics' mean over all directions
};

// Does the file's header have opacity, scale_0 and rot_0?
bool is_splat_file(const std::filesystem::path& file);

// scale: metres per unit of the file. UsageErrors name file and property: missing, or not finite and where.
Splats read_splats(const std::filesystem::path& file, double scale);

// Depth where what lies in front absorbs `share` of the light: 0.5: the median; less: the first surface, also of glass.
// 0: nothing is there.
DepthPicture splat_depth(Device& device, const Splats& splats, const Camera& camera, float share);

// Depths from views around, fused; with colours. Open where no view looks in. A UsageError where no splat is opaque.
VisualMesh surface_of_splats(Device& device, const Splats& splats);

}  // namespace pvg
