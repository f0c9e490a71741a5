// The tree finds what a loop over all triangles finds: soups, flat and degenerate meshes, instances, deformed meshes.
#include "host/geometry/bvh.hpp"

#include <gtest/gtest.h>

#include <random>

#include "host/render/refit.hpp"
#include "host/render/stages.hpp"
#include "tests/render/ray_world.hpp"

namespace pvg {
namespace {

using ManyRays = test::ManyPaths;
using test::flat_mesh;
using test::pose;
using test::Rays;
using test::soup;
using test::World;

// the truth: every block of every instance
const char* const brute_force = R"(
#include "render/transmittance.cl"
kernel void find(const uint n, const uint n_instances, global const uint* n_blocks, global const uint* first_block,
                 global const float8* top, global const float8* nodes, global const float4* blocks,
                 global const Instance* instances, global const Material* materials, global const float4* origin,
                 global const float4* direction, global float4* by_tree, global float4* by_loop, global uint* any, global float* through) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  const Trees trees = {top, nodes, blocks, instances};
  const float3 o = origin[i].xyz, d = direction[i].xyz;
  Hit a = {INFINITY, 0, 0, NO_TRIANGLE, 0}, b = a;
  closest_hit(trees, o, d, &a);
  for (uint k = 0; k < n_instances; ++k) {
    const LeafRay r = make_leaf_ray(affine_point(instances[k].to_object, o), affine_vector(instances[k].to_object, d));
    for (uint j = 0; j < n_blocks[k]; ++j) closest_in_block(blocks + (first_block[k] + j) * 10, r, k, &b);
  }
  by_tree[i] = (float4)(a.t, a.u, a.v, as_float(a.triangle + (a.instance << 24)));
  by_loop[i] = (float4)(b.t, b.u, b.v, as_float(b.triangle + (b.instance << 24)));
  any[i] = any_hit(trees, o, d, 1.0f, 1);
  through[i] = transmittance(trees, materials, o, d, 1.0f, 1).value.x;
})";

Rays random_rays(unsigned n, float spread) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> u(-1, 1);
  Rays rays;
  for (unsigned i = 0; i < n; ++i) {
    rays.origin.push_back({{spread * u(random), spread * u(random), spread * u(random), 0}});
    F32x4 d{{u(random), u(random), u(random), 0}};
    if (i % 8 == 0) d.v[i / 8 % 3] = 0;                                          // in a plane
    if (i % 16 == 0) d = {{i % 32 ? 0.0f : 1.0f, i % 32 ? -1.0f : 0.0f, 0, 0}};  // along an axis
    rays.direction.push_back(d);
  }
  return rays;
}

// bits of t and triangle of every ray, tree against loop; the number of rays that hit
int expect_equal(Device& device, World& world, const Buffer<BvhNode>& nodes, const Buffer<TriangleBlock>& blocks,
                 const Rays& rays, const std::string& options, float tolerance = 0) {
  std::vector<std::uint32_t> n_blocks, first_block;
  for (const MeshRange& range : world.ranges) {
    n_blocks.push_back(range.n_blocks);
    first_block.push_back(range.first_block);
  }
  const std::size_t n = rays.origin.size();
  Kernel find = Program::from_text(device, "find", brute_force, options).kernel("find");
  Buffer<F32x4> by_tree(device, n, "by_tree"), by_loop(device, n, "by_loop");
  Buffer<std::uint32_t> any(device, n, "any");
  Buffer<float> through(device, n, "through");
  find(n, std::uint32_t(n), std::uint32_t(world.instances.size()), Buffer<std::uint32_t>(device, n_blocks, "n_blocks"),
       Buffer<std::uint32_t>(device, first_block, "first_block"),
       Buffer<BvhNode>(device, build_instance_tree(world.boxes), "top"), nodes, blocks,
       Buffer<Instance>(device, world.instances, "instances"), Buffer<Material>(device, 1, "materials"),
       Buffer<F32x4>(device, rays.origin, "origin"), Buffer<F32x4>(device, rays.direction, "direction"), by_tree,
       by_loop, any, through);
  const std::vector<F32x4> a = by_tree.read(), b = by_loop.read();
  const std::vector<std::uint32_t> is_shadowed = any.read();
  const std::vector<float> arrives = through.read();
  int n_hits = 0, n_wrong = 0;
  for (std::size_t i = 0; i < n; ++i) {
    n_hits += std::isfinite(b[i].v[0]);
    // two triangles at the same t may come in either order: t decides, to the bit but where a ray meets an edge
    const float t = b[i].v[0];
    n_wrong += !(a[i].v[0] == t || std::abs(a[i].v[0] - t) <= tolerance * t);
    if (std::abs(t - 1) <= tolerance) continue;
    n_wrong += (is_shadowed[i] != 0) != (t < 1.0f) || (arrives[i] == 0) != (t < 1.0f);
  }
  EXPECT_EQ(n_wrong, 0) << "of " << n << " rays, options " << options;
  return n_hits;
}

