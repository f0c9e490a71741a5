// What polished metals reflect, from measured optical constants.
#pragma once
#include <string>
#include <vector>

#include "host/geometry/mesh.hpp"

namespace pvg {

// gold, silver, copper, ...
const std::vector<std::string>& metal_names();

// Linear Rec. 709 reflectance of metal number i at this cosine of the angle of incidence, in daylight (D65), cut to
// [0, 1]: the exact Fresnel equations, wavelength by wavelength.
Vec3 metal_reflectance(std::size_t i, double cosine);

// a of kernels/materials/conductor.cl, with which that curve has the metal's reflectance at the cosine 1/7 (82 degrees)
Vec3 metal_edge_dip(std::size_t i);

// Share of unpolarised light that a surface of index n + i k reflects into vacuum.
double fresnel_conductor(double n, double k, double cosine);

}  // namespace pvg
