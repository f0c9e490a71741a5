// How a picture of depth has to move so that it lies on a surface: Gauss-Newton sums over its pixels (Bylow et al. 2013).
// A pixel's point p has the residual r = D(p), D the fused distance between samples, trilinear. The camera at c moves by
// a rotation w about itself and a translation v:  p' = p + w x (p - c) + v,  dr/d(w, v) = ((p - c) x grad D, grad D).
// To first order this is point-to-plane with projective association (Chen and Medioni 1991), as D is a mean of distances
// to tangent planes. A pixel counts with 1 / sigma(z)^2, beyond HUBER sigma with less, and not at all where D is cut
// off or the surface faces elsewhere.
#include "capture/voxels.cl"
#include "sensors/camera.cl"

#define ITEMS 64u              // of a work-group
#define HUBER 2.0f             // standard deviations
#define LARGEST_DISTANCE 0.8f  // of the truncation distance
#define SMALLEST_FACING 0.7f   // cosine between the normals of picture and surface

// D and its gradient; false: a sample around is missing.  p: [voxels from the grid's first sample]
static inline bool distance_at(const VoxelGrid* grid, const float3 p, const float least_weight,
                               global const uint* restrict block_of, global const float* restrict distance,
                               global const float* restrict weight, float* value, float3* gradient) {
  if (!all(p >= 0.0f)) return false;
  const uint3 low = convert_uint3(p), block = low / BLOCK_SIDE;
  if (block.x >= grid->blocks[0] || block.y >= grid->blocks[1] || block.z >= grid->blocks[2]) return false;
  const uint place = (block.z * grid->blocks[1] + block.y) * grid->blocks[0] + block.x, kept = block_of[place];
  if (kept == NO_BLOCK) return false;
  float d[8];  // of the corners, bits x, y, z of their number
  for (uint k = 0; k < 8; ++k) {
    const uint s = sample_index(*grid, block_of, place, kept, low % BLOCK_SIDE + (uint3)(k & 1u, k >> 1 & 1u, k >> 2));
    if (s == NO_BLOCK || !(weight[s] >= least_weight)) return false;
    d[k] = distance[s];
  }
  const float3 t = p - convert_float3(low);
  const float4 near_x = (float4)(d[0], d[2], d[4], d[6]), far_x = (float4)(d[1], d[3], d[5], d[7]);
  const float4 along_x = mix(near_x, far_x, t.x), slope_x = far_x - near_x;
  const float2 along_y = mix(along_x.xz, along_x.yw, t.y), slope_y = along_x.yw - along_x.xz;
  const float2 slope_xy = mix(slope_x.xz, slope_x.yw, t.y);
  *value = mix(along_y.x, along_y.y, t.z);
  *gradient = (float3)(mix(slope_xy.x, slope_xy.y, t.z), mix(slope_y.x, slope_y.y, t.z), along_y.y - along_y.x) /
              grid->voxel;
  return true;
}

// What one pixel adds: J^T J (upper triangle by rows), J^T r, r^2 and 1, all with its weight, and 1
static inline void add_pixel(const VoxelGrid* grid, const PinholeCamera* camera, const uint x, const uint y,
                             const float4 seen, const float least_weight, global const uint* restrict block_of,
                             global const float* restrict distance, global const float* restrict weight,
                             float sums[REGISTRATION_SUMS]) {
  float3 ray, gradient;
  float r;
  if (!(seen.w > 0) || !pixel_direction(*camera, (float2)(x, y), &ray)) return;
  const float3 arm = camera_vector(*camera, ray * (seen.w / ray.z));
  const float3 eye = (float3)(camera->to_world[3], camera->to_world[7], camera->to_world[11]);
  const float3 p = (arm + (eye - vload3(0, grid->origin))) / grid->voxel;
  if (!distance_at(grid, p, least_weight, block_of, distance, weight, &r, &gradient)) return;
  if (!(fabs(r) < LARGEST_DISTANCE * grid->truncation)) return;
  if (!(dot(camera_vector(*camera, seen.xyz), gradient) > SMALLEST_FACING * length(gradient))) return;
  const float sigma = depth_noise(grid, seen.w), off = fabs(r) / sigma;
  const float w = (off > HUBER ? HUBER / off : 1.0f) / (sigma * sigma);
  const float3 turn = cross(arm, gradient);
  const float J[6] = {turn.x, turn.y, turn.z, gradient.x, gradient.y, gradient.z};
  uint k = 0;
  for (uint row = 0; row < 6; ++row)
    for (uint column = row; column < 6; ++column) sums[k++] += w * J[row] * J[column];
  for (uint row = 0; row < 6; ++row) sums[k++] += w * J[row] * r;
  sums[k++] += w * r * r;
  sums[k++] += w;
  sums[k] += 1.0f;
}

// One work-item per REGISTRATION_PIXELS of a row, of which, as of the rows, every stride-th is looked at. Then each of the
// first work-items of a group sums one number of all of them.  surface: [height x width] of fusion.cl;  sums: [n_groups x
// REGISTRATION_SUMS]
kernel void register_depth(const uint n_items, const VoxelGrid grid, const PinholeCamera camera, const uint stride,
                           const float least_weight, global const float4* restrict surface,
                           global const uint* restrict block_of, global const float* restrict distance,
                           global const float* restrict weight, global float* restrict sums) {
  local float of_item[ITEMS * REGISTRATION_SUMS];
  const uint i = get_global_id(0), item = get_local_id(0), width = camera.width;
  const uint per_row = (width + stride * REGISTRATION_PIXELS - 1u) / (stride * REGISTRATION_PIXELS);
  const uint y = i / per_row * stride, first = i % per_row * (stride * REGISTRATION_PIXELS);
  float own[REGISTRATION_SUMS];
  for (uint k = 0; k < REGISTRATION_SUMS; ++k) own[k] = 0.0f;
  if (i < n_items)
    for (uint x = first; x < min(width, first + stride * REGISTRATION_PIXELS); x += stride)
      add_pixel(&grid, &camera, x, y, surface[y * width + x], least_weight, block_of, distance, weight, own);
  for (uint k = 0; k < REGISTRATION_SUMS; ++k) of_item[item * REGISTRATION_SUMS + k] = own[k];
  barrier(CLK_LOCAL_MEM_FENCE);
  if (item >= REGISTRATION_SUMS) return;
  float sum = 0.0f;
  for (uint k = 0; k < ITEMS; ++k) sum += of_item[k * REGISTRATION_SUMS + item];
  sums[get_group_id(0) * REGISTRATION_SUMS + item] = sum;
}
