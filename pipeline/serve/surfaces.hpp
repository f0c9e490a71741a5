// Do surfaces of a simulated world intersect? By the exact test, apart from the solver that keeps them apart.
#pragma once
#include <cstdint>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "host/geometry/mesh.hpp"
#include "host/model/physical_scene.hpp"
#include "host/model/world_state.hpp"

namespace pvg {

class Surfaces {
 public:
  explicit Surfaces(const PhysicalScene& scene);
  // "beaker and finger_left", the first pair that meets; empty: none does. Half spaces are left out.
  std::string meeting(const WorldState& state) const;

 private:
  void add(const std::string& name, const std::vector<Triangle>& triangles, std::size_t n_points);

  struct Body {
    std::string name;
    std::vector<Vec3>
        rest;  // of a rigid body, in its frame [m]; its points are mapped, those of others are the state's
    bool is_rigid = false, goes_its_way = false;  // fixed or prescribed
  };
  std::vector<Body> bodies_;  // as ContactForce numbers them
  std::set<std::pair<std::size_t, std::size_t>> noncolliding_;
  std::vector<Edge> edges_;
  std::vector<Triangle> triangles_;
  std::vector<std::size_t> edge_body_, triangle_body_;
  std::size_t n_points_ = 0;
};

}  // namespace pvg
