// The fin-ray finger of data/grippers, pressed on its pad: how its mesh compares with the same mesh refined.
#include <gtest/gtest.h>

#include <cmath>

#include "host/geometry/tet_mesh.hpp"
#include "host/io/mesh_files.hpp"
#include "host/io/tetgen.hpp"
#include "host/physics/static_equilibrium.hpp"
#include "host/scene/task_file.hpp"

namespace pvg {
namespace {

FingerSection first_finger() { return load_gripper(PVG_DATA_FOLDER "/grippers/umi_finray/gripper.yaml").fingers.at(0); }

TetMesh linear_mesh(const FingerSection& finger) {
  TetgenOptions options;
  options.max_volume = finger.max_tetrahedron_volume;
  options.radius_edge_ratio = finger.radius_edge_ratio;
  options.keeps_surface = finger.keeps_surface;
  options.nodes_per_element = 4;
  return tetrahedralize(read_closed_surface(finger.mesh), options, finger.name);
}

// Share of the load on each node: a pressure on the pad (y = 0) across its whole width, a bell of 6 mm about two thirds
// of the finger's height. Smooth, so that it is the same load on every mesh.
std::vector<double> pad_load(const TetMesh& mesh) {
  std::vector<double> share(mesh.points.size(), 0);
  double sum = 0;
  for (const Triangle& t : mesh.surface) {
    const Vec3 &a = mesh.points[t[0]], &b = mesh.points[t[1]], &c = mesh.points[t[2]];
    if (std::abs(a.y()) + std::abs(b.y()) + std::abs(c.y()) > 1e-6) continue;
    const double third = (b - a).cross(c - a).norm() / 6;
    for (int k = 0; k < 3; ++k) {
      const Vec3 middle = (mesh.points[t[k]] + mesh.points[t[(k + 1) % 3]]) / 2;
      const double pressure = std::exp(-0.5 * std::pow((middle.z() - 0.0567) / 0.006, 2));
      for (const int end : {k, (k + 1) % 3}) share[t[end]] += third * pressure / 2;
      sum += third * pressure;
    }
  }
  for (double& s : share) s /= sum;
  return share;
}

// displacement of the pad under `force` [N], weighted like the load
double deflection(Device& device, const TetMesh& mesh, const SolidMaterial& material, double force) {
  const std::vector<double> share = pad_load(mesh);
  StaticProblem problem{mesh, material, {}, std::vector<Vec3>(mesh.points.size(), Vec3::Zero())};
  for (std::uint32_t i = 0; i < mesh.points.size(); ++i) {
    problem.force[i].y() = force * share[i];
    if (mesh.points[i].z() < 0.5e-3) problem.held.push_back(i);
  }
  const StaticResult result = solve_static(device, problem, {}, 1e-7);
  double mean = 0;
  for (std::size_t i = 0; i < share.size(); ++i) mean += share[i] * (result.points[i].y() - mesh.points[i].y());
  return mean;
}

// Refined once, the finger gives way 7 % more; two layers through the walls, refined once (20,000 elements), 9 % more. Four
// nodes instead of ten would make it several times too stiff.
TEST(FingerStiffness, MeshOfTheTaskIsNearTheSameMeshRefinedOnce) {
  Device device;
  const FingerSection finger = first_finger();
  ASSERT_EQ(finger.nodes_per_element, 10);
  const TetMesh linear = linear_mesh(finger);
  const double task = deflection(device, make_quadratic(linear), finger.material, 0.1);
  const double refined = deflection(device, make_quadratic(refine(linear)), finger.material, 0.1);
  RecordProperty("task_mm", std::to_string(1e3 * task));
  RecordProperty("refined_mm", std::to_string(1e3 * refined));
  EXPECT_LE(task, refined) << "a finer mesh is never stiffer";
  EXPECT_NEAR(refined / task, 1, 0.08);
  EXPECT_GT(task / deflection(device, linear, finger.material, 0.1), 2);
}

}  // namespace
}  // namespace pvg
