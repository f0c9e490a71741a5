// Models of several effects with one of them left out or replaced.
#pragma once
#include <vector>

#include "host/identify/fit/fit.hpp"

namespace pvg::diagnose {

Model without(const Model& model, std::size_t left_out);

// The model without each of its effects in turn, the last one too.
std::vector<Model> each_left_out(const Model& model);

// The model with the last part of another one at `place`.
Model replaced(const Model& model, std::size_t place, const Model& other);

// Likewise of the first `most` of `others` (best first) whose last part the model does not have.
std::vector<Model> swapped(const Model& model, std::size_t place, const std::vector<Fit>& others, std::size_t most);

// The model with the numbers that `other` has of the same parts, and, where it has others in their places, with numbers
// of the same name at the same target.
Model with_numbers_of(Model model, const Model& other);

// For each nuisance that went as far as it may: the model with the candidate for that number instead, which is free to
// go farther, as an effect.
std::vector<Model> with_wrong_numbers(const Model& model, const std::vector<Candidate>& candidates);

}  // namespace pvg::diagnose
