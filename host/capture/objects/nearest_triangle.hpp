// How far a point is from a surface: triangles in a tree of boxes. Pure.
#pragma once
#include "host/geometry/mesh.hpp"

namespace pvg {

class NearestTriangle {
 public:
  explicit NearestTriangle(const TriangleMesh& mesh);  // which must outlive it, and has a triangle
  double distance(const Vec3& p) const;                // [m]
  bool is_within(const Vec3& p, double most) const;    // distance(p) <= most, sooner
  const TriangleMesh& mesh() const { return *mesh_; }

 private:
  struct Node {
    Vec3 low, high;
    std::uint32_t first, count;  // of order_; count 0: its halves are nodes first and first + 1
  };
  void divide(std::size_t node, std::uint32_t first, std::uint32_t last);
  double nearest(const Vec3& p, double below, double enough) const;
  const TriangleMesh* mesh_;
  std::vector<std::uint32_t> order_;
  std::vector<Vec3> center_;
  std::vector<Node> nodes_;
};

}  // namespace pvg
