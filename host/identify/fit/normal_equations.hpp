// Normal equations of numbers that have units of their own: a play of 1e-3 m beside a modulus of 1e7 Pa makes entries
// that differ by twenty orders of magnitude, more than a double tells from zero. So each row and column is taken in
// units of its diagonal. A number that nothing depends on has zeros.
#pragma once
#include <Eigen/Dense>

namespace pvg::diagnose {

// The pseudo-inverse of a symmetric matrix without negative eigenvalues, of its part in such units; zeros for numbers
// that nothing depends on.
Eigen::MatrixXd inverse_in_own_units(const Eigen::MatrixXd& a);

// Adds `share` of each diagonal to it, and 1 where it is 0, so that such a number stays where it is.
void add_to_diagonal(Eigen::MatrixXd& a, double share);

}  // namespace pvg::diagnose
