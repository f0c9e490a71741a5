// Do the surfaces of a recorded motion intersect? By the exact test, step by step, from the states file alone.
#pragma once
#include <filesystem>
#include <string>

namespace pvg {

struct IntersectedSteps {
  std::size_t steps = 0;        // that were looked at
  std::size_t intersected = 0;  // in which two surfaces meet that may not
  std::string first;            // the first of them in words; empty: none
};

// every: look at each `every`-th step and at the last.
IntersectedSteps count_intersected_steps(const std::filesystem::path& states, std::size_t every = 1);

}  // namespace pvg
