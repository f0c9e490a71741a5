// Fusion and marching cubes against surfaces whose place is known by hand.
#include "host/capture/fusion.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <random>
#include <set>

#include "host/geometry/mesh_checks.hpp"
#include "host/render/camera.hpp"
#include "tests/capture/depth_camera.hpp"

namespace pvg {
namespace {

// depth along the axis of what `hit` says of a ray from the eye; 0: nothing is hit
template <typename Hit>
DepthPicture look(const Camera& camera, Hit hit) {
  DepthPicture picture{camera.width, camera.height, {}};
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const Vec3 ray((x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy, 1);  // z = 1: its length is the depth
      picture.depth.push_back(float(hit(camera.pose.translation(), camera.pose.linear() * ray)));
    }
  return picture;
}

FusedSurface fuse(const std::vector<std::pair<Camera, DepthPicture>>& pictures, double voxel, std::size_t n_lanes = 0) {
  Device device;
  FusionSettings settings;
  settings.n_lanes = n_lanes;
  settings.voxel = voxel;
  settings.least_weight = 0.01;
  Box box;
  for (const auto& [camera, picture] : pictures) box.add(seen_box(camera, picture, settings.max_depth));
  Fusion fusion(device, settings, box);
  for (const auto& [camera, picture] : pictures) fusion.mark(camera, picture);
  fusion.allocate();
  for (const auto& [camera, picture] : pictures) fusion.integrate(camera, picture);
  return fusion.surface();
}

double sphere_depth(const Vec3& eye, const Vec3& ray, double radius) {
  const double a = ray.squaredNorm(), b = ray.dot(eye), c = eye.squaredNorm() - radius * radius, d = b * b - a * c;
  return d > 0 ? (-b - std::sqrt(d)) / a : 0;
}

// A wall at z = 0.5137 seen straight on: along every ray the distance is linear in z, so that the zero is met exactly,
// wherever the samples are.
TEST(Fusion, APlaneSeenFromOnePoseIsWhereItWasSeen) {
  const Camera camera = camera_at({0, 0, 0}, {0, 0, 1});
  const FusedSurface surface = fuse({{camera, look(camera, [](const Vec3&, const Vec3&) { return 0.5137; })}}, 0.01);
  ASSERT_GT(surface.triangles.size(), 500u);
  for (const Vec3f& p : surface.points) ASSERT_NEAR(p.z(), 0.5137, 2e-6);
  for (const Triangle& t : surface.triangles) {
    const Vec3f n = (surface.points[t[1]] - surface.points[t[0]]).cross(surface.points[t[2]] - surface.points[t[0]]);
    ASSERT_LT(n.z(), 0) << "outward is toward the camera";
  }
}

// A wall that is tilted about both axes: a pixel is 3 mm wide, but distances are to the plane that it saw, so the place
// of a sample within its pixel does not matter.
TEST(Fusion, ATiltedPlaneIsWhereItWasSeen) {
  const Vec3 normal = Vec3(0.4, 0.5, -0.8).normalized();
  const double offset = normal.dot(Vec3(0, 0, 0.5));
  const Camera camera = camera_at({0, 0, 0}, {0, 0, 1});
  const auto depth = [&](const Vec3&, const Vec3& ray) { return offset / normal.dot(ray); };
  const FusedSurface surface = fuse({{camera, look(camera, depth)}}, 0.01);
  ASSERT_GT(surface.triangles.size(), 500u);
  for (const Vec3f& p : surface.points) ASSERT_NEAR(normal.dot(p.cast<double>()), offset, 1e-5);
}

// A work-item of one pixel or sample, as GPUs have them, makes the surface that one of sixteen makes, but for the order
// of rounding. By it a sample at the border of two pixels may take the other one's tangent plane, which over their
// width w is w^2 / 2R off in a ball of radius R that is looked at from inside. 157 x 119 pixels are no multiple of
// sixteen.
TEST(Fusion, OneLaneAndSixteenMakeTheSameSurface) {
  for (const double k1 : {0.0, -0.1}) {
    Camera camera = camera_at({0, 0, 0}, {0.2, 0.1, 1});
    camera.width = 157;
    camera.height = 119;
    if (k1 != 0) camera.distortion = {k1};
    const DepthPicture picture = look(camera, [](const Vec3& eye, const Vec3& ray) {
      const Vec3 from = eye - Vec3(0.3, 0, 0.1);
      const double a = ray.squaredNorm(), b = ray.dot(from), c = from.squaredNorm() - 1;
      return (-b + std::sqrt(b * b - a * c)) / a;
    });
    const FusedSurface one = fuse({{camera, picture}}, 0.01, 1), sixteen = fuse({{camera, picture}}, 0.01, 16);
    ASSERT_GT(one.points.size(), 5000u);
    ASSERT_EQ(one.points.size(), sixteen.points.size());
    EXPECT_EQ(one.triangles, sixteen.triangles);
    std::size_t n_others = 0;
    for (std::size_t i = 0; i < one.points.size(); ++i) {
      const double off = double((one.points[i] - sixteen.points[i]).norm()), pixel = 1.0 / 150;
      ASSERT_LT(off, pixel * pixel / 2) << "point " << i;
      n_others += off > 4e-6;  // some thirty roundings of a metre
    }
    EXPECT_LE(n_others, one.points.size() / 200) << "k1 " << k1;
  }
}

// A floor that is looked along, at 26 degrees in the middle of the picture: blocks are searched for along the axis, the
// band lies along the normal. Each pixel that is not at the border has surface within two voxels.
TEST(Fusion, ASteeplySlantedPlaneHasNoHoles) {
  constexpr double VOXEL = 0.005;
  const Vec3 normal = Vec3(0.1, -std::cos(0.45), -std::sin(0.45)).normalized();
  const double offset = normal.dot(Vec3(0, 0, 0.6));
  const Camera camera = camera_at({0, 0, 0}, {0, 0, 1});
  const DepthPicture picture = look(camera, [&](const Vec3&, const Vec3& ray) {
    const double z = offset / normal.dot(camera.pose.linear() * ray);
    return z > 0.3 && z < 1.2 ? z : 0;
  });
  const FusedSurface surface = fuse({{camera, picture}}, VOXEL);
  std::set<std::array<int, 3>> cells;  // of two voxels, that hold surface
  const auto cell = [&](const Vec3& p, int dx, int dy, int dz) {
    return std::array{int(std::floor(p.x() / (2 * VOXEL))) + dx, int(std::floor(p.y() / (2 * VOXEL))) + dy,
                      int(std::floor(p.z() / (2 * VOXEL))) + dz};
  };
  for (const Vec3f& p : surface.points) cells.insert(cell(p.cast<double>(), 0, 0, 0));
  int n = 0, n_holes = 0;
  for (int y = 8; y < camera.height - 8; ++y)
    for (int x = 8; x < camera.width - 8; ++x) {
      const auto depth = [&](int u, int v) { return picture.depth[std::size_t(v * camera.width + u)]; };
      if (depth(x, y - 8) == 0 || depth(x, y + 8) == 0) continue;
      const double z = depth(x, y);
      const Vec3 p = camera.pose * Vec3((x - camera.cx) / camera.fx * z, (y - camera.cy) / camera.fy * z, z);
      bool is_there = false;
      for (int k = 0; k < 27 && !is_there; ++k) is_there = cells.contains(cell(p, k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1));
      ++n;
      n_holes += !is_there;
    }
  ASSERT_GT(n, 2000);
  EXPECT_EQ(n_holes, 0);
}

// A plane up to 75 degrees off the line of sight, all blocks of the grid kept: a sample that is within the truncation
// distance of the plane, and whose pixel saw it, lies in a quarter of a block that is fused. Without tolerance but for
// the rounding of the device, 0.1 % of the truncation distance.
TEST(Fusion, EverySampleNearASteeplySlantedPlaneIsInABlockInView) {
  Device device;
  Program program(device, "capture/fusion.cl", "-DN_FLOATS=16");
  Kernel find_normals = program.kernel("find_normals"), find_bands = program.kernel("find_bands"),
         find_in_view = program.kernel("find_blocks_in_view");
  for (const double degrees : {0.0, 60.0, 75.0}) {
    const double angle = degrees * M_PI / 180, distance = 2;
    const Camera camera = camera_at({0.03, 0.02, 0.01}, {0.03, 0.42, 1.01});
    const Vec3 forward = camera.pose.linear().col(2), side = camera.pose.linear().col(0);
    const Vec3 middle = camera.pose.translation() + distance * forward;
    const Vec3 normal = Eigen::AngleAxisd(angle, side) * forward;
    const double offset = normal.dot(middle);
    const DepthPicture picture = look(camera, [&](const Vec3& eye, const Vec3& ray) {
      const double z = (offset - normal.dot(eye)) / normal.dot(ray);
      return z > 0.8 && z < 3.9 ? z : 0;
    });
    VoxelGrid grid{};
    grid.voxel = 0.01f;
    grid.truncation = 0.04f;
    grid.noise[0] = 0.0012f;
    grid.noise[1] = 0.0019f;
    grid.noise[2] = 0.4f;
    grid.max_depth = 4;
    const float corner[3] = {-1.3f, -0.5f, 0.4f};
    const u32 n_along[3] = {34, 36, 40};
    for (int axis = 0; axis < 3; ++axis) {
      grid.origin[axis] = corner[axis];
      grid.blocks[axis] = n_along[axis];
    }
    const std::size_t n = std::size_t(n_along[0]) * n_along[1] * n_along[2], n_pixels = picture.depth.size();
    std::vector<u32> all(n);
    for (std::size_t i = 0; i < n; ++i) all[i] = u32(i);
    const PinholeCamera seen_by = pinhole_camera(camera, camera.pose.matrix());
    const std::size_t n_tiles = std::size_t(camera.width / TILE_SIDE) * std::size_t(camera.height / TILE_SIDE);
    Buffer<float> depth(device, picture.depth, "depth");
    Buffer<std::array<float, 4>> surface(device, n_pixels, "surface");
    Buffer<std::array<float, 2>> bands(device, n_tiles, "bands");
    Buffer<u32> place(device, all, "place"), in_view(device, n, "in_view");
    find_normals(n_pixels / 16, u32(n_pixels / 16), grid, seen_by, depth, surface);
    find_bands(n_tiles, u32(n_tiles), grid, seen_by, surface, bands);
    find_in_view(n, u32(n), grid, seen_by, bands, place, in_view);
    const std::vector<std::array<float, 4>> seen = surface.read();
    const std::vector<u32> quarters = in_view.read();
    const Pose to_camera = camera.pose.inverse();
    std::size_t n_near = 0, n_missed = 0, n_in_view = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t block[3] = {i % n_along[0], i / n_along[0] % n_along[1], i / n_along[0] / n_along[1]};
      for (u32 k = 0; k < BLOCK_VOXELS; ++k) {
        const u32 in_block[3] = {k % BLOCK_SIDE, k / BLOCK_SIDE % BLOCK_SIDE, k / BLOCK_SIDE / BLOCK_SIDE};
        Vec3 sample;
        for (int axis = 0; axis < 3; ++axis)
          sample[axis] = double(corner[axis]) + 0.01 * double(block[axis] * BLOCK_SIDE + in_block[axis]);
        if (std::abs(normal.dot(sample) - offset) > 0.3) continue;  // more than any truncation distance here
        const Vec3 p = to_camera * sample;
        if (p.z() <= 0.1) continue;
        const int x = int(std::floor(camera.fx * p.x() / p.z() + camera.cx + 0.5)),
                  y = int(std::floor(camera.fy * p.y() / p.z() + camera.cy + 0.5));
        if (x < 0 || y < 0 || x >= camera.width || y >= camera.height) continue;
        const double z = double(seen[std::size_t(y * camera.width + x)][3]);
        if (!(z > 0)) continue;
        const double tau = std::max(0.04, 3 * (0.0012 + 0.0019 * (z - 0.4) * (z - 0.4)));
        if (std::abs(normal.dot(sample) - offset) > 0.999 * tau) continue;
        const u32 quarter = in_block[1] / 4 + 2 * (in_block[2] / 4);
        ++n_near;
        n_missed += (quarters[i] >> quarter & 1u) == 0;
      }
      n_in_view += quarters[i] != 0;
    }
    EXPECT_GT(n_near, 50000u) << degrees << " degrees";
    EXPECT_EQ(n_missed, 0u) << degrees << " degrees, of " << n_near;
    EXPECT_LT(n_in_view, n / 4) << degrees << " degrees: few blocks are near the plane";
  }
}

TEST(Fusion, ASphereHasItsRadiusWithinHalfAVoxelAndIsClosed) {
  constexpr double RADIUS = 0.1, VOXEL = 0.005;
  std::vector<std::pair<Camera, DepthPicture>> pictures;
  for (int k = 0; k < 27; ++k) {
    const Vec3 from(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
    if (k == 13) continue;  // the middle
    const Camera camera = camera_at(0.45 * from.normalized(), Vec3::Zero());
    pictures.emplace_back(
        camera, look(camera, [](const Vec3& eye, const Vec3& ray) { return sphere_depth(eye, ray, RADIUS); }));
  }
  const FusedSurface surface = fuse(pictures, VOXEL);
  double mean = 0;
  for (const Vec3f& p : surface.points) {
    ASSERT_NEAR(double(p.norm()), RADIUS, VOXEL / 2);
    mean += double(p.norm()) / double(surface.points.size());
  }
  EXPECT_NEAR(mean, RADIUS, 0.1 * VOXEL);
  TriangleMesh mesh{{}, surface.triangles};
  for (const Vec3f& p : surface.points) mesh.points.push_back(p.cast<double>());
  EXPECT_EQ(closed_surface_defect(mesh), std::nullopt);
  EXPECT_NEAR(enclosed_volume(mesh), 4.0 / 3 * M_PI * std::pow(RADIUS, 3), 0.01 * 4.2e-3);
}

// A picture that is taken out again leaves what the other one made, but for rounding; where it alone was, nothing.
TEST(Fusion, APictureThatIsTakenOutLeavesTheOthers) {
  const Camera here = camera_at({0, 0, 0}, {0, 0, 1}), there = camera_at({0.3, 0.1, 0}, {0.2, 0, 1});
  const auto wall = [](double z) { return [z](const Vec3& eye, const Vec3& ray) { return (z - eye.z()) / ray.z(); }; };
  const DepthPicture first = look(here, wall(0.8)), second = look(there, wall(0.81));
  const FusedSurface alone = fuse({{here, first}}, 0.01);
  Device device;
  FusionSettings settings;
  settings.voxel = 0.01;
  settings.least_weight = 0.01;
  Fusion fusion(device, settings, seen_box(here, first, settings.max_depth));
  fusion.mark(here, first);
  fusion.allocate();
  fusion.integrate(here, first);
  fusion.integrate(there, second);
  const FusedSurface both = fusion.surface();
  fusion.take_out(there, second);
  const FusedSurface left = fusion.surface();
  ASSERT_EQ(left.triangles, alone.triangles);
  double largest = 0;
  for (std::size_t i = 0; i < left.points.size(); ++i) {
    ASSERT_LT((left.points[i] - alone.points[i]).norm(), 1e-5f);
    largest = std::max(largest, std::abs(double(both.points[std::min(i, both.points.size() - 1)].z()) - 0.8));
  }
  EXPECT_GT(largest, 3e-3) << "the second picture had moved the wall";
}

// Whatever the signs of the samples are, neighbouring cells fit: an edge has one triangle on each side, and no other.
TEST(MarchingCubes, CellsOfRandomSignsCloseAgainstEachOther) {
  const std::vector<std::uint8_t> cases = marching_cubes_cases();
  ASSERT_EQ(cases.size(), 256u * 16u);
  std::mt19937 random(7);
  constexpr int N = 9;
  for (int trial = 0; trial < 20; ++trial) {
    std::vector<bool> inside(N * N * N);  // the border is outside
    const auto at = [](int x, int y, int z) { return std::size_t((z * N + y) * N + x); };
    for (int z = 1; z + 1 < N; ++z)
      for (int y = 1; y + 1 < N; ++y)
        for (int x = 1; x + 1 < N; ++x) inside[at(x, y, z)] = random() % 2 == 0;
    std::map<std::pair<long, long>, int> balance, uses;  // of edges between vertices, named by sample and axis
    for (int z = 0; z + 1 < N; ++z)
      for (int y = 0; y + 1 < N; ++y)
        for (int x = 0; x + 1 < N; ++x) {
          unsigned which = 0;
          for (int k = 0; k < 8; ++k)
            if (inside[at(x + (k & 1), y + (k >> 1 & 1), z + (k >> 2))]) which |= 1u << k;
          const auto vertex = [&](int edge) {
            const int axis = edge / 4, low = edge & 1, high = edge >> 1 & 1;
            const int dx = axis == 0 ? 0 : low, dy = axis == 0 ? low : axis == 1 ? 0 : high, dz = axis == 2 ? 0 : high;
            return long(at(x + dx, y + dy, z + dz)) * 3 + axis;
          };
          for (int k = 0; k + 2 < 16 && cases[which * 16 + unsigned(k)] != 255; k += 3)
            for (int s = 0; s < 3; ++s) {
              const long a = vertex(cases[which * 16 + unsigned(k + s)]),
                         b = vertex(cases[which * 16 + unsigned(k + (s + 1) % 3)]);
              a < b ? ++balance[{a, b}] : --balance[{b, a}];
              ++uses[std::minmax(a, b)];
            }
        }
    ASSERT_FALSE(balance.empty());
    for (const auto& [edge, sum] : balance) ASSERT_EQ(sum, 0);
    for (const auto& [edge, n] : uses) ASSERT_EQ(n, 2);
  }
}

}  // namespace
}  // namespace pvg