int expect_equal(World& world, const Rays& rays, bool both_masks = true, float tolerance = 0) {
  Device device;
  const Buffer<BvhNode> nodes(device, world.geometry.nodes, "nodes");
  const Buffer<TriangleBlock> blocks(device, world.geometry.blocks, "blocks");
  if (both_masks) expect_equal(device, world, nodes, blocks, rays, traversal_options(device), tolerance);
  return expect_equal(device, world, nodes, blocks, rays, "", tolerance);
}

TEST(Bvh, EveryTriangleStandsInOneLeafInsideItsBox) {
  std::vector<std::pair<unsigned, TreeQuality>> sizes_and_qualities;
  for (const unsigned n : {0u, 1u, 3u, 4u, 5u, 257u, 1000u})
    for (const TreeQuality quality : {TreeQuality::fast, TreeQuality::thorough})
      sizes_and_qualities.push_back({n, quality});
  for (const auto& [n, quality] : sizes_and_qualities) {
    const VisualMesh mesh = soup(n, n, 0.1f);
    const std::vector<Box> boxes = triangle_boxes(mesh.points, mesh.triangles);
    const Bvh bvh = build_bvh(boxes, 4, quality);
    std::vector<int> seen(n, 0);
    for (const BvhNode& node : bvh.nodes)
      for (int k = 0; k < BVH_WIDTH; ++k) {
        if (node.child[k] >= 0) continue;
        const Bvh::Leaf leaf = bvh.leaves[~node.child[k]];
        ASSERT_LE(leaf.count, 4u);
        for (std::uint32_t i = leaf.first; i < leaf.first + leaf.count; ++i) {
          const Box& box = boxes[bvh.order[i]];
          ++seen[bvh.order[i]];
          EXPECT_TRUE(box.lo.x() >= node.lo_x[k] && box.hi.x() <= node.hi_x[k] && box.lo.y() >= node.lo_y[k] &&
                      box.hi.y() <= node.hi_y[k] && box.lo.z() >= node.lo_z[k] && box.hi.z() <= node.hi_z[k]);
        }
      }
    EXPECT_EQ(seen, std::vector<int>(n, 1));
  }
}

TEST(Bvh, EqualCentresAreStillDivided) {
  const std::vector<Box> boxes(1000, Box{Vec3f::Zero(), Vec3f::Ones()});
  const Bvh bvh = build_bvh(boxes, 4);
  EXPECT_GE(bvh.leaves.size(), 250u);
  EXPECT_LE(bvh.stack_need, BVH_STACK);
}

TEST_F(ManyRays, HitsEqualALoopOverASoup) {
  for (const unsigned n : {1u, 3u, 257u, 2000u}) {
    World world;
    world.add(soup(n, 100 + n, n > 1000 ? 0.05f : 0.3f), pose(0, Vec3::Zero()));
    EXPECT_GT(expect_equal(world, random_rays(4000, 1.5f), n == 2000), 5);
  }
}

TEST_F(ManyRays, HitsEqualALoopOverFlatAndDegenerateMeshes) {
  World world;
  world.add(flat_mesh(), pose(0, Vec3::Zero()));
  EXPECT_GT(expect_equal(world, random_rays(4000, 1.0f)), 200);
}

TEST(Bvh, HitsEqualALoopOverInstances) {
  const unsigned n = test::is_simulated() ? 16 : 6000;
  World world;
  for (int i = 0; i < 30; ++i) {
    Eigen::Matrix<double, 3, 4> p = pose(0.3 * i, Vec3(std::cos(i), std::sin(2 * i), 0.1 * i - 1.5));
    p.leftCols<3>() *= 0.2 + 0.02 * i;
    world.add(i % 2 ? soup(50, unsigned(i), 0.3f) : test::sphere(1, 6), p);
  }
  EXPECT_GT(expect_equal(world, random_rays(n, 2.0f)), int(n / 6));
}

