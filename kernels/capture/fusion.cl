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

// apart, so that seen_point is inlined
static float3 distorted_point(const PinholeCamera* camera, const int x, const int y, const float z) {
  float3 direction = (float3)(0, 0, 1);
  pixel_direction(*camera, (float2)(x, y), &direction);
  return direction * (z / direction.z);
}

// the point of a pixel in the camera's frame; a pointer, since copies of the camera would take half of the time
static inline float3 seen_point(const PinholeCamera* camera, const int x, const int y, const float z) {
  if (camera->model == CAMERA_FISHEYE || camera->is_distorted) return distorted_point(camera, x, y, z);
  return (float3)((x - camera->cx) * (z / camera->fx), (y - camera->cy) * (z / camera->fy), z);
}

// depth: [height x width, m], 0: none;  surface: [height x width] xyz: normal in the camera's frame, toward it; w:
// depth, 0: left out
kernel void find_normals(const uint n_pixels, const VoxelGrid grid, const PinholeCamera camera,
                        global const float* restrict depth, global float4* restrict surface) {
  const uint i = get_global_id(0);
  if (i >= n_pixels) return;
  surface[i] = (float4)(0.0f);
  const int w = (int)camera.width, h = (int)camera.height, x = (int)i % w, y = (int)i / w;
  const float z = depth[i];
  if (!(z > 0 && z < grid.max_depth)) return;
  const float3 p = seen_point(&camera, x, y, z);
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
      if (is_beside(grid, z, other)) end[side] = seen_point(&camera, u, v, other);
    }
    along[axis] = end[1] - end[0];
  }
  const float3 normal = cross(along[0], along[1]);
  const float size2 = dot(normal, normal), along_ray = dot(normal, p);
  if (!(size2 > 0)) return;  // no neighbour on one of the axes: a speck or a thin edge
  if (!(along_ray * along_ray >= SMALLEST_COSINE * SMALLEST_COSINE * size2 * dot(p, p))) return;
  surface[i] = (float4)(normal * copysign(rsqrt(size2), -along_ray), z);
}

