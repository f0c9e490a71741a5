// The rows of a cloth's energy terms from its rest mesh and material.
#pragma once
#include <vector>

#include "energies/elastic/cloth_membrane.h"
#include "energies/elastic/triangle_bending.h"
#include "host/model/physical_scene.hpp"

namespace pvg {

// Throws a UsageError naming the cloth: material out of range, triangles without area, edges with more than two
// triangles or with triangles that run opposite ways.
void check_cloth(const Cloth& cloth);

// Which points never move. [n_points]
std::vector<char> cloth_is_pinned(const Cloth& cloth);

// A third of each triangle's mass to each corner. [n_points, kg]
std::vector<double> cloth_node_masses(const Cloth& cloth);

// One element per triangle; sites are first_node + index of the point.
std::vector<ClothMembrane> cloth_membrane_elements(const Cloth& cloth, u32 first_node);
// One element per triangle with at least one neighbour.
std::vector<TriangleBending> triangle_bending_elements(const Cloth& cloth, u32 first_node);

}  // namespace pvg
