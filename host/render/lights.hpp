// The lights of a scene as the device draws them: rectangles, spheres, the triangles of meshes that shine and the
// environment, each by its share of the power.
#pragma once
#include <span>
#include <vector>

#include "host/model/appearance.hpp"
#include "render/path.h"

namespace pvg {

// A visible mesh whose material shines.
struct ShiningMesh {
  std::uint32_t instance = 0, first_triangle = 0;
  Vec3f emission = Vec3f::Zero();  // mean over its texture [W/(sr m^2)]
  std::vector<double> areas;       // of its triangles [m^2]; they may change later
};

struct LightList {
  std::vector<Light> lights;                // rectangles, spheres, triangles mesh by mesh, the environment
  std::vector<std::int32_t> first_of_mesh;  // [n meshes] its first triangle's light, or -1
  std::int32_t environment = -1;            // its light; only where there is a picture of it
};

// Refuses lights without area or radiance, naming them.
LightList make_lights(const Appearance& seen, std::span<const ShiningMesh> meshes);

// What rays meet of a light: the unit square, which a rectangle's edges carry to its place, and a unit sphere of
// triangles as large as the true one from all sides together.
VisualMesh light_square();
VisualMesh light_sphere();

// Importance of the environment's directions, [ENVIRONMENT_ROWS x ENVIRONMENT_COLUMNS]; refuses values that are
// negative or not finite.
std::vector<EnvironmentCell> environment_cells(const EnvironmentMap& map);

}  // namespace pvg
