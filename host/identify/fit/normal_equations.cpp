#include "host/identify/fit/normal_equations.hpp"

#include <cmath>

namespace pvg::diagnose {
using Eigen::MatrixXd, Eigen::VectorXd;

MatrixXd inverse_in_own_units(const MatrixXd& a) {
  VectorXd unit = VectorXd::Zero(a.rows());
  for (Eigen::Index i = 0; i < a.rows(); ++i)
    if (a(i, i) > 0) unit[i] = 1 / std::sqrt(a(i, i));
  const MatrixXd scaled = unit.asDiagonal() * a * unit.asDiagonal();
  return unit.asDiagonal() * scaled.completeOrthogonalDecomposition().pseudoInverse() * unit.asDiagonal();
}

void add_to_diagonal(MatrixXd& a, double share) {
  for (Eigen::Index i = 0; i < a.rows(); ++i) a(i, i) += a(i, i) == 0 ? 1 : share * a(i, i);
}

}  // namespace pvg::diagnose
