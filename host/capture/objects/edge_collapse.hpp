// Fewer triangles for a sound mesh, one edge at a time (Garland and Heckbert 1997, quadric error metrics). Each
// collapse is checked before it is made: the surface stays closed and manifold (link condition), no triangle turns
// over, none meets another one (exact predicates), and neither surface leaves the other by more than a given distance.
// So no result has to be thrown away as a whole. Pure.
#pragma once
#include "host/capture/objects/nearest_triangle.hpp"

namespace pvg {

// The surface that a mesh was wrapped around, if any, which the result may not leave by more than `most`.
struct SourceBound {
  const NearestTriangle* surface = nullptr;
  double most = 0;  // [m]
  double own = 0;   // how far the mesh itself is, at most [m]; <= most
};

// Shape of a triangle: the height on its longest edge over that edge; regular: 0.87.
constexpr double NEEDLE = 1e-3;  // none is made below it

// mesh: closed, manifold, without self-intersections; so is the result, which has at most n_triangles where the
// distance allows. error: most distance of the result's points, middles of edges and of triangles to `mesh`, and of the
// points of `mesh` to the result [m]. The same points of the result keep the bound. least_shape: no triangle of a worse
// shape is made, unless the ones in its place had one.
TriangleMesh collapse_edges(const TriangleMesh& mesh, std::size_t n_triangles, double error,
                            const SourceBound& source = {}, double least_shape = NEEDLE);

}  // namespace pvg
