// Unknowns: displacements (r, z) of the nodes of a quarter of the meridian, 0 <= r, 0 <= z. Bilinear quadrilaterals, 2
// x 2 points of Gauss. With G = F - 1 of the five components rr, rz, zr, zz and around the axis (u_r / r):
//   linear:       Psi = mu |sym G|^2 + lambda/2 (tr G)^2
//   neo-Hookean:  Psi = mu/2 (|F|^2 - 3) + lambda'/2 (J - 1 - mu/lambda')^2,  lambda' = lambda + mu  (Smith et al.
//   2018)
// Newton's method; a node of the surface is held on the plane while the plane pushes it, and free else.
#include "pipeline/validation/pressed_sphere.hpp"

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <cmath>
#include <numbers>
#include <vector>

#include "host/base/error.hpp"

namespace pvg {
namespace {

using Eigen::Vector2d, Eigen::VectorXd;
using Strain = Eigen::Matrix<double, 5, 1>;
using Stiffness = Eigen::Matrix<double, 5, 5>;

constexpr double GRADING = 1.8;  // cells crowd around the pole
constexpr int MOST_ITERATIONS = 60;
constexpr double FORCE_TOLERANCE = 1e-9;    // [N]
constexpr double LENGTH_TOLERANCE = 1e-12;  // [m]

// dPsi/dG [Pa] and its derivative
struct Response {
  Strain stress;
  Stiffness tangent;
};

Response linear_response(const Strain& g, double mu, double lambda) {
  Stiffness t = Stiffness::Zero();
  for (const int i : {0, 3, 4}) {
    for (const int j : {0, 3, 4}) t(i, j) = lambda;
    t(i, i) += 2 * mu;
  }
  t.block<2, 2>(1, 1).setConstant(mu);
  return {t * g, t};
}

Response neo_hookean_response(const Strain& g, double mu, double lambda) {
  const Strain f = g + Strain(1, 0, 0, 1, 1);
  const double stiffened = lambda + mu, in_plane = f[0] * f[3] - f[1] * f[2];
  const double k = stiffened * (in_plane * f[4] - 1) - mu;
  const Strain dj(f[3] * f[4], -f[2] * f[4], -f[1] * f[4], f[0] * f[4], in_plane);
  Stiffness ddj = Stiffness::Zero();
  const auto set = [&](int i, int j, double value) { ddj(i, j) = ddj(j, i) = value; };
  set(0, 3, f[4]), set(1, 2, -f[4]);
  set(0, 4, f[3]), set(1, 4, -f[2]), set(2, 4, -f[1]), set(3, 4, f[0]);
  return {mu * f + k * dj, mu * Stiffness::Identity() + stiffened * dj * dj.transpose() + k * ddj};
}

// A point of Gauss: G = strain_of * (r and z of the four nodes' displacements)
struct Point {
  int node[4];
  Eigen::Matrix<double, 5, 8> strain_of;  // [1/m]
  double volume;                          // [m^3], around the whole axis
};

struct Mesh {
  std::vector<Vector2d> rest;  // [m]
  std::vector<Point> points;
  std::vector<int> surface, axis, midplane;  // nodes
};

void add_points(Mesh& mesh, const std::array<int, 4>& node) {
  constexpr double SIGN[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
  const double at = 1 / std::sqrt(3.0);
  for (const auto& corner : SIGN) {
    Eigen::Matrix<double, 4, 2> slope;  // of the shape functions in the cell's own coordinates
    Eigen::Vector4d shape;
    for (int a = 0; a < 4; ++a) {
      const double u = 1 + SIGN[a][0] * corner[0] * at, v = 1 + SIGN[a][1] * corner[1] * at;
      shape[a] = u * v / 4;
      slope.row(a) << SIGN[a][0] * v / 4, SIGN[a][1] * u / 4;
    }
    Eigen::Matrix2d jacobian = Eigen::Matrix2d::Zero();
    double radius = 0;
    for (int a = 0; a < 4; ++a) {
      jacobian += mesh.rest[node[a]] * slope.row(a);
      radius += shape[a] * mesh.rest[node[a]].x();
    }
    const Eigen::Matrix<double, 4, 2> gradient = slope * jacobian.inverse();
    Point point{{node[0], node[1], node[2], node[3]}, {}, 2 * std::numbers::pi * radius * jacobian.determinant()};
    point.strain_of.setZero();
    for (int a = 0; a < 4; ++a) {
      point.strain_of.block<2, 1>(0, 2 * a) = point.strain_of.block<2, 1>(2, 2 * a + 1) = gradient.row(a).transpose();
      point.strain_of(4, 2 * a) = shape[a] / radius;
    }
    mesh.points.push_back(point);
  }
}

// A grid over the unit square whose lines max(r, z) = const become circles, crowded around the pole on z
Mesh make_mesh(double radius, int n) {
  Mesh mesh;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      const Vector2d square(std::pow(double(i) / n, GRADING), 1 - std::pow(1 - double(j) / n, GRADING));
      const double largest = square.maxCoeff();
      const Vector2d angle = square / (largest > 0 ? largest : 1) * (std::numbers::pi / 4);
      const Vector2d way = angle.array().tan().matrix();
      mesh.rest.push_back(largest > 0 ? Vector2d(radius * largest * way.normalized()) : Vector2d(0, 0));
    }
  const int row = n + 1;
  for (int i = 0; i <= n; ++i) {
    mesh.surface.push_back(i + row * n);
    mesh.axis.push_back(row * i);
    mesh.midplane.push_back(i);
  }
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const int a = i + row * j;
      add_points(mesh, {a, a + 1, a + 1 + row, a + row});
    }
  return mesh;
}

using Triplets = std::vector<Eigen::Triplet<double>>;

// Forces that hold the displacements u [N], and their derivative [N/m]
void assemble(const Mesh& mesh, const PressedSphere& sphere, const VectorXd& u, VectorXd& force, Triplets& stiffness) {
  const double mu = sphere.youngs_modulus / (2 * (1 + sphere.poisson_ratio));
  const double lambda = 2 * mu * sphere.poisson_ratio / (1 - 2 * sphere.poisson_ratio);
  const auto response = sphere.is_linear ? linear_response : neo_hookean_response;
  force.setZero(u.size());
  stiffness.clear();
  for (const Point& point : mesh.points) {
    const auto unknown = [&](int k) { return 2 * point.node[k / 2] + k % 2; };
    Eigen::Matrix<double, 8, 1> own;
    for (int k = 0; k < 8; ++k) own[k] = u[unknown(k)];
    const Response r = response(point.strain_of * own, mu, lambda);
    const Eigen::Matrix<double, 8, 1> f = point.volume * point.strain_of.transpose() * r.stress;
    const Eigen::Matrix<double, 8, 8> s = point.volume * point.strain_of.transpose() * r.tangent * point.strain_of;
    for (int i = 0; i < 8; ++i) {
      force[unknown(i)] += f[i];
      for (int j = 0; j < 8; ++j) stiffness.emplace_back(unknown(i), unknown(j), s(i, j));
    }
  }
}

// Where `change` is told (is_told), it holds; the rest of it makes the linearised force zero.
void solve(const Triplets& stiffness, const VectorXd& force, const std::vector<char>& is_told, VectorXd& change) {
  VectorXd right = -force;
  Triplets free;
  for (const auto& s : stiffness) {
    if (is_told[s.row()]) continue;
    if (is_told[s.col()])
      right[s.row()] -= s.value() * change[s.col()];
    else
      free.push_back(s);
  }
  for (Eigen::Index k = 0; k < right.size(); ++k)
    if (is_told[k]) free.emplace_back(k, k, 1), right[k] = change[k];
  Eigen::SparseMatrix<double> matrix(right.size(), right.size());
  matrix.setFromTriplets(free.begin(), free.end());
  change = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>(matrix).solve(right);
}

// Moves u to the equilibrium under a plane at `height`; returns the plane's force.
double press(const Mesh& mesh, const PressedSphere& sphere, double height, std::vector<char>& is_touching,
             VectorXd& u) {
  VectorXd force, change;
  Triplets stiffness;
  for (int iteration = 0; iteration < MOST_ITERATIONS; ++iteration) {
    assemble(mesh, sphere, u, force, stiffness);
    std::vector<char> is_told(std::size_t(u.size()), 0);
    for (const int node : mesh.axis) is_told[2 * node] = 1;
    for (const int node : mesh.midplane) is_told[2 * node + 1] = 1;
    change.setZero(u.size());
    bool has_changed = iteration == 0;
    double total = 0, error = 0;
    for (const int node : mesh.surface) {
      const double above = mesh.rest[node].y() + u[2 * node + 1] - height, pull = force[2 * node + 1];
      const bool touches = is_touching[node] ? iteration == 0 || pull <= 0 : above > LENGTH_TOLERANCE;
      has_changed |= touches != bool(is_touching[node]);
      is_touching[node] = touches;
      if (!touches) continue;
      is_told[2 * node + 1] = 1;
      change[2 * node + 1] = -above;
      total -= pull;
      error = std::max(error, std::abs(above) / LENGTH_TOLERANCE);
    }
    for (Eigen::Index k = 0; k < u.size(); ++k)
      if (!is_told[k]) error = std::max(error, std::abs(force[k]) / FORCE_TOLERANCE);
    if (!has_changed && error < 1) return total;
    solve(stiffness, force, is_told, change);
    u += change;
  }
  throw Failure("The finite elements of the pressed sphere did not converge; press it less, or in more cells.");
}

}  // namespace

double pressing_force(const PressedSphere& sphere, double indentation) {
  const Mesh mesh = make_mesh(sphere.radius, sphere.cells);
  VectorXd u = VectorXd::Zero(2 * Eigen::Index(mesh.rest.size()));
  std::vector<char> is_touching(mesh.rest.size(), 0);
  // finite strains: in parts of about the smallest cells' size, so that no cell is turned inside out on the way
  const int parts = sphere.is_linear ? 1 : 10 + int(indentation / (0.001 * sphere.radius));
  double force = 0;
  for (int part = 1; part <= parts; ++part)
    force = press(mesh, sphere, sphere.radius - indentation * part / parts, is_touching, u);
  return force;
}

}  // namespace pvg
