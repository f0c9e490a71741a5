// The section `cloths` of task and scene files. Internal to the loaders.
//
//   cloths:
//     - name: towel
//       shape: {sheet: {size: [0.3, 0.2], divisions: [30, 20]}}     # or disc: {radius, rings}, or mesh: FILE
//       material: {area_density: 300 g/m^2, thickness: 2 mm, stretch: 3000, shear: 100, bending: 2e-5}
//       rest_angles: flat                # or mesh
//       warp: [1, 0, 0]                  # direction of the warp, in the cloth's frame
//       pinned:
//         - {low: [-0.15, -1, -1], high: [-0.14, 1, 1]}
//       friction: 0.4
//       pose: {x: [0.4, 0.5], z: 0.3, yaw: 30 deg}
#pragma once
#include "host/load/yaml_section.hpp"

namespace pvg {

ClothSection read_cloth(YamlSection& section);

// Indices of the points inside a box: `low` and `high` of this section, in the frame of the points.
std::vector<std::uint32_t> read_points_within(YamlSection& section, const std::vector<Vec3>& points,
                                              const std::string& body);

}  // namespace pvg
