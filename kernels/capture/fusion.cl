// Fusion of depth pictures into truncated signed distances (Curless and Levoy 1996): each sample holds the weighted
// mean of  min(tau, n . (p - q)),  the distance to the tangent plane at q, which its pixel saw. A picture's weight is
// cos^2 / sigma(z)^2, falling linearly to 0 behind the surface; sigma is the sensor's noise (Nguyen et al. 2012),
// tau = max(truncation, 3 sigma). Only blocks of 8 x 8 x 8 samples near a surface are kept, and a picture is fused into
// those of their quarters that hold samples within tau of what it saw. A work-item has N_FLOATS pixels or samples.
#include "capture/voxels.cl"
#include "sensors/camera.cl"
#include "shared/float_lanes.h"

#define LARGEST_REACH 4         // pixels to each side from which a pixel's normal is made
#define SMALLEST_COSINE 0.2f   // between normal and ray; what is more grazing is left out
#define LEAST_LEFT 1e-3f        // of a picture's weight, that others must have left where it is taken out
#define ROUNDING 1e-5f         // of depths, by which bands are widened
#define SAMPLES_ALONG_RAY 9    // through the truncation band, where blocks are marked
#define QUARTER_VOXELS 128u    // samples of a quarter of a block, 8 x 4 x 4

static inline floats depth_noises(const VoxelGrid* grid, const floats z) {
  return grid->noise[0] + grid->noise[1] * (z - grid->noise[2]) * (z - grid->noise[2]);
}

typedef struct {
  floats x, y, z;
} Points;

typedef struct {
  ints x, y;
} Pixels;

static inline bool has_bent_rays(const PinholeCamera* camera) {
  return camera->model == CAMERA_FISHEYE || camera->is_distorted;
}

// apart, so that seen_points is inlined
static float3 distorted_point(const PinholeCamera* camera, const int x, const int y, const float z) {
  float3 direction = (float3)(0, 0, 1);
  pixel_direction(*camera, (float2)(x, y), &direction);
  return direction * (z / direction.z);
}

// the points of pixels in the camera's frame [m]; a pointer, since copies of the camera would take half of the time
static inline Points seen_points(const PinholeCamera* camera, Pixels pixel, floats z) {
  Points p;
  p.z = z;
  if (!has_bent_rays(camera)) {
    p.x = (AS_FLOATS(pixel.x) - camera->cx) * (z / camera->fx);
    p.y = (AS_FLOATS(pixel.y) - camera->cy) * (z / camera->fy);
    return p;
  }
  p.x = 0.0f;
  p.y = 0.0f;
#pragma unroll
  for (uint k = 0; k < N_FLOATS; ++k) {
    if (!(FLOAT_LANE(z, k) > 0)) continue;
    const float3 q = distorted_point(camera, INT_LANE(pixel.x, k), INT_LANE(pixel.y, k), FLOAT_LANE(z, k));
    FLOAT_LANE(p.x, k) = q.x;
    FLOAT_LANE(p.y, k) = q.y;
  }
  return p;
}

// the same for one pixel at depth 1
static inline float3 seen_ray(const PinholeCamera* camera, const int x, const int y) {
  if (has_bent_rays(camera)) return distorted_point(camera, x, y, 1.0f);
  return (float3)((x - camera->cx) * (1.0f / camera->fx), (y - camera->cy) * (1.0f / camera->fy), 1.0f);
}

// pixels that follow each other, from the one with number `first`
static inline Pixels pixels_from(const PinholeCamera* camera, const int first) {
  const int w = (int)camera->width;
  Pixels p;
  p.x = first % w + FLOAT_NUMBERS;
  p.y = first / w;
  for (ints is_over = p.x >= w; ANY_FLOAT(is_over); is_over = p.x >= w) {  // into the next line
    p.x = select(p.x, p.x - w, is_over);
    p.y = select(p.y, p.y + 1, is_over);
  }
  return p;
}

static inline floats depths_at(global const float* restrict depth, ints i) {
  floats d;
#pragma unroll
  for (uint k = 0; k < N_FLOATS; ++k) FLOAT_LANE(d, k) = depth[INT_LANE(i, k)];
  return d;
}

