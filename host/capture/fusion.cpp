#include "host/capture/fusion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "host/base/error.hpp"
#include "host/render/camera.hpp"

namespace pvg {
namespace {

constexpr std::size_t MOST_GRID_BLOCKS = std::size_t(1) << 28;  // kept or not; four bytes each
constexpr std::size_t REGISTRATION_WIDTH = 320;                 // pixels of a row that are registered, about
constexpr std::size_t BYTES_PER_BLOCK = BLOCK_VOXELS * 3 * 4;   // distance, weight, first vertex

std::size_t tiles(int pixels) { return (std::size_t(pixels) + TILE_SIDE - 1) / TILE_SIDE; }

VoxelGrid make_grid(const FusionSettings& s, const Box& box) {
  if (!(s.voxel > 0)) throw UsageError("the voxel size must be positive");
  VoxelGrid grid{};
  grid.voxel = float(s.voxel);
  grid.truncation = float(s.truncation > 0 ? s.truncation : 4 * s.voxel);
  grid.max_depth = float(s.max_depth);
  grid.noise[0] = float(s.noise.base);
  grid.noise[1] = float(s.noise.growth);
  grid.noise[2] = float(s.noise.nearest);
  const float side = grid.voxel * float(BLOCK_SIDE);
  const float noise_at_end = float(s.noise.base + s.noise.growth * std::pow(s.max_depth - s.noise.nearest, 2));
  const float margin = std::max(grid.truncation, 3 * noise_at_end) + side;
  double n_blocks = 1;
  for (int axis = 0; axis < 3; ++axis) {
    grid.origin[axis] = box.lo[axis] - margin;
    const double n = std::ceil((double(box.hi[axis]) - double(box.lo[axis]) + 2 * double(margin)) / double(side));
    if (!(n >= 1 && n < 1e9)) throw UsageError("no depth was found that is finite and within the largest depth");
    grid.blocks[axis] = u32(n);
    n_blocks *= n;
  }
  if (n_blocks > double(MOST_GRID_BLOCKS)) {
    const double fitting = s.voxel * std::cbrt(n_blocks / double(MOST_GRID_BLOCKS)) * 1.05;
    throw UsageError("the capture is too large for voxels of " + std::to_string(s.voxel * 1e3) + " mm; take --voxel " +
                     std::to_string(fitting * 1e3) + " mm or a smaller --max-depth");
  }
  return grid;
}

}  // namespace

struct Fusion::Impl {
  Device& device;
  FusionSettings settings;
  VoxelGrid grid;
  std::size_t n_grid;
  std::size_t n_lanes;
  Program fusion_program, surface_program, registration_program;
  Kernel find_normals, mark, find_bands, find_in_view, integrate, registration, count, place_vertices, place_triangles;
  Buffer<float> depth, distance, weight, sums;
  Buffer<std::array<float, 4>> surface;
  Buffer<std::array<float, 2>> bands;
  Buffer<u32> is_near, place, in_view, in_use, block_of;
  std::size_t n_blocks = 0;

  Impl(Device& device_, const FusionSettings& settings_, const Box& box)
      : device(device_),
        settings(settings_),
        grid(make_grid(settings_, box)),
        n_grid(std::size_t(grid.blocks[0]) * grid.blocks[1] * grid.blocks[2]),
        n_lanes(settings_.n_lanes > 0  ? settings_.n_lanes
                : device.info().is_gpu ? 1
                                       : 16),
        fusion_program(device, "capture/fusion.cl", "-DN_FLOATS=" + std::to_string(n_lanes)),
        surface_program(device, "capture/marching_cubes.cl"),
        registration_program(device, "capture/registration.cl"),
        find_normals(fusion_program.kernel("find_normals")),
        mark(fusion_program.kernel("mark_blocks")),
        find_bands(fusion_program.kernel("find_bands")),
        find_in_view(fusion_program.kernel("find_blocks_in_view")),
        integrate(fusion_program.kernel("integrate_depth")),
        registration(registration_program.kernel("register_depth")),
        count(surface_program.kernel("count_surface")),
        place_vertices(surface_program.kernel("place_vertices")),
        place_triangles(surface_program.kernel("place_triangles")),
        depth(device, 0, "depth"),
        distance(device, 0, "distance"),
        weight(device, 0, "weight"),
        sums(device, 0, "sums"),
        surface(device, 0, "surface"),
        bands(device, 0, "bands"),
        is_near(device, n_grid, "is_near"),
        place(device, 0, "place"),
        in_view(device, 0, "in_view"),
        in_use(device, 0, "in_use"),
        block_of(device, 0, "block_of") {
    is_near.zero();
  }

