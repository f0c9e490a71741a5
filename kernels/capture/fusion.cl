// Fusion of depth pictures into truncated signed distances (Curless and Levoy 1996): each sample holds the weighted
// mean of  min(tau, n . (p - q)),  the distance to the tangent plane at q, which its pixel saw. A picture's weight is
// cos^2 / sigma(z)^2, falling linearly to 0 behind the surface; sigma is the sensor's noise (Nguyen et al. 2012),
// tau = max(truncation, 3 sigma). Only blocks of 8 x 8 x 8 samples near a surface are kept.
#include "capture/voxels.h"
#include "sensors/camera.cl"

#define LARGEST_REACH 4         // pixels to each side from which a pixel's normal is made
#define SMALLEST_COSINE 0.2f   // between normal and ray; what is more grazing is left out
#define FOOTPRINT_STEP 3       // pixels
#define SAMPLES_ALONG_RAY 9    // through the truncation band, where blocks are marked

static inline float depth_noise(const VoxelGrid grid, const float z) {
  return grid.noise[0] + grid.noise[1] * (z - grid.noise[2]) * (z - grid.noise[2]);
}

static inline float truncation_at(const VoxelGrid grid, const float z) {
  return max(grid.truncation, 3.0f * depth_noise(grid, z));
}

// a neighbour that belongs to another surface says nothing about this one's slope
static inline bool is_beside(const VoxelGrid grid, const float z, const float other) {
  return other > 0 && fabs(other - z) < 0.03f * z + 4.0f * depth_noise(grid, z);
}

// the point of a pixel in the camera's frame
static inline float3 seen_point(const PinholeCamera camera, const int x, const int y, const float z) {
  float3 direction = (float3)(0, 0, 1);
  pixel_direction(camera, (float2)(x, y), &direction);
  return direction * (z / direction.z);
}

// depth: [height x width, m], 0: none;  surface: [height x width] xyz: normal in the camera's frame, toward it; w: weight,
// 0: left out
kernel void weigh_depth(const uint n_pixels, const VoxelGrid grid, const PinholeCamera camera,
                        global const float* restrict depth, global float4* restrict surface) {
  const uint i = get_global_id(0);
  if (i >= n_pixels) return;
  surface[i] = (float4)(0.0f);
  const int w = (int)camera.width, h = (int)camera.height, x = (int)i % w, y = (int)i / w;
  const float z = depth[i];
  if (!(z > 0 && z < grid.max_depth)) return;
  const float3 p = seen_point(camera, x, y, z);
  // so far that two depths differ by their noise only little
  const int reach = clamp((int)(2.0f * depth_noise(grid, z) * camera.fx / z + 0.5f), 1, LARGEST_REACH);
  float3 along[2] = {(float3)(0.0f), (float3)(0.0f)};
  for (int axis = 0; axis < 2; ++axis) {
    const int dx = axis == 0 ? reach : 0, dy = axis == 0 ? 0 : reach;
    float3 end[2] = {p, p};
    for (int side = 0; side < 2; ++side) {
      const int u = side ? x + dx : x - dx, v = side ? y + dy : y - dy;
      if (u < 0 || v < 0 || u >= w || v >= h) continue;
      const float other = depth[v * w + u];
      if (is_beside(grid, z, other)) end[side] = seen_point(camera, u, v, other);
    }
    along[axis] = end[1] - end[0];
  }
  const float3 normal = cross(along[0], along[1]);
  const float size = length(normal), distance = length(p);
  if (!(size > 0)) return;  // no neighbour on one of the axes: a speck or a thin edge
  const float along_ray = dot(normal, p), cosine = fabs(along_ray) / (size * distance);
  if (!(cosine >= SMALLEST_COSINE)) return;
  const float sigma = depth_noise(grid, z), sigma_at_1m = depth_noise(grid, 1.0f);
  surface[i] = (float4)(normal * (along_ray < 0 ? 1.0f / size : -1.0f / size),
                        cosine * cosine * sigma_at_1m * sigma_at_1m / (sigma * sigma));
}

