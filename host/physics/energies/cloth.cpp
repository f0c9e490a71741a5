#include "host/physics/energies/cloth.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>

#include "host/base/error.hpp"

namespace pvg {
namespace {

using Vec2 = Eigen::Vector2d;
using Mat2 = Eigen::Matrix2d;

constexpr std::uint32_t NONE = ~std::uint32_t(0);
Vec3 normal(const Cloth& cloth, const Triangle& t) {  // twice the area long
  const std::vector<Vec3>& x = cloth.mesh.points;
  return (x[t[1]] - x[t[0]]).cross(x[t[2]] - x[t[0]]);
}

// Axes in the triangle's plane, rows along warp and weft.
Eigen::Matrix<double, 2, 3> fibre_frame(const Cloth& cloth, const Triangle& t) {
  const Vec3 n = normal(cloth, t).normalized(), warp = cloth.warp_direction - n * n.dot(cloth.warp_direction);
  if (!(warp.norm() > 1e-3 * cloth.warp_direction.norm()))
    throw UsageError("cloth " + cloth.name +
                     ": its warp direction stands at right angles to a triangle of its mesh; choose another direction");
  Eigen::Matrix<double, 2, 3> frame;
  frame.row(0) = warp.normalized();
  frame.row(1) = n.cross(warp.normalized());
  return frame;
}

// What lies across from each corner of a triangle; NONE on the boundary.
struct Neighbours {
  std::array<std::uint32_t, 3> triangle, apex;
};

std::vector<Neighbours> find_neighbours(const Cloth& cloth) {
  const std::vector<Triangle>& triangles = cloth.mesh.triangles;
  std::map<Edge, std::array<std::uint32_t, 2>> of_side;  // triangle and apex, by directed side
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    const Triangle& t = triangles[i];
    for (int k = 0; k < 3; ++k)
      if (!of_side.insert({{t[(k + 1) % 3], t[(k + 2) % 3]}, {i, t[k]}}).second)
        throw UsageError("cloth " + cloth.name + ": the edge of points " + std::to_string(t[(k + 1) % 3]) + " and " +
                         std::to_string(t[(k + 2) % 3]) +
                         " has more than two triangles, or two that run opposite ways; repair the mesh");
  }
  std::vector<Neighbours> neighbours;
  for (const Triangle& t : triangles) {
    Neighbours n{};
    for (int k = 0; k < 3; ++k) {
      const auto found = of_side.find({t[(k + 2) % 3], t[(k + 1) % 3]});
      n.triangle[k] = found == of_side.end() ? NONE : found->second[0];
      n.apex[k] = found == of_side.end() ? NONE : found->second[1];
    }
    neighbours.push_back(n);
  }
  return neighbours;
}

// K = A G^T D G, with G and D in triangle_bending.cl. area: of each triangle; across: of the triangle across from each
// corner, or -1. An edge of the boundary carries no moment: its angle is whatever costs least (a Schur complement).
Mat3 bending_stiffness(const Cloth& cloth, const Triangle& t, double area, const std::array<double, 3>& across) {
  const Eigen::Matrix<double, 2, 3> frame = fibre_frame(cloth, t);
  Mat3 curvature;  // G
  for (int k = 0; k < 3; ++k) {
    const Vec2 edge = frame * (cloth.mesh.points[t[(k + 2) % 3]] - cloth.mesh.points[t[(k + 1) % 3]]);
    const double length = edge.norm();
    const Vec2 m = Vec2(edge.y(), -edge.x()) / length;
    curvature.col(k) =
        length / (area + (across[k] < 0 ? area : across[k])) * Vec3(m.x() * m.x(), m.y() * m.y(), m.x() * m.y());
  }
  const ClothMaterial& material = cloth.material;
  const double twist = 2 * std::sqrt(material.bending_warp * material.bending_weft);
  const Vec3 rigidity(material.bending_warp, material.bending_weft, twist);
  Mat3 stiffness = area * curvature.transpose() * rigidity.asDiagonal() * curvature;
  for (int k = 0; k < 3; ++k) {
    if (across[k] >= 0) continue;
    const Vec3 column = stiffness.col(k);
    if (column[k] > 0) stiffness -= column * column.transpose() / column[k];
    stiffness.row(k).setZero();
    stiffness.col(k).setZero();
  }
  return stiffness;
}

// angle across the edge, positive where the apex lies on the side of the triangle's normal [rad]
double fold_angle(const Vec3& from, const Vec3& to, const Vec3& own_apex, const Vec3& apex) {
  const Vec3 edge = to - from, own = edge.cross(own_apex - from), other = (apex - from).cross(edge);
  return std::atan2(other.cross(own).dot(edge) / edge.norm(), own.dot(other));
}

}  // namespace

