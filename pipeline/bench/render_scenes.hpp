// What the renderer is measured with: a generated mesh of any size, rays through it, and scenes. The same bits
// everywhere.
#pragma once
#include <cstddef>
#include <vector>

#include "host/model/scene.hpp"
#include "render/path.h"

namespace pvg {

// A closed room of 10 x 10 x 4.5 m with a wavy floor and 60 dented balls; about n triangles, 12 of them large.
VisualMesh bench_room(std::size_t n);

// Origins and directions; t counts in directions.
struct BenchRays {
  std::vector<F32x4> origin, direction;  // [n, m]; w: 0
  std::size_t size() const { return origin.size(); }
};

// From a camera inside the room: 640 x 360 pixels in tiles of 8 x 8, `samples` each side by side.
BenchRays primary_rays(int samples);
// From where the primary rays met the mesh: one each, cosine distributed about the normal; `hit` as in
// kernels/render/wavefront/intersect.cl.
BenchRays diffuse_rays(const VisualMesh& mesh, const BenchRays& primary, const std::vector<F32x4>& hit);
// From there to points of a square of 4 x 4 m below the ceiling, where t = 1.
BenchRays shadow_rays(const VisualMesh& mesh, const BenchRays& primary, const std::vector<F32x4>& hit);

// Cornell's box (open in front, 2 m wide) with a tall block and a ball of clear glass; 640 x 360 pixels.
Scene cornell_glass();
// bench_room as a scene, textured with one picture of 4096 x 4096 texels; 640 x 360 pixels.
Scene textured_room(std::size_t n);

}  // namespace pvg
