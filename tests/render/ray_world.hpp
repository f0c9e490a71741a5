// Meshes and instances that rays are sent through.
#pragma once
#include <random>
#include <vector>

#include "host/render/geometry.hpp"
#include "host/render/traversal.hpp"
#include "tests/render/test_scene.hpp"

namespace pvg::test {

struct World {
  GeometryArrays geometry;
  std::vector<MeshRange> ranges;
  std::vector<Instance> instances;
  std::vector<Box> boxes;
  void add(const VisualMesh& mesh, const Eigen::Matrix<double, 3, 4>& pose, bool deforms = false) {
    ranges.push_back(geometry.add(mesh, "test", deforms));
    instances.push_back(make_instance(pose, ranges.back(), "test"));
    instances.back().mask = MASK_SURFACES;
    boxes.push_back(world_box(instances.back(), ranges.back().box));
  }
};

struct Rays {
  std::vector<F32x4> origin, direction;
};

// triangles at random places
inline VisualMesh soup(unsigned n, unsigned seed, float size) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> u(-1, 1);
  VisualMesh mesh;
  for (unsigned i = 0; i < n; ++i) {
    const Vec3f center(u(random), u(random), u(random));
    for (int k = 0; k < 3; ++k) mesh.points.push_back(center + size * Vec3f(u(random), u(random), u(random)));
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return mesh;
}

// in the plane z = 0, so that boxes have no height; every second triangle has no area
inline VisualMesh flat_mesh() {
  VisualMesh mesh;
  for (unsigned i = 0; i < 400; ++i) {
    const Vec3f corner(float(i % 20) / 10 - 1, float(i / 20) / 10 - 1, 0);
    for (const Vec3f& d : {Vec3f(0, 0, 0), Vec3f(0.1f, 0, 0), Vec3f(0, 0.1f, 0)}) mesh.points.push_back(corner + d);
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    mesh.triangles.push_back({3 * i, 3 * i, 3 * i + 1});
  }
  return mesh;
}

inline Eigen::Matrix<double, 3, 4> pose(double angle, const Vec3& at) {
  Pose p = Pose::Identity();
  p.linear() = Eigen::AngleAxisd(angle, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  p.translation() = at;
  return p.matrix().topRows<3>();
}

inline DeviceTrees device_trees(Device& device, const World& world) {
  return {Buffer<BvhNode>(device, build_instance_tree(world.boxes), "top"),
          Buffer<BvhNode>(device, world.geometry.nodes, "nodes"),
          Buffer<TriangleBlock>(device, world.geometry.blocks, "blocks"),
          Buffer<Instance>(device, world.instances, "instances")};
}

// what every ray finds by itself: the kernel that GPUs take
inline void find_closest_alone(Device& device, std::size_t n, const Buffer<std::uint32_t>& queue,
                               const DeviceTrees& trees, const Buffer<F32x4>& origin, const Buffer<F32x4>& direction,
                               Buffer<F32x4>& hit, Buffer<std::uint32_t>& hit_instance) {
  Kernel intersect = Program(device, "render/wavefront/intersect.cl", traversal_options(device)).kernel("intersect");
  intersect(n, std::uint32_t(n), queue, trees.top, trees.nodes, trees.blocks, trees.instances, origin, direction, hit,
            hit_instance);
}

}  // namespace pvg::test
