// Rays in packets find what each finds alone: the same bits of t, u, v, triangle and instance. And rays that go the
// same way do go in packets.
#include <gtest/gtest.h>

#include <cstring>

#include "tests/render/ray_world.hpp"

namespace pvg {
namespace {

using test::flat_mesh;
using test::pose;
using test::Rays;
using test::soup;
using test::World;
using Packets = test::ManyPaths;

struct Found {
  std::vector<F32x4> hit;
  std::vector<std::uint32_t> instance;
};

struct Counts {
  int hits = 0, ties = 0, wrong = 0;
};

// Of two triangles at the same t either may be found: a tie.
Counts compare(const Found& alone, const Found& together) {
  Counts counts;
  for (std::size_t i = 0; i < alone.hit.size(); ++i) {
    const F32x4 &a = alone.hit[i], &b = together.hit[i];
    const bool has_hit = std::isfinite(a.v[0]);
    counts.hits += has_hit;
    if (std::memcmp(&a, &b, sizeof a) == 0 && (!has_hit || alone.instance[i] == together.instance[i])) continue;
    ++(a.v[0] == b.v[0] && has_hit ? counts.ties : counts.wrong);
  }
  return counts;
}

// The product's function in a kernel of this test. With MARKS a ray that goes alone leaves a mark instead of what it
// hits: t = ALONE_IN_MESH where it does so in the frame of a mesh, ALONE in the whole scene.
constexpr float ALONE_IN_MESH = -1, ALONE = -2;
const char* const KERNEL = R"(
#include "render/traverse.cl"
#ifdef MARKS
static inline void mark_alone(Hit* hit) { hit->t = -2.0f; }
#define closest_hit(trees, origin, direction, hit) mark_alone(hit)
#define closest_in_mesh(trees, box, leaf, first, t) (float4)(-1.0f, 0.0f, 0.0f, 0.0f)
#endif
#include "render/lanes/closest.cl"
kernel void trace_neighbours(const uint n, global const float8* top, global const float8* nodes,
                             global const float4* blocks, global const Instance* instances, global const float4* origin,
                             global const float4* direction, global float4* hit, global uint* hit_instance) {
  const Trees trees = {top, nodes, blocks, instances};
  if (get_global_id(0) == 0) find_closest_of_neighbours(trees, n, origin, direction, hit, hit_instance);
}
)";

Found trace_neighbours(Device& device, const std::string& options, const DeviceTrees& trees, std::size_t n,
                       const Buffer<F32x4>& origin, const Buffer<F32x4>& direction) {
  Kernel kernel =
      Program::from_text(device, "neighbours", KERNEL, traversal_options(device) + options).kernel("trace_neighbours");
  Buffer<F32x4> hit(device, n, "hit");
  Buffer<std::uint32_t> hit_instance(device, n, "hit_instance");
  hit.zero();
  hit_instance.zero();
  kernel(1, std::uint32_t(n), trees.top, trees.nodes, trees.blocks, trees.instances, origin, direction, hit,
         hit_instance);
  return {hit.read(), hit_instance.read()};
}

Counts trace(const World& world, const Rays& rays) {
  Device device;
  const DeviceTrees trees = device_trees(device, world);
  const std::size_t n = rays.origin.size();
  std::vector<std::uint32_t> slots(n);
  for (std::size_t i = 0; i < n; ++i) slots[i] = std::uint32_t(i);
  const Buffer<std::uint32_t> queue(device, slots, "queue");
  const Buffer<F32x4> origin(device, rays.origin, "origin"), direction(device, rays.direction, "direction");
  Buffer<F32x4> hit(device, n, "hit");
  Buffer<std::uint32_t> hit_instance(device, n, "hit_instance");
  test::find_closest_alone(device, n, queue, trees, origin, direction, hit, hit_instance);
  const Found alone{hit.read(), hit_instance.read()};
  return compare(alone, trace_neighbours(device, "", trees, n, origin, direction));
}

struct Alone {
  int in_scene = 0, in_a_mesh = 0;
};

Alone count_alone(const World& world, const Rays& rays) {
  Device device;
  const DeviceTrees trees = device_trees(device, world);
  const Buffer<F32x4> origin(device, rays.origin, "origin"), direction(device, rays.direction, "direction");
  Alone alone;
  for (const F32x4& one : trace_neighbours(device, " -DMARKS", trees, rays.origin.size(), origin, direction).hit) {
    alone.in_scene += one.v[0] == ALONE;
    alone.in_a_mesh += one.v[0] == ALONE_IN_MESH;
  }
  return alone;
}

// Sixteen neighbours at a time go from about one point toward about another one. spread: of both ends [m]
Rays bundles(unsigned n, float spread, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> u(-1, 1);
  Rays rays;
  Vec3f from = Vec3f::Zero(), to = from;
  for (unsigned i = 0; i < n; ++i) {
    if (i % 16 == 0) {
      from = 4 * Vec3f(u(random), u(random), u(random)).normalized();
      to = Vec3f(u(random), u(random), u(random));
    }
    const Vec3f o = from + spread * Vec3f(u(random), u(random), u(random));
    const Vec3f d = to + spread * Vec3f(u(random), u(random), u(random)) - o;
    rays.origin.push_back({{o.x(), o.y(), o.z(), 0}});
    rays.direction.push_back({{d.x(), d.y(), d.z(), 0}});
  }
  return rays;
}

World moved_instances() {
  World world;
  for (int i = 0; i < 30; ++i) {
    Eigen::Matrix<double, 3, 4> p = pose(0.3 * i, 0.6 * Vec3(std::cos(i), std::sin(2 * i), 0.1 * i - 1.5));
    p.leftCols<3>() *= 0.2 + 0.02 * i;
    if (i % 3 == 0) p.col(1) *= -0.5;  // mirrored and stretched
    world.add(i % 2 ? soup(50, unsigned(i), 0.3f) : test::sphere(1, 6), p);
  }
  world.add(soup(500, 77, 0.1f), pose(0, Vec3::Zero()));
  return world;
}

TEST_F(Packets, FindWhatEachRayFindsInASoup) {
  for (const unsigned n : {1u, 3u, 257u, 4000u}) {
    World world;
    world.add(soup(n == 1 ? 1 : 2000, 100 + n, 0.1f), pose(0, Vec3::Zero()));
    const Counts counts = trace(world, bundles(n, 0.01f, n));
    EXPECT_EQ(counts.wrong + counts.ties, 0) << n << " rays";
    EXPECT_TRUE(n < 4000 || counts.hits > 2000) << counts.hits;
  }
}

TEST_F(Packets, FindWhatEachRayFindsInMovedInstances) {
  const World world = moved_instances();
  for (const float spread : {0.0f, 1e-4f, 0.01f, 0.1f}) {
    const Counts counts = trace(world, bundles(8000, spread, 5));
    EXPECT_EQ(counts.wrong, 0) << "spread " << spread;
    EXPECT_EQ(counts.ties, 0) << "spread " << spread;
    EXPECT_GT(counts.hits, 3000);
  }
}

// directions of both signs, along axes, or with zeros: some axis of the packet is not met one way
TEST_F(Packets, RaysThatGoDifferentWaysGoAlone) {
  const World world = moved_instances();
  Rays rays = bundles(4000, 1.0f, 9);
  for (unsigned i = 0; i < 4000; i += 8) rays.direction[i] = {{i % 32 ? 0.0f : 1.0f, i % 32 ? -1.0f : 0.0f, 0, 0}};
  for (unsigned i = 0; i < 1600; ++i) {  // along an axis, and nearly so
    rays.origin[i] = {{-4, 0.001f * float(i), 0.1f, 0}};
    rays.direction[i] = {{1, i % 2 ? 0.0f : 1e-3f, i % 32 < 16 ? 0.0f : -1e-3f, 0}};
  }
  const Counts counts = trace(world, rays);
  EXPECT_EQ(counts.wrong + counts.ties, 0);
  EXPECT_GT(counts.hits, 1000);
}

// A turned box, beside a side of which the rays start: in its frame they go to both sides, in the world they do not.
TEST_F(Packets, RaysThatGoDifferentWaysInAMeshGoAloneThere) {
  Pose turned = Pose::Identity();
  turned.linear() = Eigen::AngleAxisd(M_PI / 4, Vec3::UnitZ()).toRotationMatrix();
  World world;
  world.add(test::box(Vec3f::Zero(), Vec3f::Ones()), turned.matrix().topRows<3>());
  Rays rays;
  for (int k = 0; k < 16; ++k) {
    const Vec3f o = (turned.linear() * Vec3(-2, -1e-5, 0.5)).cast<float>();
    const Vec3f d = (turned.linear() * Vec3(1, (k % 2 ? 1 : -1) * (0.001 + 0.001 * k), 0.01)).cast<float>();
    rays.origin.push_back({{o.x(), o.y(), o.z(), 0}});
    rays.direction.push_back({{d.x(), d.y(), d.z(), 0}});
  }
  const Counts counts = trace(world, rays);
  EXPECT_EQ(counts.wrong + counts.ties, 0);
  EXPECT_EQ(counts.hits, 8);
}

// a packet is rays of which none goes alone
TEST_F(Packets, RaysThatGoTheSameWayGoTogether) {
  World mesh;
  mesh.add(soup(2000, 5, 0.1f), pose(0, Vec3::Zero()));
  for (const float spread : {0.0f, 1e-4f}) {
    const Alone alone = count_alone(mesh, bundles(8000, spread, 5));
    EXPECT_LT(alone.in_scene + alone.in_a_mesh, 80) << "spread " << spread;
  }
  // beside each other, as rays of a camera
  Rays beside;
  for (int i = 0; i < 1600; ++i) {
    beside.origin.push_back({{-4, 0.3f, 0.2f, 0}});
    beside.direction.push_back({{1, 0.02f + 1e-4f * float(i % 16), 0.01f + 1e-4f * float(i / 16), 0}});
  }
  const Alone of_camera = count_alone(mesh, beside);
  EXPECT_EQ(of_camera.in_scene, 0);
  EXPECT_EQ(of_camera.in_a_mesh, 0);
  // and the marks tell
  const Alone spread_out = count_alone(mesh, bundles(8000, 1.0f, 9));
  EXPECT_GT(spread_out.in_scene, 7000);
  const Alone in_meshes = count_alone(moved_instances(), bundles(8000, 0.01f, 5));
  EXPECT_GT(in_meshes.in_a_mesh, 0);
  EXPECT_LT(in_meshes.in_scene + in_meshes.in_a_mesh, 4000);
}

// boxes without height, triangles without area, and rays that miss
TEST_F(Packets, FindWhatEachRayFindsInAFlatMesh) {
  World world;
  world.add(flat_mesh(), pose(0, Vec3::Zero()));
  const Counts counts = trace(world, bundles(8000, 0.02f, 3));
  EXPECT_EQ(counts.wrong + counts.ties, 0);
  EXPECT_GT(counts.hits, 1000);
  EXPECT_LT(counts.hits, 6000);
}

// rays through the very edges and corners of a closed surface: which of the neighbours they hit may differ, t hardly
TEST_F(Packets, NoRaySlipsThroughAnEdge) {
  const VisualMesh mesh = test::sphere(1, 24);
  Rays rays;
  for (const Triangle& t : mesh.triangles)
    for (int k = 0; k < 16; ++k) {
      const float part = float(k % 5) / 4;
      const Vec3f origin(0.01f, 0, 0.25f);
      const Vec3f to = (1 - part) * mesh.points[t[k % 3]] + part * mesh.points[t[(k + 1) % 3]] - origin;
      rays.origin.push_back({{origin.x(), origin.y(), origin.z(), 0}});
      rays.direction.push_back({{to.x(), to.y(), to.z(), 0}});
    }
  World world;
  world.add(mesh, pose(0, Vec3::Zero()));
  const Counts counts = trace(world, rays);
  EXPECT_EQ(counts.hits, int(rays.origin.size()));
  EXPECT_EQ(counts.wrong, 0);
}

}  // namespace
}  // namespace pvg