// One work-item per N_FLOATS pixels that follow each other.  depth: [height x width, m], 0: none;  surface: [height x
// width] xyz: normal in the camera's frame, toward it; w: depth, 0: left out
kernel void find_normals(const uint n_items, const VoxelGrid grid, const PinholeCamera camera,
                         global const float* restrict depth, global float4* restrict surface) {
  const uint i = get_global_id(0);
  if (i >= n_items) return;
  const int w = (int)camera.width, h = (int)camera.height, first = (int)i * N_FLOATS;
  const Pixels pixel = pixels_from(&camera, first);
  const floats seen = depths_at(depth, min(first + FLOAT_NUMBERS, w * h - 1));
  ints is_used = (seen > 0.0f) & (seen < grid.max_depth);
  const floats none = 0.0f, z = select((floats)(1.0f), seen, is_used), noise = depth_noises(&grid, z);
  const Points p = seen_points(&camera, pixel, z);
  // so far that two depths differ by their noise only little
  const ints reach = clamp(AS_INTS(2.0f * noise * camera.fx / z + 0.5f), 1, LARGEST_REACH);
  Points along[2];
  for (int axis = 0; axis < 2; ++axis) {
    Points end[2];
    for (int side = 0; side < 2; ++side) {
      const ints shift = side ? reach : -reach;
      Pixels beside = pixel;
      if (axis == 0) beside.x += shift;
      if (axis == 1) beside.y += shift;
      const ints is_inside = (beside.x >= 0) & (beside.y >= 0) & (beside.x < w) & (beside.y < h);
      const floats other = depths_at(depth, select((ints)(0), beside.y * w + beside.x, is_inside));
      // a neighbour that belongs to another surface says nothing about this one's slope
      const ints is_beside = is_inside & (other > 0.0f) & (fabs(other - z) < 0.03f * z + 4.0f * noise);
      const Points q = seen_points(&camera, beside, other);
      end[side].x = select(p.x, q.x, is_beside);
      end[side].y = select(p.y, q.y, is_beside);
      end[side].z = select(p.z, q.z, is_beside);
    }
    along[axis].x = end[1].x - end[0].x;
    along[axis].y = end[1].y - end[0].y;
    along[axis].z = end[1].z - end[0].z;
  }
  const floats nx = along[0].y * along[1].z - along[0].z * along[1].y;
  const floats ny = along[0].z * along[1].x - along[0].x * along[1].z;
  const floats nz = along[0].x * along[1].y - along[0].y * along[1].x;
  const floats size2 = nx * nx + ny * ny + nz * nz, along_ray = nx * p.x + ny * p.y + nz * p.z;
  is_used &= size2 > 0.0f;  // no neighbour on one of the axes: a speck or a thin edge
  is_used &= along_ray * along_ray >=
             SMALLEST_COSINE * SMALLEST_COSINE * size2 * (p.x * p.x + p.y * p.y + p.z * p.z);
  const floats scale = copysign(rsqrt(size2), -along_ray);
  floats x = select(none, nx * scale, is_used), y = select(none, ny * scale, is_used);
  floats normal_z = select(none, nz * scale, is_used), used = select(none, z, is_used);
  for (int k = 0; k < min(N_FLOATS, w * h - first); ++k)
    surface[first + k] = (float4)(FLOAT_LANE(x, k), FLOAT_LANE(y, k), FLOAT_LANE(normal_z, k), FLOAT_LANE(used, k));
}

// One work-item per N_FLOATS pixels that follow each other.  is_near: [n blocks of the grid] 1: near a surface of some
// picture. Work-items write the same value.
kernel void mark_blocks(const uint n_items, const VoxelGrid grid, const PinholeCamera camera,
                        global const float4* restrict surface, global uint* restrict is_near) {
  const uint i = get_global_id(0);
  if (i >= n_items) return;
  const int n_pixels = (int)(camera.width * camera.height), first = (int)i * N_FLOATS;
  floats z;
#pragma unroll
  for (int k = 0; k < N_FLOATS; ++k) FLOAT_LANE(z, k) = first + k < n_pixels ? surface[first + k].w : 0.0f;
  const ints is_seen = z > 0.0f;
  if (!ANY_FLOAT(is_seen)) return;
  const floats reach = max(grid.truncation, 3.0f * depth_noises(&grid, z));
  // the ray with z = 1, in blocks
  const Points p = seen_points(&camera, pixels_from(&camera, first), select((floats)(1.0f), z, is_seen));
  const float* m = camera.to_world;
  const float scale = 1.0f / (grid.voxel * BLOCK_SIDE);
  const floats by_depth = scale / p.z;
  const floats dx = (m[0] * p.x + m[1] * p.y + m[2] * p.z) * by_depth;
  const floats dy = (m[4] * p.x + m[5] * p.y + m[6] * p.z) * by_depth;
  const floats dz = (m[8] * p.x + m[9] * p.y + m[10] * p.z) * by_depth;
  const float3 start = ((float3)(m[3], m[7], m[11]) - vload3(0, grid.origin)) * scale;
  const float3 n_blocks = convert_float3(vload3(0, grid.blocks));
  ints marked = -1;
  for (int k = 0; k < SAMPLES_ALONG_RAY; ++k) {
    const floats along = z + reach * (2.0f * k / (SAMPLES_ALONG_RAY - 1) - 1.0f);
    const floats x = start.x + dx * along, y = start.y + dy * along, h = start.z + dz * along;
    ints is_new = is_seen & (x >= 0.0f) & (y >= 0.0f) & (h >= 0.0f);
    is_new &= (x < n_blocks.x) & (y < n_blocks.y) & (h < n_blocks.z);
    const ints row = AS_INTS(h) * (int)grid.blocks[1] + AS_INTS(y);
    ints block = row * (int)grid.blocks[0] + AS_INTS(x);
    is_new &= block != marked;
    marked = block;
    if (!ANY_FLOAT(is_new)) continue;
    for (int lane = 0; lane < N_FLOATS; ++lane)
      if (INT_LANE(is_new, lane)) is_near[INT_LANE(block, lane)] = 1u;
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
      const float slope = -dot(seen.xyz, seen_ray(&camera, (int)x, (int)y));
      const float off = 0.5f * (fabs(seen.x) / camera.fx + fabs(seen.y) / camera.fy) + ROUNDING * slope;
      const float tau = max(grid.truncation, 3.0f * depth_noise(&grid, seen.w)), middle = seen.w * slope;
      band.x = min(band.x, max(0.0f, middle - tau) / (slope + off));
      band.y = max(band.y, slope > off ? (middle + tau) / (slope - off) : INFINITY);
    }
  bands[i] = band;
}