// is_near: [n blocks of the grid] 1: near a surface of some picture. Work-items write the same value.
kernel void mark_blocks(const uint n_pixels, const VoxelGrid grid, const PinholeCamera camera,
                        global const float* restrict depth, global const float4* restrict surface,
                        global uint* restrict is_near) {
  const uint i = get_global_id(0);
  if (i >= n_pixels || !(surface[i].w > 0)) return;
  const float z = depth[i], reach = truncation_at(grid, z);
  const float3 p = seen_point(camera, (int)(i % camera.width), (int)(i / camera.width), z);
  const float3 origin = (float3)(camera.to_world[3], camera.to_world[7], camera.to_world[11]);
  const float3 corner = vload3(0, grid.origin);
  for (int k = 0; k < SAMPLES_ALONG_RAY; ++k) {
    const float along = z + reach * (2.0f * k / (SAMPLES_ALONG_RAY - 1) - 1.0f);
    const float3 at = (origin + camera_vector(camera, p * (along / z)) - corner) / (grid.voxel * BLOCK_SIDE);
    const int3 block = convert_int3_rtn(at);
    if (block.x < 0 || block.y < 0 || block.z < 0 || block.x >= (int)grid.blocks[0] ||
        block.y >= (int)grid.blocks[1] || block.z >= (int)grid.blocks[2])
      continue;
    is_near[((uint)block.z * grid.blocks[1] + (uint)block.y) * grid.blocks[0] + (uint)block.x] = 1u;
  }
}

// in_view: [n_blocks] 1: a pixel that it covers, of one in FOOTPRINT_STEP on each axis, shows a surface that touches it.
// place: [n_blocks] of each kept block in the grid
kernel void find_blocks_in_view(const uint n_blocks, const VoxelGrid grid, const PinholeCamera camera,
                                const float largest_depth, global const float* restrict depth,
                                global const uint* restrict place, global uint* restrict in_view) {
  const uint i = get_global_id(0);
  if (i >= n_blocks) return;
  const uint3 block = (uint3)(place[i] % grid.blocks[0], place[i] / grid.blocks[0] % grid.blocks[1],
                              place[i] / (grid.blocks[0] * grid.blocks[1]));
  const float side = grid.voxel * BLOCK_SIDE, radius = 0.87f * side;
  const float3 p = in_camera(camera, vload3(0, grid.origin) + (convert_float3(block) + 0.5f) * side);
  in_view[i] = 0;
  if (p.z < -radius || p.z > largest_depth + radius) return;
  if (p.z <= radius) {  // around the camera
    in_view[i] = 1;
    return;
  }
  float2 pixel;
  if (!project(camera, p, &pixel)) return;
  const float margin = max(camera.fx, camera.fy) * radius / (p.z - radius);
  const int2 low = max(convert_int2_rtn(pixel - margin), (int2)(0, 0));
  const int2 high = min(convert_int2_rtn(pixel + margin), (int2)((int)camera.width - 1, (int)camera.height - 1));
  const float reach = radius + truncation_at(grid, p.z + radius);
  for (int y = low.y; y <= high.y; y += FOOTPRINT_STEP)
    for (int x = low.x; x <= high.x; x += FOOTPRINT_STEP) {
      if (fabs(depth[y * (int)camera.width + x] - p.z) > reach) continue;
      in_view[i] = 1;
      return;
    }
}

// Rays of 8 samples, (x, y) / z, and the pixels that see them.  is_seen: -1 where one does
static inline void project_row(const PinholeCamera camera, const float8 x, const float8 y, const float8 z,
                               float8* u, float8* v, int8* is_seen) {
  if (camera.model != CAMERA_FISHEYE && !camera.is_distorted) {
    *u = camera.fx * (x / z) + camera.cx;
    *v = camera.fy * (y / z) + camera.cy;
    *is_seen = z > 0.0f;
    return;
  }
  float p[3][8], pixels[2][8];
  int seen[8];
  vstore8(x, 0, p[0]);
  vstore8(y, 0, p[1]);
  vstore8(z, 0, p[2]);
  for (int k = 0; k < 8; ++k) {
    float2 pixel = (float2)(0.0f);
    seen[k] = p[2][k] > 0 && project(camera, (float3)(p[0][k], p[1][k], p[2][k]), &pixel) ? -1 : 0;
    pixels[0][k] = pixel.x;
    pixels[1][k] = pixel.y;
  }
  *u = vload8(0, pixels[0]);
  *v = vload8(0, pixels[1]);
  *is_seen = vload8(0, seen);
}

