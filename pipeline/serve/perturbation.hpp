// A task made other than those who control it know it, by the same amount in every episode: what success of a policy is
// looked at over (`phyvisgen serve --perturb friction=0.5`). What is drawn for an episode stays what it was.
#pragma once
#include <string>
#include <vector>

#include "host/model/task.hpp"

namespace pvg {

struct PerturbationKind {
  const char* name;
  const char* unit;     // of the amount; "" of factors
  const char* meaning;  // one line
  double low, high;     // bounds of the amount
  void (*apply)(Task& task, double amount);
};

const std::vector<PerturbationKind>& perturbation_kinds();

struct Perturbation {
  const PerturbationKind* kind = nullptr;
  double amount = 0;  // a factor, or in the kind's unit
};

// "NAME=NUMBER" as such. Throws a UsageError that says what may stand there.
Perturbation read_perturbation(const std::string& text);

// Changes the task. Throws a UsageError where it has nothing to change, such as a `light` without lights.
void perturb(Task& task, const Perturbation& perturbation);

}  // namespace pvg
