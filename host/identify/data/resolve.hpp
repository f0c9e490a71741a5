// The inputs that a recording names, found in its scene. Whatever does not fit is a UsageError that names the file, the
// entry and what to do.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "host/identify/channels/resolve.hpp"
#include "host/identify/data/problem.hpp"

namespace pvg::diagnose {

// joint/NAME/QUANTITY in three parts; names may hold slashes
std::array<std::string, 3> parts_of(const std::string& target, const std::string& place);

struct JointInput {
  int joint = -1;
  std::string column;
  double to_si = 1;
};
struct BodyInput {
  int rigid = -1;
  std::vector<std::string> position, orientation;
  double to_si = 1;
};
struct Inputs {
  std::vector<JointInput> joints;
  std::vector<BodyInput> bodies;
};

// What a run states of its start. list: where, for messages.
std::vector<GivenStart> given_starts(const PhysicalScene& scene, const StatedNumbers& stated, const std::string& list);

// Also sets the drives' modes.
Inputs resolve_inputs(Problem& problem);

}  // namespace pvg::diagnose
