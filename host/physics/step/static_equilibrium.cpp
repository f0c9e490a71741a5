#include "host/physics/step/static_equilibrium.hpp"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <string>

#include "host/physics/energies/system.hpp"
#include "host/physics/linear/term.hpp"

namespace pvg {
namespace {

constexpr int MAX_NEWTON = 200, MAX_HALVINGS = 30;

PhysicalScene scene_of(const StaticProblem& problem) {
  PhysicalScene scene;
  scene.name = "static equilibrium";
  scene.soft_bodies.resize(1);
  scene.soft_bodies[0].name = "body";
  scene.soft_bodies[0].mesh = problem.mesh;
  scene.soft_bodies[0].material = problem.material;
  return scene;
}

// The elastic energy on the device, the loads and the sparse matrix on the host.
class Balance {
 public:
  Balance(Device& device, const StaticProblem& problem)
      : system_(make_system(std::vector<PhysicalScene>{scene_of(problem)})),
        problem_(problem),
        term_(device, "elastic",
              problem.mesh.nodes_per_element == 10 ? "stable_neo_hookean_10" : "stable_neo_hookean_4",
              problem.mesh.nodes_per_element),
        x_(device, system_.x, "x"),
        energy_(device, problem.mesh.n_elements(), "energy"),
        rows_(device, problem.mesh.elements.size() * 3, "rows"),
        unknown_(system_.n_nodes(), 0) {
    if (problem.force.size() != system_.n_nodes()) throw UsageError("static equilibrium: one force per node is needed");
    if (problem.mesh.nodes_per_element == 10)
      term_.set(system_.stable_neo_hookean_10.rows, system_.stable_neo_hookean_10.world_first);
    else
      term_.set(system_.stable_neo_hookean_4.rows, system_.stable_neo_hookean_4.world_first);
    for (const std::uint32_t node : problem.held) unknown_.at(node) = -1;
    for (int& number : unknown_)
      if (number == 0) number = n_unknowns_++;
  }

  double energy(const Eigen::VectorXd& x) {
    write(x);
    term_.energy(x_, x_, 1, 0, energy_);
    double sum = 0;
    for (const double e : energy_.read()) sum += e;
    for (std::size_t i = 0; i < problem_.force.size(); ++i) sum -= problem_.force[i].dot(x.segment<3>(3 * i));
    return sum;
  }

  // forces out of balance on the free nodes, and the matrix of their change
  Eigen::VectorXd gradient(const Eigen::VectorXd& x) {
    write(x);
    term_.gradient(x_, x_, 1, rows_);
    const std::vector<double> rows = rows_.read();
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(3 * n_unknowns_);
    for (std::size_t k = 0; k < problem_.mesh.elements.size(); ++k) {
      const int i = unknown_[problem_.mesh.elements[k]];
      if (i >= 0) sum.segment<3>(3 * i) += Vec3(rows[3 * k], rows[3 * k + 1], rows[3 * k + 2]);
    }
    for (std::size_t n = 0; n < unknown_.size(); ++n)
      if (unknown_[n] >= 0) sum.segment<3>(3 * unknown_[n]) -= problem_.force[n];
    return sum;
  }

  const Eigen::SparseMatrix<double>& hessian(const Eigen::VectorXd& x) {
    write(x);
    term_.hessian(x_, x_, 1);
    const std::vector<double> blocks = term_.blocks().read();
    const std::size_t n = problem_.mesh.nodes_per_element;
    std::vector<Eigen::Triplet<double>> entries;
    const double* number = blocks.data();
    for (std::size_t e = 0; e < problem_.mesh.n_elements(); ++e)
      for (std::size_t a = 0; a < n; ++a)
        for (std::size_t b = a; b < n; ++b)  // the upper half of the element's, for the lower one of the matrix
          for (int k = 0; k < 9; ++k, ++number) {
            const int i = 3 * unknown_[problem_.mesh.elements[e * n + a]] + k / 3;
            const int j = 3 * unknown_[problem_.mesh.elements[e * n + b]] + k % 3;
            // held nodes have -1 and so a negative number
            if (i >= 0 && j >= 0 && (a < b || k / 3 <= k % 3))
              entries.emplace_back(std::max(i, j), std::min(i, j), *number);
          }
    matrix_.resize(3 * n_unknowns_, 3 * n_unknowns_);
    matrix_.setFromTriplets(entries.begin(), entries.end());
    return matrix_;
  }