  std::size_t n_items() const { return (depth.size() + n_lanes - 1) / n_lanes; }

  PinholeCamera load(const Camera& camera, const DepthPicture& picture) {
    const PinholeCamera c = pinhole_camera(camera, camera.pose.matrix());
    depth.resize(picture.depth.size());
    surface.resize(picture.depth.size());
    depth.write(picture.depth);
    find_normals(n_items(), u32(n_items()), grid, c, depth, surface);
    return c;
  }

  void change(const Camera& camera, const DepthPicture& picture, bool is_taken_out) {
    const PinholeCamera c = load(camera, picture);
    const std::size_t n_tiles = tiles(picture.width) * tiles(picture.height);
    bands.resize(n_tiles);
    find_bands(n_tiles, u32(n_tiles), grid, c, surface, bands);
    find_in_view(n_blocks, u32(n_blocks), grid, c, bands, place, in_view);
    const std::vector<u32> quarters = in_view.read();
    std::vector<u32> seen;
    for (std::size_t i = 0; i < quarters.size(); ++i)
      for (u32 quarter = 0; quarter < 4; ++quarter)
        if (quarters[i] >> quarter & 1u) seen.push_back(u32(4 * i) + quarter);
    in_use.resize(seen.size());
    in_use.write(seen);
    const std::size_t n = seen.size() * BLOCK_VOXELS / 4 / n_lanes;
    integrate(n, u32(n), grid, c, surface, place, in_use, u32(is_taken_out), distance, weight);
    device.finish();
  }
};

Fusion::Fusion(Device& device, const FusionSettings& settings, const Box& box)
    : impl_(std::make_unique<Impl>(device, settings, box)) {}
Fusion::~Fusion() = default;

std::size_t Fusion::n_blocks() const { return impl_->n_blocks; }
std::size_t Fusion::voxel_bytes() const { return impl_->n_blocks * BYTES_PER_BLOCK; }

void Fusion::mark(const Camera& camera, const DepthPicture& picture) {
  Impl& f = *impl_;
  const PinholeCamera c = f.load(camera, picture);
  f.mark(f.n_items(), u32(f.n_items()), f.grid, c, f.surface, f.is_near);
  f.device.finish();
}

void Fusion::allocate() {
  Impl& f = *impl_;
  const std::vector<u32> is_near = f.is_near.read();
  std::vector<u32> place, block_of(f.n_grid, NO_BLOCK);
  for (std::size_t i = 0; i < is_near.size(); ++i) {
    if (!is_near[i]) continue;
    block_of[i] = u32(place.size());
    place.push_back(u32(i));
  }
  if (place.empty()) throw UsageError("no picture shows a surface within the largest depth; see --max-depth");
  const std::size_t bytes = place.size() * BYTES_PER_BLOCK;
  if (bytes > f.settings.max_bytes || place.size() * BLOCK_VOXELS >= (std::size_t(1) << 32)) {
    const double fitting = f.settings.voxel * std::sqrt(double(bytes) / double(f.settings.max_bytes)) * 1.1;
    throw UsageError("voxels of " + std::to_string(f.settings.voxel * 1e3) + " mm take " + std::to_string(bytes >> 20) +
                     " MiB, more than the " + std::to_string(f.settings.max_bytes >> 20) +
                     " MiB of --memory; take --voxel " + std::to_string(fitting * 1e3) + " mm");
  }
  f.is_near = Buffer<u32>(f.device, 0, "is_near");
  f.n_blocks = place.size();
  f.place = Buffer<u32>(f.device, place, "place");
  f.block_of = Buffer<u32>(f.device, block_of, "block_of");
  f.in_view = Buffer<u32>(f.device, f.n_blocks, "in_view");
  f.in_use = Buffer<u32>(f.device, f.n_blocks, "in_use");
  f.distance = Buffer<float>(f.device, f.n_blocks * BLOCK_VOXELS, "distance");
  f.weight = Buffer<float>(f.device, f.n_blocks * BLOCK_VOXELS, "weight");
  f.distance.zero();
  f.weight.zero();
}

void Fusion::integrate(const Camera& camera, const DepthPicture& picture) { impl_->change(camera, picture, false); }
void Fusion::take_out(const Camera& camera, const DepthPicture& picture) { impl_->change(camera, picture, true); }

RegistrationSums Fusion::registration(const Camera& camera, const DepthPicture& picture) {
  Impl& f = *impl_;
  const PinholeCamera c = f.load(camera, picture);
  // a picture of any size gives about as many pixels
  const std::size_t stride = std::max<std::size_t>(1, std::size_t(camera.width) / REGISTRATION_WIDTH);
  const std::size_t per_row =
      (std::size_t(camera.width) + stride * REGISTRATION_PIXELS - 1) / (stride * REGISTRATION_PIXELS);
  const std::size_t n = per_row * ((std::size_t(camera.height) + stride - 1) / stride);
  f.sums.resize((n + GROUP_SIZE - 1) / GROUP_SIZE * REGISTRATION_SUMS);
  f.registration(n, u32(n), f.grid, c, u32(stride), float(f.settings.least_weight), f.surface, f.block_of, f.distance,
                 f.weight, f.sums);
  const std::vector<float> groups = f.sums.read();
  std::array<double, REGISTRATION_SUMS> sum{};
  for (std::size_t i = 0; i < groups.size(); ++i) sum[i % REGISTRATION_SUMS] += double(groups[i]);
  for (double& s : sum) s *= double(stride * stride);
  RegistrationSums out;
  std::size_t k = 0;
  for (int row = 0; row < 6; ++row)
    for (int column = row; column < 6; ++column) out.hessian(row, column) = out.hessian(column, row) = sum[k++];
  for (int row = 0; row < 6; ++row) out.gradient(row) = sum[k++];
  out.squares = sum[k++];
  out.weight = sum[k++];
  out.n_pixels = sum[k];
  return out;
}

FusedSurface Fusion::surface() {
  Impl& f = *impl_;
  const u32 n = u32(f.n_blocks);
  const float least = float(f.settings.least_weight);
  Buffer<std::uint8_t> cases(f.device, marching_cubes_cases(), "cases");
  Buffer<u32> n_vertices(f.device, n, "n_vertices"), n_triangles(f.device, n, "n_triangles");
  f.count(n, n, f.grid, least, f.block_of, f.place, f.distance, f.weight, cases, n_vertices, n_triangles);
  const auto starts = [](const std::vector<u32>& counts, std::size_t& sum) {
    std::vector<u32> first(counts.size());
    sum = 0;
    for (std::size_t i = 0; i < counts.size(); ++i) {
      first[i] = u32(sum);
      sum += counts[i];
    }
    if (sum >= (std::size_t(1) << 29)) throw UsageError("the surface has too many vertices; take larger voxels");
    return first;
  };
  std::size_t vertices = 0, triangles = 0;
  Buffer<u32> first_vertex(f.device, starts(n_vertices.read(), vertices), "first_vertex");
  Buffer<u32> first_triangle(f.device, starts(n_triangles.read(), triangles), "first_triangle");
  Buffer<u32> vertex_of(f.device, f.n_blocks * BLOCK_VOXELS, "vertex_of"),
      corners(f.device, 3 * triangles, "triangles");
  Buffer<float> points(f.device, 3 * vertices, "points"), sureness(f.device, vertices, "sureness");
  f.place_vertices(n, n, f.grid, least, f.block_of, f.place, f.distance, f.weight, first_vertex, vertex_of, points,
                   sureness);
  f.place_triangles(n, n, f.grid, least, f.block_of, f.place, f.distance, f.weight, cases, vertex_of, first_triangle,
                    corners);
  FusedSurface out;
  const std::vector<float> p = points.read();
  for (std::size_t i = 0; i < vertices; ++i) out.points.emplace_back(p[3 * i], p[3 * i + 1], p[3 * i + 2]);
  out.sureness = sureness.read();
  const std::vector<u32> c = corners.read();
  for (std::size_t i = 0; i < triangles; ++i) out.triangles.push_back({c[3 * i], c[3 * i + 1], c[3 * i + 2]});
  return out;
}

Box seen_box(const Camera& camera, const DepthPicture& picture, double max_depth) {
  Box box;
  constexpr int STRIDE = 4;  // the truncation band and a block are added around the box
  for (int y = 0; y < picture.height; y += STRIDE)
    for (int x = 0; x < picture.width; x += STRIDE) {
      const double z = picture.depth[std::size_t(y) * std::size_t(picture.width) + std::size_t(x)];
      if (!(z > 0 && z < max_depth)) continue;
      box.add((camera.pose * Vec3((x - camera.cx) / camera.fx * z, (y - camera.cy) / camera.fy * z, z)).cast<float>());
    }
  return box;
}

}  // namespace pvg