// The pixels that see the points (x, y, 1) z.  is_seen: not 0 where one does
static inline void project_points(const PinholeCamera* camera, floats x, floats y, floats z, floats* u, floats* v,
                                  ints* is_seen) {
  if (!has_bent_rays(camera)) {
    *u = camera->fx * x + camera->cx;
    *v = camera->fy * y + camera->cy;
    *is_seen = z > 0.0f;
    return;
  }
  floats px = x * z, py = y * z;
  *is_seen = 0;
#pragma unroll
  for (uint k = 0; k < N_FLOATS; ++k) {
    const float3 p = (float3)(FLOAT_LANE(px, k), FLOAT_LANE(py, k), FLOAT_LANE(z, k));
    float2 pixel = (float2)(0.0f);
    if (p.z > 0 && project(*camera, p, &pixel)) INT_LANE(*is_seen, k) = -1;
    FLOAT_LANE(*u, k) = pixel.x;
    FLOAT_LANE(*v, k) = pixel.y;
  }
}

// Whether a sample of a box of the grid may be within the truncation distance of what a pixel saw, by the tiles that it
// covers.  p: its middle in the camera's frame;  extent: half of its sides [m]
static bool is_box_in_view(const PinholeCamera* camera, const float3 p, const float3 extent,
                           global const float2* restrict bands) {
  const float* m = camera->to_world;
  const float half_span = extent.x * fabs(m[2]) + extent.y * fabs(m[6]) + extent.z * fabs(m[10]);
  const float nearest = p.z - half_span, end = p.z + half_span;
  if (end <= 0 || nearest <= 0) return end > 0;  // behind the camera or around it
  // its corners in the picture; lanes beyond the eighth see them again
  float2 low = (float2)(INFINITY), high = (float2)(-INFINITY);
  for (int first = 0; first < 8; first += N_FLOATS) {
    const ints corner = first + FLOAT_NUMBERS;
    const floats dx = select((floats)(-extent.x), (floats)(extent.x), (corner & 1) != 0);
    const floats dy = select((floats)(-extent.y), (floats)(extent.y), (corner & 2) != 0);
    const floats dz = select((floats)(-extent.z), (floats)(extent.z), (corner & 4) != 0);
    const floats z = p.z + m[2] * dx + m[6] * dy + m[10] * dz;
    const floats x = (p.x + m[0] * dx + m[4] * dy + m[8] * dz) / z;
    const floats y = (p.y + m[1] * dx + m[5] * dy + m[9] * dz) / z;
    floats u, v;
    ints is_seen;
    project_points(camera, x, y, z, &u, &v, &is_seen);
    const floats none = INFINITY;
    low = min(low, (float2)(least_float(select(none, u, is_seen)), least_float(select(none, v, is_seen))));
    high = max(high, -(float2)(least_float(select(none, -u, is_seen)), least_float(select(none, -v, is_seen))));
  }
  // edges between corners are bent where rays are
  const float2 margin = 0.5f + (has_bent_rays(camera) ? 0.1f * (high - low) : (float2)(0.0f));
  const float2 last_pixel = (float2)(camera->width - 1u, camera->height - 1u);
  if (any(high < low) || any(high + margin < 0.0f) || any(low - margin > last_pixel)) return false;
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

static inline uint3 block_at(const VoxelGrid* grid, const uint place) {
  return (uint3)(place % grid->blocks[0], place / grid->blocks[0] % grid->blocks[1],
                 place / (grid->blocks[0] * grid->blocks[1]));
}

// in_view: [n_blocks] bit k: a sample of the k-th quarter of the block, 8 x 4 x 4 samples, may be within the truncation
// distance of what a pixel saw.  place: [n_blocks] of each kept block in the grid
kernel void find_blocks_in_view(const uint n_blocks, const VoxelGrid grid, const PinholeCamera camera,
                                global const float2* restrict bands, global const uint* restrict place,
                                global uint* restrict in_view) {
  const uint i = get_global_id(0);
  if (i >= n_blocks) return;
  const uint3 block = block_at(&grid, place[i]);
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

// One work-item per N_FLOATS samples of a quarter of a block, x fastest, then y.  in_use: [n_in_use] the quarters to look
// at, four times the block and which;  distance, weight: [n_blocks x 512];  is_taken_out: 1: the picture was integrated
// before with this camera, and goes
kernel void integrate_depth(const uint n_items, const VoxelGrid grid, const PinholeCamera camera,
                            global const float4* restrict surface, global const uint* restrict place,
                            global const uint* restrict in_use, const uint is_taken_out, global float* restrict distance,
                            global float* restrict weight) {
  const uint i = get_global_id(0);
  if (i >= n_items) return;
  const uint at = i * N_FLOATS, used = in_use[at / QUARTER_VOXELS], block = used / 4u;
  const uint3 in_block = (uint3)(at % 8u, at / 8u % 4u + 4u * (used % 2u), at / 32u % 4u + 4u * (used / 2u % 2u));
  const uint3 sample = block_at(&grid, place[block]) * BLOCK_SIDE + in_block;
  const float3 start = in_camera(camera, vload3(0, grid.origin) + convert_float3(sample) * grid.voxel);
  const float3 right = vload3(0, camera.to_world) * grid.voxel, ahead = vload3(0, camera.to_world + 4) * grid.voxel;
  const floats kx = AS_FLOATS(FLOAT_NUMBERS % 8), ky = AS_FLOATS(FLOAT_NUMBERS / 8);
  const floats z = start.z + kx * right.z + ky * ahead.z, inverse = 1.0f / z;
  const floats x = (start.x + kx * right.x + ky * ahead.x) * inverse;
  const floats y = (start.y + kx * right.y + ky * ahead.y) * inverse;
  floats u, v;
  ints is_seen;
  project_points(&camera, x, y, z, &u, &v, &is_seen);
  const floats across = u + 0.5f, down = v + 0.5f;
  is_seen &= (across >= 0.0f) & (down >= 0.0f) & (across < (float)camera.width) & (down < (float)camera.height);
  const ints column = AS_INTS(across), row = AS_INTS(down);  // of those that are seen
  if (!ANY_FLOAT(is_seen)) return;
  ints pixel = select((ints)(0), row * (int)camera.width + column, is_seen);
  floats normal_x, normal_y, normal_z, far;
#pragma unroll
  for (uint k = 0; k < N_FLOATS; ++k) {
    const float4 seen = surface[INT_LANE(pixel, k)];
    FLOAT_LANE(normal_x, k) = seen.x;
    FLOAT_LANE(normal_y, k) = seen.y;
    FLOAT_LANE(normal_z, k) = seen.z;
    FLOAT_LANE(far, k) = seen.w;
  }
  is_seen &= far > 0.0f;
  // the ray of the pixel's middle; of a distorted one to first order
  const floats ray_x = x - (u - AS_FLOATS(column)) * (1.0f / camera.fx);
  const floats ray_y = y - (v - AS_FLOATS(row)) * (1.0f / camera.fy);
  const floats slope = normal_x * ray_x + normal_y * ray_y + normal_z;
  const floats d = (normal_x * x + normal_y * y + normal_z) * z - far * slope;
  const floats sigma = depth_noises(&grid, far);
  const floats tau = max(grid.truncation, 3.0f * sigma);
  const floats clear = depth_noise(&grid, 1.0f) * slope;
  const floats seen_weight = clear * clear / (sigma * sigma * (ray_x * ray_x + ray_y * ray_y + 1.0f));
  is_seen &= d > -tau;
  if (!ANY_FLOAT(is_seen)) return;
  const uint samples = (block * BLOCK_VOXELS + (in_block.z * BLOCK_SIDE + in_block.y) * BLOCK_SIDE + in_block.x) / N_FLOATS;
  const floats old = LOAD_FLOATS(samples, distance), old_weight = LOAD_FLOATS(samples, weight);
  const floats own = seen_weight * select((floats)(1.0f), 1.0f + d / tau, d < 0.0f);
  const floats w = is_taken_out ? -own : own, sum = old_weight + w, none = 0.0f;
  const ints is_left = sum > LEAST_LEFT * own;
  STORE_FLOATS(select(old, old + (min(d, tau) - old) * (w / sum), is_seen & is_left), samples, distance);
  STORE_FLOATS(select(old_weight, select(none, sum, is_left), is_seen), samples, weight);
}
