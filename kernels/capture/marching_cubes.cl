// Marching cubes (Lorensen and Cline 1987) over kept blocks. A sample owns the vertices on its three edges toward +x,
// +y, +z, and the cell whose lowest corner it is. Count, sum on the host, fill: the order never changes. The table of
// cases is made by the host (marching_cubes.cpp), which separates inside corners on every face, so that cells fit.
#include "capture/voxels.cl"

#define CASE_LENGTH 16u  // edges of at most five triangles, then 255

static inline uint3 sample_of_block(const uint i) {
  return (uint3)(i % BLOCK_SIDE, i / BLOCK_SIDE % BLOCK_SIDE, i / (BLOCK_SIDE * BLOCK_SIDE));
}

// bits 0 to 2: the surface crosses the edge toward +x, +y, +z
static inline uint crossed_edges(const VoxelGrid grid, global const uint* restrict block_of, const uint place,
                                 const uint block, const uint i, const float least_weight,
                                 global const float* restrict distance, global const float* restrict weight) {
  const uint here = block * BLOCK_VOXELS + i;
  if (!(weight[here] >= least_weight)) return 0;
  const uint3 v = sample_of_block(i);
  uint crossed = 0;
  for (uint axis = 0; axis < 3; ++axis) {
    const uint3 w = v + (uint3)(axis == 0, axis == 1, axis == 2);
    const uint there = sample_index(grid, block_of, place, block, w);
    if (there == NO_BLOCK || !(weight[there] >= least_weight)) continue;
    if ((distance[here] < 0) != (distance[there] < 0)) crossed |= 1u << axis;
  }
  return crossed;
}

// case of a cell: bit k: corner k (bits x, y, z of k) is inside; 0: none, or not all corners were seen
static inline uint cell_case(const VoxelGrid grid, global const uint* restrict block_of, const uint place,
                             const uint block, const uint i, const float least_weight,
                             global const float* restrict distance, global const float* restrict weight) {
  const uint3 v = sample_of_block(i);
  uint inside = 0;
  for (uint k = 0; k < 8; ++k) {
    const uint s = sample_index(grid, block_of, place, block, v + (uint3)(k & 1u, k >> 1 & 1u, k >> 2));
    if (s == NO_BLOCK || !(weight[s] >= least_weight)) return 0;
    if (distance[s] < 0) inside |= 1u << k;
  }
  return inside == 255u ? 0 : inside;
}

// block_of: [n blocks of the grid] the kept block there, or NO_BLOCK;  n_vertices, n_triangles: [n_blocks]
kernel void count_surface(const uint n_blocks, const VoxelGrid grid, const float least_weight,
                          global const uint* restrict block_of, global const uint* restrict place,
                          global const float* restrict distance, global const float* restrict weight,
                          global const uchar* restrict cases, global uint* restrict n_vertices,
                          global uint* restrict n_triangles) {
  const uint block = get_global_id(0);
  if (block >= n_blocks) return;
  uint vertices = 0, triangles = 0;
  for (uint i = 0; i < BLOCK_VOXELS; ++i) {
    vertices += popcount(crossed_edges(grid, block_of, place[block], block, i, least_weight, distance, weight));
    const uint inside = cell_case(grid, block_of, place[block], block, i, least_weight, distance, weight);
    for (uint k = 0; k < CASE_LENGTH - 1u && cases[inside * CASE_LENGTH + k] != 255; k += 3) ++triangles;
  }
  n_vertices[block] = vertices;
  n_triangles[block] = triangles;
}

// first_vertex: [n_blocks];  vertex_of: [n_blocks x 512] 8 x its first vertex + crossed edges;  points: [n x 3, m];
// sureness: [n] the smaller weight of the two samples
kernel void place_vertices(const uint n_blocks, const VoxelGrid grid, const float least_weight,
                           global const uint* restrict block_of, global const uint* restrict place,
                           global const float* restrict distance, global const float* restrict weight,
                           global const uint* restrict first_vertex, global uint* restrict vertex_of,
                           global float* restrict points, global float* restrict sureness) {
  const uint block = get_global_id(0);
  if (block >= n_blocks) return;
  const uint at = place[block];
  const uint3 corner = (uint3)(at % grid.blocks[0], at / grid.blocks[0] % grid.blocks[1],
                               at / (grid.blocks[0] * grid.blocks[1])) * BLOCK_SIDE;
  uint next = first_vertex[block];
  for (uint i = 0; i < BLOCK_VOXELS; ++i) {
    const uint crossed = crossed_edges(grid, block_of, at, block, i, least_weight, distance, weight);
    const uint here = block * BLOCK_VOXELS + i;
    vertex_of[here] = 8u * next + crossed;
    const uint3 v = sample_of_block(i);
    for (uint axis = 0; axis < 3; ++axis) {
      if (!(crossed >> axis & 1u)) continue;
      const uint3 unit = (uint3)(axis == 0, axis == 1, axis == 2);
      const uint there = sample_index(grid, block_of, at, block, v + unit);
      const float share = distance[here] / (distance[here] - distance[there]);
      vstore3(vload3(0, grid.origin) + (convert_float3(corner + v) + share * convert_float3(unit)) * grid.voxel, next,
              points);
      sureness[next] = min(weight[here], weight[there]);
      ++next;
    }
  }
}

// Edge e = 4 axis + k runs along `axis` from the corner whose other two bits are those of k.
// triangles: [n x 3] vertices
kernel void place_triangles(const uint n_blocks, const VoxelGrid grid, const float least_weight,
                            global const uint* restrict block_of, global const uint* restrict place,
                            global const float* restrict distance, global const float* restrict weight,
                            global const uchar* restrict cases, global const uint* restrict vertex_of,
                            global const uint* restrict first_triangle, global uint* restrict triangles) {
  const uint block = get_global_id(0);
  if (block >= n_blocks) return;
  uint next = 3u * first_triangle[block];
  for (uint i = 0; i < BLOCK_VOXELS; ++i) {
    const uint inside = cell_case(grid, block_of, place[block], block, i, least_weight, distance, weight);
    const uint3 v = sample_of_block(i);
    for (uint k = 0; k < CASE_LENGTH - 1u && cases[inside * CASE_LENGTH + k] != 255; ++k) {
      const uint edge = cases[inside * CASE_LENGTH + k], axis = edge / 4u, low = edge & 1u, high = edge >> 1 & 1u;
      const uint3 start = axis == 0 ? (uint3)(0, low, high) : axis == 1 ? (uint3)(low, 0, high) : (uint3)(low, high, 0);
      const uint owner = vertex_of[sample_index(grid, block_of, place[block], block, v + start)];
      triangles[next++] = owner / 8u + popcount(owner & ((1u << axis) - 1u));
    }
  }
}
