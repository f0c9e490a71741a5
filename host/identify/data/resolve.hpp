// What a recording names, found in its scene: channels and inputs. Whatever does not fit is a UsageError that names the
// file, the entry and what to do.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "host/identify/data/problem.hpp"
#include "host/load/fields/yaml_section.hpp"

namespace pvg::diagnose {

template <class List>
int index_named(const List& list, const std::string& name) {
  for (std::size_t i = 0; i < list.size(); ++i)
    if (list[i].name == name) return int(i);
  return -1;
}

bool has_coordinate(const Joint& joint);

// to SI; an empty unit is SI
double factor_of(const std::string& unit, Unit dimension, const std::string& place);

// joint/NAME/QUANTITY in three parts; names may hold slashes
std::array<std::string, 3> parts_of(const std::string& target, const std::string& place);

struct Resolved {
  Channel channel;
  double to_si = 1;
};
Resolved resolve_channel(const Problem& problem, std::size_t number);

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

// Also sets the drives' modes.
Inputs resolve_inputs(Problem& problem);

}  // namespace pvg::diagnose