// is_near: [n blocks of the grid] 1: near a surface of some picture. Work-items write the same value.
kernel void mark_blocks(const uint n_pixels, const VoxelGrid grid, const PinholeCamera camera,
                        global const float4* restrict surface, global uint* restrict is_near) {
  const uint i = get_global_id(0);
  if (i >= n_pixels || !(surface[i].w > 0)) return;
  const float z = surface[i].w, reach = truncation_at(grid, z);
  const float3 p = seen_point(&camera, (int)(i % camera.width), (int)(i / camera.width), z);
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

// in_view: [n_blocks] 1: a pixel that it covers, of one in FOOTPRINT_STEP on each axis, shows a surface that touches
// it.  place: [n_blocks] of each kept block in the grid
kernel void find_blocks_in_view(const uint n_blocks, const VoxelGrid grid, const PinholeCamera camera,
                                const float largest_depth, global const float* restrict depth,
                                global const uint* restrict place, global uint* restrict in_view) {
  const uint i = get_global_id(0);
  if (i >= n_blocks) return;
  const uint3 block = (uint3)(place[i] % grid.blocks[0], place[i] / grid.blocks[0] % grid.blocks[1],
                              place[i] / (grid.blocks[0] * grid.blocks[1]));
  const float side = grid.voxel * BLOCK_SIDE, radius = 0.87f * side;
  // half of what a block spans along the camera's axis
  const float half_span =
      0.5f * side * (fabs(camera.to_world[2]) + fabs(camera.to_world[6]) + fabs(camera.to_world[10]));
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
  const float reach = half_span + truncation_at(grid, p.z + radius);
  for (int y = low.y; y <= high.y; y += FOOTPRINT_STEP)
    for (int x = low.x; x <= high.x; x += FOOTPRINT_STEP) {
      if (fabs(depth[y * (int)camera.width + x] - p.z) > reach) continue;
      in_view[i] = 1;
      return;
    }
}

// The pixels that see 8 samples at (x, y, 1) z.  is_seen: -1 where one does
static inline void project_row(const PinholeCamera camera, const float8 x, const float8 y, const float8 z,
                               float8* u, float8* v, int8* is_seen) {
  if (camera.model != CAMERA_FISHEYE && !camera.is_distorted) {
    *u = camera.fx * x + camera.cx;
    *v = camera.fy * y + camera.cy;
    *is_seen = z > 0.0f;
    return;
  }
  float p[3][8], pixels[2][8];
  int seen[8];
  vstore8(x * z, 0, p[0]);
  vstore8(y * z, 0, p[1]);
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
                            global const float4* restrict surface, global const uint* restrict place,
                            global const uint* restrict in_use, global float* restrict distance,
                            global float* restrict weight) {
  const uint i = get_global_id(0);
  if (i >= n_rows) return;
  const uint block = in_use[i / 64u], row = i % 64u, at = place[block];
  const uint3 first = (uint3)(at % grid.blocks[0], at / grid.blocks[0] % grid.blocks[1],
                              at / (grid.blocks[0] * grid.blocks[1])) * BLOCK_SIDE + (uint3)(0, row % 8u, row / 8u);
  const float3 start = in_camera(camera, vload3(0, grid.origin) + convert_float3(first) * grid.voxel);
  const float3 step = (float3)(camera.to_world[0], camera.to_world[1], camera.to_world[2]) * grid.voxel;
  const float8 k8 = (float8)(0, 1, 2, 3, 4, 5, 6, 7);
  const float8 z = start.z + k8 * step.z, inverse = 1.0f / z;
  const float8 x = (start.x + k8 * step.x) * inverse, y = (start.y + k8 * step.y) * inverse;
  float8 u, v;
  int8 is_seen;
  project_row(camera, x, y, z, &u, &v, &is_seen);
  const int8 column = convert_int8_rtn(u + 0.5f), line = convert_int8_rtn(v + 0.5f);
  is_seen &= column >= 0 & line >= 0 & column < (int)camera.width & line < (int)camera.height;
  if (!any(is_seen)) return;
  const int8 pixel = select((int8)(0), line * (int)camera.width + column, is_seen);
  const float4 s0 = surface[pixel.s0], s1 = surface[pixel.s1], s2 = surface[pixel.s2], s3 = surface[pixel.s3],
               s4 = surface[pixel.s4], s5 = surface[pixel.s5], s6 = surface[pixel.s6], s7 = surface[pixel.s7];
  const float8 far = (float8)(s0.w, s1.w, s2.w, s3.w, s4.w, s5.w, s6.w, s7.w);
  is_seen &= far > 0.0f;
  if (!any(is_seen)) return;
  const float8 normal_x = (float8)(s0.x, s1.x, s2.x, s3.x, s4.x, s5.x, s6.x, s7.x);
  const float8 normal_y = (float8)(s0.y, s1.y, s2.y, s3.y, s4.y, s5.y, s6.y, s7.y);
  const float8 normal_z = (float8)(s0.z, s1.z, s2.z, s3.z, s4.z, s5.z, s6.z, s7.z);
  // the ray of the pixel's middle; of a distorted one to first order
  const float8 ray_x = x - (u - convert_float8(column)) * (1.0f / camera.fx);
  const float8 ray_y = y - (v - convert_float8(line)) * (1.0f / camera.fy);
  const float8 slope = normal_x * ray_x + normal_y * ray_y + normal_z;
  const float8 d = (normal_x * x + normal_y * y + normal_z) * z - far * slope;
  const float8 sigma = grid.noise[0] + grid.noise[1] * (far - grid.noise[2]) * (far - grid.noise[2]);
  const float8 tau = max(grid.truncation, 3.0f * sigma);
  const float8 clear = depth_noise(grid, 1.0f) * slope;
  const float8 seen_weight = clear * clear / (sigma * sigma * (ray_x * ray_x + ray_y * ray_y + 1.0f));
  is_seen &= d > -tau;
  const uint samples = block * BLOCK_SIDE * BLOCK_SIDE + row;  // in rows
  const float8 old = vload8(samples, distance), old_weight = vload8(samples, weight);
  const float8 w = seen_weight * select((float8)(1.0f), 1.0f + d / tau, d < 0.0f), sum = old_weight + w;
  vstore8(select(old, old + (min(d, tau) - old) * (w / sum), is_seen), samples, distance);
  vstore8(select(old_weight, sum, is_seen), samples, weight);
}
