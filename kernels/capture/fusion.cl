// Fusion of depth pictures into truncated signed distances (Curless and Levoy 1996): each sample holds the weighted
// mean of  min(tau, n . (p - q)),  the distance to the tangent plane at q, which its pixel saw. A picture's weight is
// cos^2 / sigma(z)^2, falling linearly to 0 behind the surface; sigma is the sensor's noise (Nguyen et al. 2012),
// tau = max(truncation, 3 sigma). Only blocks of 8 x 8 x 8 samples near a surface are kept, and a picture is fused into
// those of their quarters that hold samples within tau of what it saw.
#include "capture/voxels.h"
#include "sensors/camera.cl"

#define LARGEST_REACH 4         // pixels to each side from which a pixel's normal is made
#define SMALLEST_COSINE 0.2f   // between normal and ray; what is more grazing is left out
#define ROUNDING 1e-5f         // of depths, by which bands are widened
#define SAMPLES_ALONG_RAY 9    // through the truncation band, where blocks are marked

static inline float depth_noise(const VoxelGrid grid, const float z) {
  return grid.noise[0] + grid.noise[1] * (z - grid.noise[2]) * (z - grid.noise[2]);
}

static inline float truncation_at(const VoxelGrid grid, const float z) {
  return max(grid.truncation, 3.0f * depth_noise(grid, z));
}

static inline float8 depth_noises(const VoxelGrid grid, const float8 z) {
  return grid.noise[0] + grid.noise[1] * (z - grid.noise[2]) * (z - grid.noise[2]);
}

typedef struct {
  float8 x, y, z;  // of eight points [m]
} Points8;

static inline bool has_bent_rays(const PinholeCamera* camera) {
  return camera->model == CAMERA_FISHEYE || camera->is_distorted;
}

// apart, so that seen_point is inlined
static float3 distorted_point(const PinholeCamera* camera, const int x, const int y, const float z) {
  float3 direction = (float3)(0, 0, 1);
  pixel_direction(*camera, (float2)(x, y), &direction);
  return direction * (z / direction.z);
}

// the point of a pixel in the camera's frame; a pointer, since copies of the camera would take half of the time
static inline float3 seen_point(const PinholeCamera* camera, const int x, const int y, const float z) {
  if (has_bent_rays(camera)) return distorted_point(camera, x, y, z);
  return (float3)((x - camera->cx) * (z / camera->fx), (y - camera->cy) * (z / camera->fy), z);
}

// the same for eight pixels
static inline Points8 seen_points(const PinholeCamera* camera, const int8 x, const int8 y, const float8 z) {
  Points8 p;
  p.z = z;
  if (!has_bent_rays(camera)) {
    p.x = (convert_float8(x) - camera->cx) * (z / camera->fx);
    p.y = (convert_float8(y) - camera->cy) * (z / camera->fy);
    return p;
  }
  int column[8], line[8];
  float depth[8], px[8], py[8];
  vstore8(x, 0, column);
  vstore8(y, 0, line);
  vstore8(z, 0, depth);
  for (int k = 0; k < 8; ++k) {
    const float3 q = depth[k] > 0 ? distorted_point(camera, column[k], line[k], depth[k]) : (float3)(0.0f);
    px[k] = q.x;
    py[k] = q.y;
  }
  p.x = vload8(0, px);
  p.y = vload8(0, py);
  return p;
}

static inline float8 depths_at(global const float* restrict depth, const int8 i) {
  return (float8)(depth[i.s0], depth[i.s1], depth[i.s2], depth[i.s3], depth[i.s4], depth[i.s5], depth[i.s6],
                  depth[i.s7]);
}

