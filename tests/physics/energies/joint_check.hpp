// What the terms on a joint's coordinate q share in their tests: the law of a drive in double, joints to try, and the
// Gauss-Newton Hessian V''(q) dq dq^T by differences.
#pragma once
#include <Eigen/Geometry>

#include "tests/physics/energies/energy_check.hpp"

namespace pvg {

// V(q) of a drive, its effort found by the definition: wanted, then cut
template <class Params>
double drive_law(const Params& p, double q, double q0, double h) {
  const double damped = p.damping / (2 * h) * std::pow(q - q0 - p.target_change, 2);
  const double L = p.effort_limit, wanted = p.feed_forward - p.stiffness * (q - p.target);
  if (p.stiffness == 0) return damped - (L > 0 ? std::min(std::max(wanted, -L), L) : wanted) * (q - p.target);
  // the integral of the effort from where it vanishes
  if (L > 0 && std::abs(wanted) > L) return damped + (L * std::abs(wanted) - L * L / 2) / p.stiffness;
  return damped + wanted * wanted / (2 * p.stiffness);
}

template <class Params>
void set_random_law(Params& p, Random& random, double range) {
  p.stiffness = random.number(0, 1) < 0.2 ? 0 : random.number(10, 1e4);
  p.damping = random.number(0, 50);
  p.target = random.number(-range, range);
  p.target_change = random.number(-0.1, 0.1) * range;
  p.effort_limit = random.number(0, 1) < 0.5 ? 0 : random.number(1, 50);
  p.feed_forward = random.number(-20, 20);
}

// x: n_i, b_i, n_j, b_j
inline double host_angle(const Vec3* x) {
  return std::atan2((x[1].dot(x[2]) - x[0].dot(x[3])) / 2, (x[0].dot(x[2]) + x[1].dot(x[3])) / 2);
}

inline double host_revolute(const Vec3* x, const Vec3* x0, double angle0) {
  const double change = host_angle(x) - host_angle(x0);
  return angle0 + std::atan2(std::sin(change), std::cos(change));
}

// the four directions of a revolute joint in a random pose, the child turned by `angle` about the axis
inline std::vector<Vec3> revolute_sites(Random& random, double angle) {
  const Eigen::Matrix3d frame = random.rotation();  // columns n, b, axis
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(angle, frame.col(2)).toRotationMatrix();
  return {frame.col(0), frame.col(1), turn * frame.col(0), turn * frame.col(1)};
}

template <class Params>
std::vector<EnergyElement<Params>> revolute_joints(std::size_t n, double noise) {
  Random random(11);
  std::vector<EnergyElement<Params>> joints(n);
  for (auto& joint : joints) {
    joint.params.angle0 = random.number(-10, 10);
    joint.x0 = revolute_sites(random, joint.params.angle0);
    joint.x = revolute_sites(random, joint.params.angle0 + random.number(-2, 2));
    for (Vec3& x : joint.x) x += random.vector(noise);
  }
  return joints;
}

template <class Params>
std::vector<EnergyElement<Params>> prismatic_joints(std::size_t n) {
  Random random(12);
  std::vector<EnergyElement<Params>> joints(n);
  for (auto& joint : joints) {
    const Vec3 parent = random.vector(1), child = parent + random.vector(0.1);
    joint.x0 = {parent, child, random.rotation().col(0)};
    joint.x = {parent + random.vector(0.02), child + random.vector(0.02), joint.x0[2] + random.vector(0.02)};
  }
  return joints;
}

// d2V/dq2, but the secant V'/u of the straight part where the effort is cut
template <class Params>
double drive_curvature(const Params& p, double q, double h) {
  const double wanted = std::abs(p.feed_forward - p.stiffness * (q - p.target));
  const bool is_cut = p.effort_limit > 0 && wanted > p.effort_limit;
  return p.damping / h + p.stiffness * (is_cut && p.stiffness > 0 ? p.effort_limit / wanted : 1);
}

// Hessian of every element = curvature(q) dq dq^T, dq by differences
template <class Params>
void expect_gauss_newton(EnergyCheck<Params>& check, const std::vector<EnergyElement<Params>>& elements,
                         const std::function<double(const Params&, const Vec3*, const Vec3*)>& coordinate,
                         const std::function<double(const Params&, double q, double h)>& curvature) {
  const std::vector<EnergyResult> results = check.evaluate(elements);
  for (std::size_t e = 0; e < elements.size(); ++e) {
    const Params& p = elements[e].params;
    std::vector<Vec3> x = elements[e].x;
    const Vec3* x0 = elements[e].x0.data();
    Eigen::VectorXd dq(check.SIZE);
    for (int i = 0; i < check.SIZE; ++i) {
      const double middle = x[i / 3](i % 3), step = 1e-5;
      x[i / 3](i % 3) = middle + step;
      const double after = coordinate(p, x.data(), x0);
      x[i / 3](i % 3) = middle - step;
      dq(i) = (after - coordinate(p, x.data(), x0)) / (2 * step);
      x[i / 3](i % 3) = middle;
    }
    const double c = curvature(p, coordinate(p, x.data(), x0), check.H);
    const Eigen::MatrixXd expected = c * dq * dq.transpose();
    ASSERT_LE((results[e].hessian - expected).cwiseAbs().maxCoeff(), 1e-6 * (c + 1e-6) * dq.squaredNorm())
        << "element " << e;
  }
}

}  // namespace pvg
