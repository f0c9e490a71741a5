// A number that two runs have in common if they go through the same states, bit by bit.
#pragma once
#include <cstdint>

#include "host/model/state.hpp"

namespace pvg {

// Over the bits of all positions of all states that were added, by the hash of Fowler, Noll and Vo (FNV-1a).
class StateHash {
 public:
  void add(const SceneState& state);
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 14695981039346656037ull;
};

}  // namespace pvg
