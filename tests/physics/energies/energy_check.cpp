#include "tests/physics/energies/energy_check.hpp"

#include <Eigen/Eigenvalues>
#include <sstream>

namespace pvg {

double smallest_eigenvalue(const Eigen::MatrixXd& symmetric) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(symmetric).eigenvalues()(0);
}

Eigen::MatrixXd nearest_positive(const Eigen::MatrixXd& symmetric) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(symmetric);
  return solver.eigenvectors() * solver.eigenvalues().cwiseMax(0).asDiagonal() * solver.eigenvectors().transpose();
}

bool is_product(const Eigen::VectorXd& found, const Eigen::MatrixXd& matrix, const Eigen::VectorXd& x) {
  return found.isApprox(matrix * x, 1e-12);
}

std::string text_of(const Eigen::VectorXd& numbers) {
  std::ostringstream text;
  text << numbers.transpose();
  return text.str();
}

}  // namespace pvg