  // x moved by `step` along d
  Eigen::VectorXd moved(const Eigen::VectorXd& x, const Eigen::VectorXd& d, double step) const {
    Eigen::VectorXd result = x;
    for (std::size_t n = 0; n < unknown_.size(); ++n)
      if (unknown_[n] >= 0) result.segment<3>(3 * n) += step * d.segment<3>(3 * unknown_[n]);
    return result;
  }

  const std::vector<double>& rest() const { return system_.x; }

 private:
  void write(const Eigen::VectorXd& x) { x_.write(std::span<const double>(x.data(), std::size_t(x.size()))); }

  System system_;
  const StaticProblem& problem_;
  Term term_;
  Buffer<double> x_, energy_, rows_;
  std::vector<int> unknown_;  // [n_points] number among the free nodes, -1: held
  int n_unknowns_ = 0;
  Eigen::SparseMatrix<double> matrix_;
};

// Halves the step until the energy falls, moves x by it, and returns the energy there.
double line_search(Balance& balance, const Eigen::VectorXd& direction, double slope, double energy,
                   Eigen::VectorXd& x) {
  // differences of the energy below its rounding decide nothing
  const double noise = 1e-13 * std::abs(energy);
  double step = 1;
  for (int k = 0; k < MAX_HALVINGS; ++k, step /= 2) {
    const Eigen::VectorXd next = balance.moved(x, direction, step);
    const double lower = balance.energy(next);
    if (lower <= energy + 1e-4 * step * slope + noise) {
      x = next;
      return lower;
    }
  }
  throw Failure("static equilibrium: no step lowers the energy; apply the load in smaller parts");
}

}  // namespace

StaticResult solve_static(Device& device, const StaticProblem& problem, const std::vector<Vec3>& start,
                          double tolerance) {
  Balance balance(device, problem);
  Eigen::VectorXd x = Eigen::Map<const Eigen::VectorXd>(balance.rest().data(), Eigen::Index(balance.rest().size()));
  if (!start.empty() && 3 * start.size() != balance.rest().size())
    throw UsageError("static equilibrium: the start needs one point per node");
  for (std::size_t i = 0; i < start.size(); ++i) x.segment<3>(3 * i) = start[i];

  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower> factor;
  StaticResult result;
  for (double energy = balance.energy(x);;) {
    const Eigen::VectorXd gradient = balance.gradient(x);
    const Eigen::SparseMatrix<double>& matrix = balance.hessian(x);
    if (result.newton == 0) factor.analyzePattern(matrix);
    factor.factorize(matrix);
    if (factor.info() != Eigen::Success || !(factor.vectorD().minCoeff() > 1e-12 * factor.vectorD().maxCoeff()))
      throw Failure("static equilibrium: the stiffness matrix is singular; hold more nodes");
    const Eigen::VectorXd direction = factor.solve(-gradient);
    result.correction = direction.cwiseAbs().maxCoeff();
    if (result.correction <= tolerance) break;
    if (++result.newton > MAX_NEWTON)
      throw Failure("static equilibrium: nodes still move by " + std::to_string(result.correction) + " m after " +
                    std::to_string(MAX_NEWTON) + " iterations; apply the load in smaller parts");
    energy = line_search(balance, direction, gradient.dot(direction), energy, x);
  }
  for (Eigen::Index i = 0; i < x.size() / 3; ++i) result.points.push_back(x.segment<3>(3 * i));
  return result;
}

}  // namespace pvg