TEST(Bvh, RefittedTreeOfADeformedMeshMissesNothing) {
  const unsigned n = test::is_simulated() ? 16 : 6000;
  World world;
  VisualMesh mesh = test::sphere(1, 24);
  world.add(soup(37, 5, 0.2f), pose(0, Vec3(2, 0, 0)));  // so that its ranges do not start at 0
  world.add(mesh, pose(0, Vec3::Zero()));
  std::vector<Vertex> moved = world.geometry.vertices;
  Box box;
  for (std::size_t i = world.ranges[1].first_vertex; i < moved.size(); ++i) {
    float* p = moved[i].point;
    p[0] = 2.5f * p[0] + 0.3f * std::sin(7 * p[2]) - 1;
    p[1] = 0.4f * p[1] + p[2] * p[2];
    box.add(Vec3f(p[0], p[1], p[2]));
  }
  Device device;
  Buffer<BvhNode> nodes(device, world.geometry.nodes, "nodes");
  Buffer<TriangleBlock> blocks(device, world.geometry.blocks, "blocks");
  Refit refit(device);
  refit(world.ranges[1], Buffer<std::uint32_t>(device, world.geometry.triangles, "triangles"),
        Buffer<Vertex>(device, moved, "vertices"), blocks, nodes);
  world.boxes[1] = box;
  EXPECT_GT(expect_equal(device, world, nodes, blocks, random_rays(n, 2.0f), ""), int(n / 8));
  // the corners are the moved ones, not the old
  const TriangleBlock block = blocks.read()[world.ranges[1].first_block];
  const std::uint32_t corner = world.geometry.triangles[3 * block.triangle[0]];
  EXPECT_EQ(block.corner[0][0][0], moved[corner].point[0]);
}

// points are thrown about, so that the old tree's boxes all overlap
TEST(Bvh, RebuiltTreeOfAScrambledMeshMissesNothingAndCostsLess) {
  const unsigned n = test::is_simulated() ? 16 : 4000;
  World world;
  world.add(soup(37, 5, 0.2f), pose(0, Vec3(2, 0, 0)));  // so that its ranges do not start at 0
  const VisualMesh mesh = soup(600, 6, 0.05f);
  world.add(mesh, pose(0, Vec3::Zero()), true);
  world.add(soup(20, 8, 0.1f), pose(0, Vec3(-2, 0, 0)));  // what stands behind it stays
  std::vector<Vertex> moved = world.geometry.vertices;
  std::mt19937 random(3);
  std::uniform_real_distribution<float> u(-1, 1);
  Box box;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Vec3f shift(u(random), u(random), u(random));
    for (int corner = 0; corner < 3; ++corner) {
      float* p = moved[world.ranges[1].first_vertex + 3 * i + corner].point;
      for (int c = 0; c < 3; ++c) p[c] += shift[c];
      box.add(Vec3f(p[0], p[1], p[2]));
    }
  }
  world.boxes[1] = box;
  Device device;
  Buffer<BvhNode> nodes(device, world.geometry.nodes, "nodes");
  Buffer<TriangleBlock> blocks(device, world.geometry.blocks, "blocks");
  const Buffer<std::uint32_t> triangles(device, world.geometry.triangles, "triangles");
  const Buffer<Vertex> vertices(device, moved, "vertices");
  Refit refit(device);
  const float cost_before = refit.cost(world.ranges[1], nodes);
  refit(world.ranges[1], triangles, vertices, blocks, nodes);
  const float cost_refitted = refit.cost(world.ranges[1], nodes);
  EXPECT_GT(cost_refitted, 2 * cost_before);
  ASSERT_TRUE(rebuild(world.ranges[1], mesh.triangles, vertices, blocks, nodes));
  EXPECT_LT(refit.cost(world.ranges[1], nodes), 0.5f * cost_refitted);
  EXPECT_GT(expect_equal(device, world, nodes, blocks, random_rays(n, 2.0f), ""), int(n / 64));
}

TEST(Bvh, RebuildWithoutRoomLeavesTheTree) {
  World world;
  const VisualMesh mesh = soup(600, 6, 0.05f);
  world.add(mesh, pose(0, Vec3::Zero()));
  world.ranges[0].block_room = 1;
  Device device;
  Buffer<BvhNode> nodes(device, world.geometry.nodes, "nodes");
  Buffer<TriangleBlock> blocks(device, world.geometry.blocks, "blocks");
  EXPECT_FALSE(rebuild(world.ranges[0], mesh.triangles, Buffer<Vertex>(device, world.geometry.vertices, "vertices"),
                       blocks, nodes));
  EXPECT_EQ(nodes.read()[0].child[0], world.geometry.nodes[0].child[0]);
}

// rays from inside a closed surface through its very edges and corners
TEST_F(ManyRays, NoRaySlipsThroughAnEdge) {
  const VisualMesh mesh = test::sphere(1, 24);
  Rays rays;
  for (const Triangle& t : mesh.triangles)
    for (int k = 0; k < 3; ++k)
      for (const float part : {0.0f, 0.5f, 0.3f}) {
        const Vec3f origin(0.01f * float(k), 0, 0.25f);
        const Vec3f to = (1 - part) * mesh.points[t[k]] + part * mesh.points[t[(k + 1) % 3]] - origin;
        rays.origin.push_back({{origin.x(), origin.y(), origin.z(), 0}});
        rays.direction.push_back({{to.x(), to.y(), to.z(), 0}});
      }
  World world;
  world.add(mesh, pose(0, Vec3::Zero()));
  EXPECT_EQ(expect_equal(world, rays, false, 1e-6f), int(rays.origin.size()));
}

}  // namespace
}  // namespace pvg