// One work-item per row of 8 samples along x, 64 per block.  in_use: [n_in_use] the blocks to look at;
// distance, weight: [n_blocks x 512]
kernel void integrate_depth(const uint n_rows, const VoxelGrid grid, const PinholeCamera camera,
                            global const float* restrict depth, global const float4* restrict surface,
                            global const uint* restrict place, global const uint* restrict in_use,
                            global float* restrict distance, global float* restrict weight) {
  const uint i = get_global_id(0);
  if (i >= n_rows) return;
  const uint block = in_use[i / 64u], row = i % 64u, at = place[block];
  const uint3 first = (uint3)(at % grid.blocks[0], at / grid.blocks[0] % grid.blocks[1],
                              at / (grid.blocks[0] * grid.blocks[1])) * BLOCK_SIDE + (uint3)(0, row % 8u, row / 8u);
  const float3 start = in_camera(camera, vload3(0, grid.origin) + convert_float3(first) * grid.voxel);
  const float3 step = (float3)(camera.to_world[0], camera.to_world[1], camera.to_world[2]) * grid.voxel;
  const float8 k8 = (float8)(0, 1, 2, 3, 4, 5, 6, 7);
  const float8 x = start.x + k8 * step.x, y = start.y + k8 * step.y, z = start.z + k8 * step.z;
  float8 u, v;
  int8 is_seen;
  project_row(camera, x, y, z, &u, &v, &is_seen);
  const int8 column = convert_int8_rtn(u + 0.5f), line = convert_int8_rtn(v + 0.5f);
  is_seen &= column >= 0 & line >= 0 & column < (int)camera.width & line < (int)camera.height;
  if (!any(is_seen)) return;
  // what the pixels saw; weight 0 where nothing
  int pixel[8];
  vstore8(select((int8)(-1), line * (int)camera.width + column, is_seen), 0, pixel);
  float seen[5][8];  // normal, weight, depth
  for (int k = 0; k < 8; ++k) {
    const float4 s = pixel[k] < 0 ? (float4)(0.0f) : surface[pixel[k]];
    seen[0][k] = s.x;
    seen[1][k] = s.y;
    seen[2][k] = s.z;
    seen[3][k] = s.w;
    seen[4][k] = pixel[k] < 0 ? 1.0f : depth[pixel[k]];
  }
  const float8 seen_weight = vload8(0, seen[3]), far = vload8(0, seen[4]);
  if (!any(seen_weight > 0.0f)) return;
  // the ray of the pixel's middle; of a distorted one to first order
  const float8 ray_x = x / z - (u - convert_float8(column)) / camera.fx, ray_y = y / z - (v - convert_float8(line)) / camera.fy;
  const float8 sigma = grid.noise[0] + grid.noise[1] * (far - grid.noise[2]) * (far - grid.noise[2]);
  const float8 tau = max(grid.truncation, 3.0f * sigma);
  const float8 d = vload8(0, seen[0]) * (x - far * ray_x) + vload8(0, seen[1]) * (y - far * ray_y) +
                   vload8(0, seen[2]) * (z - far);
  const int8 is_used = seen_weight > 0.0f & d > -tau;
  const uint samples = block * BLOCK_SIDE * BLOCK_SIDE + row;  // in rows
  const float8 old = vload8(samples, distance), old_weight = vload8(samples, weight);
  const float8 w = seen_weight * select((float8)(1.0f), 1.0f + d / tau, d < 0.0f), sum = old_weight + w;
  vstore8(select(old, old + (min(d, tau) - old) * (w / sum), is_used), samples, distance);
  vstore8(select(old_weight, sum, is_used), samples, weight);
}
