// The surface that is seen, from the nodes that are simulated: points = W nodes, then the normals of the moved
// triangles.
#include "render/path.h"

// row_start: [n + 1];  column, weight: the rows of W;  nodes: [n_nodes x 3, m]
kernel void dual_mesh_points(const uint n, global const uint* restrict row_start, global const uint* restrict column,
                             global const float* restrict weight, global const float* restrict nodes,
                             const uint first_vertex, global Vertex* restrict vertices) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  float3 sum = (float3)(0, 0, 0);
  for (uint k = row_start[i]; k < row_start[i + 1]; ++k) sum += weight[k] * vload3(column[k], nodes);
  vstore3(sum, 0, vertices[first_vertex + i].point);
}

// The length of a triangle's cross product is twice its area, so large triangles count for more.
// corner_start: [n + 1];  corners: triangles at each vertex;  triangles: [n_triangles x 3]
kernel void dual_mesh_normals(const uint n, global const uint* restrict corner_start,
                              global const uint* restrict corners, global const uint* restrict triangles,
                              const uint first_vertex, global Vertex* vertices) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  float3 sum = (float3)(0, 0, 0);
  for (uint k = corner_start[i]; k < corner_start[i + 1]; ++k) {
    const uint3 corner = first_vertex + vload3(corners[k], triangles);
    const float3 a = vload3(0, vertices[corner.x].point), b = vload3(0, vertices[corner.y].point),
                 c = vload3(0, vertices[corner.z].point);
    sum += cross(b - a, c - a);
  }
  const float size = length(sum);
  // a vertex whose triangles have no area has no normal: 0, as Vertex says
  vstore3(size > 0 ? sum / size : (float3)(0, 0, 0), 0, vertices[first_vertex + i].normal);
}
