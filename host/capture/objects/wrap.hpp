// A closed surface around any triangles: holes, flipped, doubled, crossing or loose ones. Space is outside where a ball
// of radius `bridge` reaches it from afar, grown back by what the ball could not enter (a morphological closing, as of
// alpha wrapping, Portaneri et al. 2022); the surface is where the distance to the triangles is `offset` on that side.
// Marching cubes makes it closed and manifold by construction (host/capture/marching_cubes.cpp). Pure.
#pragma once
#include "host/capture/objects/edge_collapse.hpp"

namespace pvg {

constexpr double SAMPLES_ACROSS = 100;  // a mesh, where no spacing is given

struct WrapSettings {
  double spacing = 0;  // of the samples [m]; 0: size / SAMPLES_ACROSS
  double offset = 0;   // outward, so that sheets without thickness stay [m]; at least 0.6 spacings
  double bridge = 0;   // holes up to twice this are closed [m]; 0: four spacings
};

// A UsageError where there are no triangles, a point is not finite, or the grid is too large.
TriangleMesh wrap_surface(const TriangleMesh& soup, WrapSettings settings);

// A closed mesh that was checked: no defect of closed_surface_defect, no edge with more than two triangles, no
// self-intersection (exact), no part within another one.
bool is_sound(const TriangleMesh& mesh);

struct SimplifiedSolid {
  TriangleMesh mesh;
  std::vector<double> to_original, from_original;  // as of surface_distance.hpp
};

// At most n_triangles where that is possible: the result is_sound, neither surface is farther than `error` [m] from the
// other, and it keeps the bound. The mesh itself must be sound; it comes back where nothing smaller is. least_shape: as
// of collapse_edges.
SimplifiedSolid simplified_solid(const TriangleMesh& mesh, std::size_t n_triangles, double error,
                                 const SourceBound& source = {}, double least_shape = NEEDLE);

}  // namespace pvg
