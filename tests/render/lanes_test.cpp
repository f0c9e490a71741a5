// Sixteen rays that go any way find what each finds alone: the same bits.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <numeric>

#include "tests/render/ray_world.hpp"

namespace pvg {
namespace {

using test::pose;
using test::Rays;
using test::soup;
using test::World;
using Lanes = test::ManyPaths;

// Moved, mirrored and unmoved instances, some in one leaf, some around all rays; by number whom they stop and whether
// they are of clear glass.
World many_instances(unsigned n) {
  constexpr std::uint32_t MASKS[] = {MASK_SURFACES | MASK_RECEIVERS, MASK_SURFACES, MASK_RECEIVERS, 0,
                                     (MASK_SURFACES | MASK_RECEIVERS) << MASK_CUTOUT_SHIFT};
  World world;
  world.add(soup(40, 5, 0.3f), pose(0, Vec3::Zero()));  // all rays meet its box
  if (n > 1) world.add(test::flat_mesh(), pose(0, Vec3::Zero()));
  for (unsigned i = 0; i < n; ++i) {
    Eigen::Matrix<double, 3, 4> p = pose(0.3 * i, Vec3(std::cos(i), std::sin(2 * i), std::sin(5 * i)));
    p.leftCols<3>() *= 0.1 + 0.1 * (i % 5);
    if (i % 3 == 0) p.col(1) *= -0.5;
    if (i % 4 == 0) p = pose(0, Vec3::Zero());
    world.add(i % 4 == 2 ? test::sphere(0.4, 6) : soup(i % 5 ? 60 : 3, i, i % 4 ? 0.4f : 0.1f), p);
  }
  // moved meshes of a single leaf that many rays meet, one for each mask
  for (unsigned i = 0; i < 5 && n > 7; ++i)
    world.add(test::quad({-0.4f, -0.4f, 0}, {0.8f, 0, 0}, {0, 0.8f, 0}),
              pose(0.7 * i + 0.3, Vec3(0.3, 0.2 * i - 0.4, 0.1)));
  for (std::size_t i = 0; i < world.instances.size(); ++i) {
    world.instances[i].mask = MASKS[i % 5];
    world.instances[i].material = std::uint32_t(i % 2);
    if (i % 3 == 2) world.instances[i].flags |= INSTANCE_CLEAR;
  }
  return world;
}

// any way; every fourth along an axis, every fourth with two components of the same size, some with three
Rays any_rays(std::size_t n, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> u(-1, 1);
  Rays rays;
  for (std::size_t i = 0; i < n; ++i) {
    rays.origin.push_back({{u(random), u(random), u(random), 0}});
    rays.direction.push_back({{u(random), u(random), u(random), 0}});
    if (i % 4 == 0)
      for (int axis = 0; axis < 3; ++axis)
        if (axis != int(i / 4 % 3)) rays.direction[i].v[axis] = i % 8 ? 0.0f : -0.0f;
    if (i % 4 == 1) {
      float(&d)[4] = rays.direction[i].v;
      const std::size_t kept = i / 4 % 3, same = (kept + 1) % 3;
      d[same] = i % 8 == 1 ? d[kept] : -d[kept];
      if (i % 32 == 1) d[(kept + 2) % 3] = d[kept];
    }
  }
  return rays;
}

// half of the slots, in any order
std::vector<std::uint32_t> any_slots(std::size_t n_slots) {
  std::vector<std::uint32_t> slots(n_slots);
  std::iota(slots.begin(), slots.end(), 0u);
  std::shuffle(slots.begin(), slots.end(), std::mt19937(1));
  slots.resize((n_slots + 1) / 2);
  return slots;
}

TEST_F(Lanes, FindWhatEachRayFinds) {
  Device device;
  Traversal traversal(device, false);
  for (const unsigned n_instances : {0u, 1u, 7u, 40u, 200u})
    for (const std::size_t n_slots : {1u, 37u, 9000u}) {
      const DeviceTrees trees = test::device_trees(device, many_instances(n_instances));
      const Rays rays = any_rays(n_slots, n_instances);
      const std::vector<std::uint32_t> slots = any_slots(n_slots);
      const Buffer<std::uint32_t> queue(device, slots, "queue");
      const Buffer<F32x4> origin(device, rays.origin, "origin"), direction(device, rays.direction, "direction");
      Buffer<F32x4> hit(device, n_slots, "hit");
      Buffer<std::uint32_t> hit_instance(device, n_slots, "hit_instance");
      hit.zero();
      hit_instance.zero();
      test::find_closest_alone(device, slots.size(), queue, trees, origin, direction, hit, hit_instance);
      const std::vector<F32x4> alone = hit.read();
      const std::vector<std::uint32_t> instance_alone = hit_instance.read();
      hit.zero();
      hit_instance.zero();
      traversal.find_closest(slots.size(), queue, trees, origin, direction, hit, hit_instance);
      const std::vector<F32x4> together = hit.read();
      EXPECT_EQ(std::memcmp(alone.data(), together.data(), n_slots * sizeof(F32x4)), 0)
          << n_instances << " " << n_slots;
      EXPECT_EQ(instance_alone, hit_instance.read()) << n_instances << " " << n_slots;
      const auto n_hits = std::ranges::count_if(slots, [&](std::uint32_t i) { return std::isfinite(alone[i].v[0]); });
      EXPECT_TRUE(n_slots < 9000 || n_hits > 500) << n_hits;
    }
}

// meshes of thousands of triangles: nodes whose eight boxes all lie on a ray's way, and visits behind what was hit
// already
TEST_F(Lanes, FindWhatEachRayFindsInLargeMeshes) {
  Device device;
  World world;
  world.add(soup(test::is_simulated() ? 200 : 20000, 1, 0.1f), pose(0, Vec3::Zero()));
  world.add(soup(3000, 2, 0.02f), pose(0.4, Vec3(0.1, 0, 0)));
  world.add(test::sphere(0.7f, 64), pose(0, Vec3::Zero()));
  const DeviceTrees trees = test::device_trees(device, world);
  const std::size_t n = test::is_simulated() ? 37 : 9000;
  const Rays rays = any_rays(n, 3);
  std::vector<std::uint32_t> slots(n);
  std::iota(slots.begin(), slots.end(), 0u);
  const Buffer<std::uint32_t> queue(device, slots, "queue");
  const Buffer<F32x4> origin(device, rays.origin, "origin"), direction(device, rays.direction, "direction");
  Buffer<F32x4> alone(device, n, "alone"), together(device, n, "together");
  Buffer<std::uint32_t> instance_alone(device, n, "instance_alone"), instance(device, n, "instance");
  test::find_closest_alone(device, n, queue, trees, origin, direction, alone, instance_alone);
  Traversal(device, false).find_closest(n, queue, trees, origin, direction, together, instance);
  const std::vector<F32x4> a = alone.read(), b = together.read();
  EXPECT_EQ(std::memcmp(a.data(), b.data(), n * sizeof(F32x4)), 0);
  EXPECT_EQ(instance_alone.read(), instance.read());
}

// the visits of a node: by descending numbers, those of boxes that are not met last
TEST_F(Lanes, VisitsAreSortedWithTheirChildren) {
  Device device;
  Kernel sort = Program::from_text(device, "sort", R"(
#include "render/lanes/meshes.cl"
kernel void sort(const uint n, global int* visits, global int* children) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  const int8 sorted = sorted_descending(vload8(i, visits));
  vstore8(elements_of(vload8(i, children), sorted), i, children);
  vstore8(sorted, i, visits);
})",
                                   traversal_options(device))
                    .kernel("sort");
  const std::size_t n = 500;
  std::mt19937 random(4);
  std::vector<std::int32_t> visits(8 * n), children(8 * n);
  for (std::size_t i = 0; i < visits.size(); ++i) {
    visits[i] = random() % 3 == 0 ? -1 : int(random() % (i % 16 < 8 ? 40 : 1 << 30)) / 8 * 8 + int(i % 8);
    children[i] = int(random());
  }
  Buffer<std::int32_t> visits_there(device, visits, "visits"), children_there(device, children, "children");
  sort(n, std::uint32_t(n), visits_there, children_there);
  const std::vector<std::int32_t> sorted = visits_there.read(), moved = children_there.read();
  for (std::size_t i = 0; i < n; ++i) {
    std::vector<std::int32_t> expected(visits.begin() + 8 * i, visits.begin() + 8 * i + 8);
    std::ranges::sort(expected, std::greater());
    EXPECT_TRUE(std::equal(expected.begin(), expected.end(), sorted.begin() + 8 * i)) << i;
    for (std::size_t k = 8 * i; k < 8 * i + 8 && sorted[k] >= 0; ++k)
      EXPECT_EQ(moved[k], children[8 * i + sorted[k] % 8]) << i;
  }
}