// One work-item per 8 pixels that follow each other.  depth: [height x width, m], 0: none;  surface: [height x width]
// xyz: normal in the camera's frame, toward it; w: depth, 0: left out
kernel void find_normals(const uint n_items, const VoxelGrid grid, const PinholeCamera camera,
                         global const float* restrict depth, global float4* restrict surface) {
  const uint i = get_global_id(0);
  if (i >= n_items) return;
  const int w = (int)camera.width, h = (int)camera.height, first = (int)i * 8, n_lanes = min(8, w * h - first);
  const int8 lane = (int8)(0, 1, 2, 3, 4, 5, 6, 7);
  int8 x = first % w + lane, y = first / w;
  for (int8 is_over = x >= w; any(is_over); is_over = x >= w) {  // into the next line
    x = select(x, x - w, is_over);
    y -= is_over;
  }
  const float8 seen = n_lanes == 8 ? vload8(i, depth) : depths_at(depth, first + min(lane, n_lanes - 1));
  int8 is_used = seen > 0.0f & seen < grid.max_depth;
  const float8 z = select((float8)(1.0f), seen, is_used), noise = depth_noises(grid, z);
  const Points8 p = seen_points(&camera, x, y, z);
  // so far that two depths differ by their noise only little
  const int8 reach = clamp(convert_int8(2.0f * noise * camera.fx / z + 0.5f), 1, LARGEST_REACH);
  Points8 along[2];
  for (int axis = 0; axis < 2; ++axis) {
    const int8 dx = axis == 0 ? reach : (int8)(0), dy = axis == 0 ? (int8)(0) : reach;
    Points8 end[2];
    for (int side = 0; side < 2; ++side) {
      const int8 u = side ? x + dx : x - dx, v = side ? y + dy : y - dy;
      const int8 is_inside = u >= 0 & v >= 0 & u < w & v < h;
      const float8 other = depths_at(depth, select((int8)(0), v * w + u, is_inside));
      // a neighbour that belongs to another surface says nothing about this one's slope
      const int8 is_beside = is_inside & (other > 0.0f) & (fabs(other - z) < 0.03f * z + 4.0f * noise);
      const Points8 q = seen_points(&camera, u, v, other);
      end[side].x = select(p.x, q.x, is_beside);
      end[side].y = select(p.y, q.y, is_beside);
      end[side].z = select(p.z, q.z, is_beside);
    }
    along[axis].x = end[1].x - end[0].x;
    along[axis].y = end[1].y - end[0].y;
    along[axis].z = end[1].z - end[0].z;
  }
  const float8 nx = along[0].y * along[1].z - along[0].z * along[1].y;
  const float8 ny = along[0].z * along[1].x - along[0].x * along[1].z;
  const float8 nz = along[0].x * along[1].y - along[0].y * along[1].x;
  const float8 size2 = nx * nx + ny * ny + nz * nz, along_ray = nx * p.x + ny * p.y + nz * p.z;
  is_used &= size2 > 0.0f;  // no neighbour on one of the axes: a speck or a thin edge
  is_used &= along_ray * along_ray >=
             SMALLEST_COSINE * SMALLEST_COSINE * size2 * (p.x * p.x + p.y * p.y + p.z * p.z);
  const float8 scale = copysign(rsqrt(size2), -along_ray), none = 0.0f;
  float out[4][8];
  vstore8(select(none, nx * scale, is_used), 0, out[0]);
  vstore8(select(none, ny * scale, is_used), 0, out[1]);
  vstore8(select(none, nz * scale, is_used), 0, out[2]);
  vstore8(select(none, z, is_used), 0, out[3]);
  for (int k = 0; k < n_lanes; ++k) surface[first + k] = (float4)(out[0][k], out[1][k], out[2][k], out[3][k]);
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

// bands: [tiles of TILE_SIDE x TILE_SIDE pixels] the depths between which a sample is within the truncation distance of
// what one of the tile's pixels saw: x: least, y: largest; x > y: nothing is seen. A sample at depth z off a pixel's
// middle has  d = far s - z m,  s = -n . (ray with z = 1),  m in s +- (|n.x| / fx + |n.y| / fy) / 2.
kernel void find_bands(const uint n_tiles, const VoxelGrid grid, const PinholeCamera camera,
                       global const float4* restrict surface, global float2* restrict bands) {
  const uint i = get_global_id(0);
  if (i >= n_tiles) return;
  const uint width = camera.width, across = (width + TILE_SIDE - 1u) / TILE_SIDE;
  const uint2 first = (uint2)(i % across, i / across) * TILE_SIDE;
  const uint2 end = min(first + TILE_SIDE, (uint2)(width, camera.height));
  float2 band = (float2)(INFINITY, 0.0f);
  for (uint y = first.y; y < end.y; ++y)
    for (uint x = first.x; x < end.x; ++x) {
      const float4 seen = surface[y * width + x];
      if (!(seen.w > 0)) continue;
      const float slope = -dot(seen.xyz, seen_point(&camera, (int)x, (int)y, 1.0f));
      const float off = 0.5f * (fabs(seen.x) / camera.fx + fabs(seen.y) / camera.fy) + ROUNDING * slope;
      const float tau = truncation_at(grid, seen.w), middle = seen.w * slope;
      band.x = min(band.x, max(0.0f, middle - tau) / (slope + off));
      band.y = max(band.y, slope > off ? (middle + tau) / (slope - off) : INFINITY);
    }
  bands[i] = band;
}

// The pixels that see 8 points at (x, y, 1) z.  is_seen: -1 where one does
static inline void project_eight(const PinholeCamera* camera, const float8 x, const float8 y, const float8 z,
                               float8* u, float8* v, int8* is_seen) {
  if (!has_bent_rays(camera)) {
    *u = camera->fx * x + camera->cx;
    *v = camera->fy * y + camera->cy;
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
    seen[k] = p[2][k] > 0 && project(*camera, (float3)(p[0][k], p[1][k], p[2][k]), &pixel) ? -1 : 0;
    pixels[0][k] = pixel.x;
    pixels[1][k] = pixel.y;
  }
  *u = vload8(0, pixels[0]);
  *v = vload8(0, pixels[1]);
  *is_seen = vload8(0, seen);
}

static inline float least_of(const float8 v) {
  const float4 a = min(v.lo, v.hi);
  return min(min(a.x, a.y), min(a.z, a.w));
}

// Whether a sample of a box of the grid may be within the truncation distance of what a pixel saw, by the tiles that it
// covers.  p: its middle in the camera's frame;  extent: half of its sides [m]
static bool is_box_in_view(const PinholeCamera* camera, const float3 p, const float3 extent,
                           global const float2* restrict bands) {
  const float half_span = extent.x * fabs(camera->to_world[2]) + extent.y * fabs(camera->to_world[6]) +
                          extent.z * fabs(camera->to_world[10]);
  const float nearest = p.z - half_span, end = p.z + half_span;
  if (end <= 0 || nearest <= 0) return end > 0;  // behind the camera or around it
  // its corners in the picture
  const float8 dx = extent.x * (float8)(-1, 1, -1, 1, -1, 1, -1, 1),
               dy = extent.y * (float8)(-1, -1, 1, 1, -1, -1, 1, 1),
               dz = extent.z * (float8)(-1, -1, -1, -1, 1, 1, 1, 1);
  const float8 z = p.z + camera->to_world[2] * dx + camera->to_world[6] * dy + camera->to_world[10] * dz;
  const float8 x = (p.x + camera->to_world[0] * dx + camera->to_world[4] * dy + camera->to_world[8] * dz) / z;
  const float8 y = (p.y + camera->to_world[1] * dx + camera->to_world[5] * dy + camera->to_world[9] * dz) / z;
  float8 u, v;
  int8 is_seen;
  project_eight(camera, x, y, z, &u, &v, &is_seen);
  if (!any(is_seen)) return false;
  const float8 none = INFINITY;
  const float2 low = (float2)(least_of(select(none, u, is_seen)), least_of(select(none, v, is_seen)));
  const float2 high = -(float2)(least_of(select(none, -u, is_seen)), least_of(select(none, -v, is_seen)));
  // edges between corners are bent where rays are
  const float2 margin = 0.5f + (has_bent_rays(camera) ? 0.1f * (high - low) : (float2)(0.0f));
  const float2 last_pixel = (float2)(camera->width - 1u, camera->height - 1u);
  if (any(high + margin < 0.0f) || any(low - margin > last_pixel)) return false;
  const uint2 first = convert_uint2(max(low - margin, 0.0f)) / TILE_SIDE;
  const uint2 last = convert_uint2(min(high + margin + 0.5f, last_pixel)) / TILE_SIDE;
  const uint across = (camera->width + TILE_SIDE - 1u) / TILE_SIDE;
  for (uint row = first.y; row <= last.y; ++row)
    for (uint column = first.x; column <= last.x; ++column) {
      const float2 band = bands[row * across + column];
      if (band.x <= end && band.y >= nearest) return true;
    }
  return false;
}

// in_view: [n_blocks] bit k: a sample of the k-th quarter of the block, 8 x 4 x 4 samples, may be within the truncation
// distance of what a pixel saw.  place: [n_blocks] of each kept block in the grid
kernel void find_blocks_in_view(const uint n_blocks, const VoxelGrid grid, const PinholeCamera camera,
                                global const float2* restrict bands, global const uint* restrict place,
                                global uint* restrict in_view) {
  const uint i = get_global_id(0);
  if (i >= n_blocks) return;
  const uint3 block = (uint3)(place[i] % grid.blocks[0], place[i] / grid.blocks[0] % grid.blocks[1],
                              place[i] / (grid.blocks[0] * grid.blocks[1]));
  const float along = 0.5f * (BLOCK_SIDE - 1u) * grid.voxel, across = 0.5f * (BLOCK_SIDE / 2u - 1u) * grid.voxel;
  const float3 middle = vload3(0, grid.origin) + convert_float3(block) * (grid.voxel * BLOCK_SIDE) + along;
  uint seen = 0;
  if (is_box_in_view(&camera, in_camera(camera, middle), (float3)(along), bands))
    for (uint k = 0; k < 4u; ++k) {
      const float3 shift = (float3)(0, k & 1u ? 1 : -1, k & 2u ? 1 : -1) * (along - across);
      const float3 p = in_camera(camera, middle + shift);
      if (is_box_in_view(&camera, p, (float3)(along, across, across), bands)) seen |= 1u << k;
    }
  in_view[i] = seen;
}

// One work-item per row of 8 samples along x, 16 per quarter of a block.  in_use: [n_in_use] the quarters to look at, four
// times the block and which;  distance, weight: [n_blocks x 512]
kernel void integrate_depth(const uint n_rows, const VoxelGrid grid, const PinholeCamera camera,
                            global const float4* restrict surface, global const uint* restrict place,
                            global const uint* restrict in_use, global float* restrict distance,
                            global float* restrict weight) {
  const uint i = get_global_id(0);
  if (i >= n_rows) return;
  const uint block = in_use[i / 16u] / 4u, quarter = in_use[i / 16u] % 4u, at = place[block];
  const uint2 line = (uint2)(i % 4u + 4u * (quarter % 2u), i / 4u % 4u + 4u * (quarter / 2u));  // in the block
  const uint3 first = (uint3)(at % grid.blocks[0], at / grid.blocks[0] % grid.blocks[1],
                              at / (grid.blocks[0] * grid.blocks[1])) * BLOCK_SIDE + (uint3)(0, line.x, line.y);
  const float3 start = in_camera(camera, vload3(0, grid.origin) + convert_float3(first) * grid.voxel);
  const float3 step = (float3)(camera.to_world[0], camera.to_world[1], camera.to_world[2]) * grid.voxel;
  const float8 k8 = (float8)(0, 1, 2, 3, 4, 5, 6, 7);
  const float8 z = start.z + k8 * step.z, inverse = 1.0f / z;
  const float8 x = (start.x + k8 * step.x) * inverse, y = (start.y + k8 * step.y) * inverse;
  float8 u, v;
  int8 is_seen;
  project_eight(&camera, x, y, z, &u, &v, &is_seen);
  const float8 across = u + 0.5f, down = v + 0.5f;
  is_seen &= across >= 0.0f & down >= 0.0f & across < (float)camera.width & down < (float)camera.height;
  const int8 column = convert_int8(across), row = convert_int8(down);  // of those that are seen
  if (!any(is_seen)) return;
  const int8 pixel = select((int8)(0), row * (int)camera.width + column, is_seen);
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
  const float8 ray_y = y - (v - convert_float8(row)) * (1.0f / camera.fy);
  const float8 slope = normal_x * ray_x + normal_y * ray_y + normal_z;
  const float8 d = (normal_x * x + normal_y * y + normal_z) * z - far * slope;
  const float8 sigma = depth_noises(grid, far);
  const float8 tau = max(grid.truncation, 3.0f * sigma);
  const float8 clear = depth_noise(grid, 1.0f) * slope;
  const float8 seen_weight = clear * clear / (sigma * sigma * (ray_x * ray_x + ray_y * ray_y + 1.0f));
  is_seen &= d > -tau;
  if (!any(is_seen)) return;
  const uint samples = (block * BLOCK_SIDE + line.y) * BLOCK_SIDE + line.x;  // in rows
  const float8 old = vload8(samples, distance), old_weight = vload8(samples, weight);
  const float8 w = seen_weight * select((float8)(1.0f), 1.0f + d / tau, d < 0.0f), sum = old_weight + w;
  vstore8(select(old, old + (min(d, tau) - old) * (w / sum), is_seen), samples, distance);
  vstore8(select(old_weight, sum, is_seen), samples, weight);
}
