#include "pipeline/validation/finger.hpp"

#include <fmt/format.h>

#include <cmath>

#include "host/formats/mesh_files.hpp"
#include "host/formats/tetgen.hpp"
#include "host/load/task_file.hpp"
#include "host/physics/step/static_equilibrium.hpp"
#include "pipeline/validation/cases.hpp"

namespace pvg {
namespace {

constexpr double PAD_CENTER = 0.0567, PAD_SPREAD = 0.006;  // of the pressure, along the finger's height [m]
constexpr double FOOT = 0.5e-3;                            // nodes below are held [m]
constexpr double EQUILIBRIUM = 1e-7;                       // of the last correction [m]

// Share of the load on each node. The pressure is smooth, so that it is the same load on every mesh.
std::vector<double> pad_load(const TetMesh& mesh) {
  std::vector<double> share(mesh.points.size(), 0);
  double sum = 0;
  for (const Triangle& t : mesh.surface) {
    const Vec3 &a = mesh.points[t[0]], &b = mesh.points[t[1]], &c = mesh.points[t[2]];
    if (std::abs(a.y()) + std::abs(b.y()) + std::abs(c.y()) > 1e-6) continue;
    const double third = (b - a).cross(c - a).norm() / 6;
    for (int k = 0; k < 3; ++k) {
      const Vec3 middle = (mesh.points[t[k]] + mesh.points[t[(k + 1) % 3]]) / 2;
      const double pressure = std::exp(-0.5 * std::pow((middle.z() - PAD_CENTER) / PAD_SPREAD, 2));
      for (const int end : {k, (k + 1) % 3}) share[t[end]] += third * pressure / 2;
      sum += third * pressure;
    }
  }
  for (double& s : share) s /= sum;
  return share;
}

}  // namespace

TetMesh linear_finger_mesh(const FingerSection& finger) {
  TetgenOptions options;
  options.max_volume = finger.max_tetrahedron_volume;
  options.radius_edge_ratio = finger.radius_edge_ratio;
  options.keeps_surface = finger.keeps_surface;
  options.nodes_per_element = 4;
  return tetrahedralize(read_closed_surface(finger.mesh), options, finger.name);
}

std::vector<double> pad_deflections(Device& device, const TetMesh& mesh, const SolidMaterial& material,
                                    const std::vector<double>& forces) {
  const std::vector<double> share = pad_load(mesh);
  StaticProblem problem{mesh, material, {}, std::vector<Vec3>(mesh.points.size(), Vec3::Zero())};
  for (std::uint32_t i = 0; i < mesh.points.size(); ++i)
    if (mesh.points[i].z() < FOOT) problem.held.push_back(i);
  std::vector<double> deflections;
  std::vector<Vec3> shape;
  for (const double force : forces) {
    for (std::size_t i = 0; i < share.size(); ++i) problem.force[i].y() = force * share[i];
    shape = solve_static(device, problem, shape, EQUILIBRIUM).points;
    double mean = 0;
    for (std::size_t i = 0; i < share.size(); ++i) mean += share[i] * (shape[i].y() - mesh.points[i].y());
    deflections.push_back(mean);
  }
  return deflections;
}

void validate_finger(Validation& v) {
  const FingerSection finger = load_gripper(v.data_file("grippers/umi_finray/gripper.yaml")).fingers.at(0);
  const TetMesh linear = linear_finger_mesh(finger);
  const std::vector<double> forces = {0.5, 1, 2, 3, 4};
  const std::vector<double> task = pad_deflections(v.device, make_quadratic(linear), finger.material, forces);
  const std::vector<double> fine = pad_deflections(v.device, make_quadratic(refine(linear)), finger.material, forces);
  Plot plot{"finger", "Fin-ray finger: force on the pad", "deflection [mm]", "force [N]", {}};
  Curve of_task{"mesh of the task", {0}, {0}}, of_fine{"every element split into eight", {0}, {0}, true};
  for (std::size_t i = 0; i < forces.size(); ++i) {
    const std::string name = fmt::format("deflection of the pad under {:.1f} N", forces[i]);
    v.check_relative(name, "m", fine[i], task[i], 0.10, "the same finger, every element split into eight");
    of_task.x.push_back(1e3 * task[i]), of_task.y.push_back(forces[i]);
    of_fine.x.push_back(1e3 * fine[i]), of_fine.y.push_back(forces[i]);
  }
  plot.curves = {of_task, of_fine};
  v.plot(std::move(plot));
}

}  // namespace pvg
