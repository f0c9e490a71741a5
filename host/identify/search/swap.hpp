// Models of several effects with one of them left out or replaced.
#pragma once
#include <vector>

#include "host/identify/fit/fit.hpp"

namespace pvg::diagnose {

Model without(const Model& model, std::size_t left_out);

// The model with the last part of another one at `place`.
Model replaced(const Model& model, std::size_t place, const Model& other);

// Likewise of the first three of `others` (best first) whose last part the model does not have.
std::vector<Model> swapped(const Model& model, std::size_t place, const std::vector<Fit>& others);

}  // namespace pvg::diagnose