// shadow rays of all kinds, and paths without one
TEST_F(Lanes, LightArrivesAsAtEachRay) {
  Device device;
  Traversal traversal(device, false);
  Traversal one_by_one(device, true);
  std::vector<Material> materials(2);
  for (Material& m : materials) {
    m.ior = 1.5f;
    std::ranges::copy(std::initializer_list<float>{0.9f, 0.8f, 0.7f}, m.color);
    std::ranges::copy(std::initializer_list<float>{0.3f, 0.2f, 0.9f}, m.absorption);
  }
  materials[1].flags = MATERIAL_THIN;
  const Buffer<Material> on_device(device, materials, "materials");
  for (const unsigned n_instances : {0u, 1u, 7u, 40u})
    for (const std::size_t n_slots : {1u, 37u, 9000u})
      for (const std::uint32_t transparent : {0u, 1u}) {
        const DeviceTrees trees = test::device_trees(device, many_instances(n_instances));
        Rays rays = any_rays(n_slots, n_instances);
        std::vector<F32x4> light(n_slots, F32x4{{0.3f, 0.2f, 0.7f, 0.9f}}), lit(n_slots, F32x4{{0.1f, 0.2f, 0.3f, 5}});
        for (std::size_t i = 0; i < n_slots; ++i) {
          const std::uint32_t kind = n_slots == 1 ? SHADOW_SURFACE : std::uint32_t(i * 2654435761u >> 7) % 4;
          std::memcpy(&rays.origin[i].v[3], &kind, sizeof kind);
        }
        const std::vector<std::uint32_t> slots = any_slots(n_slots);
        const std::uint32_t n = std::uint32_t(slots.size());
        const Buffer<std::uint32_t> queue(device, slots, "queue");
        const Buffer<F32x4> origin(device, rays.origin, "origin"), direction(device, rays.direction, "direction"),
            lights(device, light, "light");
        Buffer<F32x4> alone(device, lit, "radiance"), together(device, lit, "radiance");
        one_by_one.add_light(n, queue, transparent != 0, trees, on_device, origin, direction, lights, alone);
        traversal.add_light(n, queue, transparent != 0, trees, on_device, origin, direction, lights, together);
        const std::vector<F32x4> a = alone.read(), b = together.read();
        EXPECT_EQ(std::memcmp(a.data(), b.data(), n_slots * sizeof(F32x4)), 0) << n_instances << " " << n_slots;
        // all light, none and a part of it
        if (n_slots < 9000 || n_instances < 7) continue;
        const auto share = [&](auto is) { return std::ranges::count_if(slots, [&](auto i) { return is(a[i].v[0]); }); };
        const float all = 0.1f + 0.3f * 0.9f;
        EXPECT_GT(share([&](float x) { return std::abs(x - all) < 1e-6f; }), 300);
        EXPECT_GT(share([&](float x) { return x == 0.1f; }), 300);
        EXPECT_GT(share([&](float x) { return x > 0.1f && x < all - 1e-3f; }), 5);
      }
}

}  // namespace
}  // namespace pvg