void check_cloth(const Cloth& cloth) {
  const ClothMaterial& m = cloth.material;
  const std::string name = "cloth " + cloth.name;
  if (!(m.area_density > 0) || !(m.thickness >= 0))
    throw UsageError(name + ": its area density must be positive and its thickness not negative");
  if (!(m.stretch_warp > 0) || !(m.stretch_weft > 0) || !(m.shear > 0))
    throw UsageError(name + ": its stretch and shear stiffnesses must be positive");
  if (!(m.poisson_ratio >= 0 && m.poisson_ratio < 1))
    throw UsageError(name + ": its Poisson's ratio must lie in [0, 1)");
  if (!(m.bending_warp >= 0) || !(m.bending_weft >= 0) || !(m.limit_strain >= 0) || !(m.stiffening >= 0))
    throw UsageError(name + ": its bending rigidities, limit strain and stiffening must not be negative");
  for (std::size_t i = 0; i < cloth.mesh.triangles.size(); ++i) {
    const Triangle& t = cloth.mesh.triangles[i];
    double longest = 0;
    for (int k = 0; k < 3; ++k)
      longest = std::max(longest, (cloth.mesh.points[t[k]] - cloth.mesh.points[t[(k + 1) % 3]]).norm());
    if (!(normal(cloth, t).norm() > 1e-9 * longest * longest))
      throw UsageError(name + ": triangle " + std::to_string(i) + " has no area; mesh the cloth again");
  }
}

std::vector<char> cloth_is_pinned(const Cloth& cloth) {
  std::vector<char> is_pinned(cloth.mesh.points.size(), false);
  for (const std::uint32_t point : cloth.pinned) {
    if (point >= is_pinned.size())
      throw UsageError("cloth " + cloth.name + ": point " + std::to_string(point) +
                       " is to be pinned, but its mesh has only " + std::to_string(is_pinned.size()));
    is_pinned[point] = true;
  }
  return is_pinned;
}

std::vector<double> cloth_node_masses(const Cloth& cloth) {
  std::vector<double> masses(cloth.mesh.points.size(), 0);
  for (const Triangle& t : cloth.mesh.triangles)
    for (const std::uint32_t node : t) masses[node] += cloth.material.area_density * normal(cloth, t).norm() / 6;
  for (std::size_t i = 0; i < masses.size(); ++i)
    if (!(masses[i] > 0))
      throw UsageError("cloth " + cloth.name + ": point " + std::to_string(i) +
                       " belongs to no triangle; remove it from the mesh");
  return masses;
}

std::vector<ClothMembrane> cloth_membrane_elements(const Cloth& cloth, u32 first_node) {
  const ClothMaterial& m = cloth.material;
  std::vector<ClothMembrane> elements;
  for (const Triangle& t : cloth.mesh.triangles) {
    const Eigen::Matrix<double, 2, 3> frame = fibre_frame(cloth, t);
    Mat2 shape;
    for (int k = 0; k < 2; ++k) shape.col(k) = frame * (cloth.mesh.points[t[k + 1]] - cloth.mesh.points[t[0]]);
    const Mat2 inverse = shape.inverse();
    ClothMembrane element{};
    for (int k = 0; k < 3; ++k) element.site[k] = first_node + t[k];
    for (int k = 0; k < 4; ++k) element.rest_inverse[k] = inverse(k / 2, k % 2);
    element.area = shape.determinant() / 2;
    const double contraction = 1 - m.poisson_ratio * m.poisson_ratio;  // what is stretched pulls across, too
    element.stretch_warp = m.stretch_warp / contraction;
    element.stretch_weft = m.stretch_weft / contraction;
    element.coupling = m.poisson_ratio * std::sqrt(m.stretch_warp * m.stretch_weft) / contraction;
    element.shear = m.shear;
    element.limit_strain = m.limit_strain;
    element.stiffening = m.stiffening;
    elements.push_back(element);
  }
  return elements;
}

std::vector<TriangleBending> triangle_bending_elements(const Cloth& cloth, u32 first_node) {
  const std::vector<Neighbours> neighbours = find_neighbours(cloth);
  const std::vector<Vec3>& x = cloth.mesh.points;
  const auto area = [&](std::uint32_t i) { return normal(cloth, cloth.mesh.triangles[i]).norm() / 2; };
  std::vector<TriangleBending> elements;
  for (std::uint32_t i = 0; i < neighbours.size(); ++i) {
    const Triangle& t = cloth.mesh.triangles[i];
    const Neighbours& n = neighbours[i];
    std::array<double, 3> across;
    for (int k = 0; k < 3; ++k) across[k] = n.triangle[k] == NONE ? -1 : area(n.triangle[k]);
    const Mat3 stiffness = bending_stiffness(cloth, t, area(i), across);
    if (!(stiffness.trace() > 0)) continue;
    TriangleBending element{};
    for (int k = 0; k < 3; ++k) {
      const bool is_boundary = n.apex[k] == NONE;
      element.site[k] = first_node + t[k];
      element.site[k + 3] = first_node + (is_boundary ? t[k] : n.apex[k]);
      if (!is_boundary && !cloth.rest_is_flat)
        element.rest_angle[k] = fold_angle(x[t[(k + 1) % 3]], x[t[(k + 2) % 3]], x[t[k]], x[n.apex[k]]);
    }
    for (int a = 0, e = 0; a < 3; ++a)
      for (int b = a; b < 3; ++b) element.stiffness[e++] = stiffness(a, b);
    elements.push_back(element);
  }
  return elements;
}

}  // namespace pvg
