// The baseline: the same rays on the same mesh through Embree 3, where CMake found it. Threads as given; each call
// traces all rays one by one (rtcIntersect1, rtcOccluded1).
#pragma once
#include <memory>
#include <vector>

#include "pipeline/bench/render_scenes.hpp"

namespace pvg {

class EmbreeRays {
 public:
  EmbreeRays(const VisualMesh& mesh, unsigned n_threads);
  ~EmbreeRays();
  // t and triangle of the closest hit, infinite where there is none
  struct Hit {
    float t;
    std::uint32_t triangle;
  };
  void closest(const BenchRays& rays, std::vector<Hit>& hits);
  // 1: something is met before t_max
  void any(const BenchRays& rays, float t_max, std::vector<std::uint8_t>& is_occluded);
  double build_seconds() const;  // of the commit, by its own threads [s]

  static bool is_there();  // else the constructor throws a logic_error

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace pvg
