// What a controller commands in place of an effort: the current of a motor, the pressure in a cylinder. Both are the
// effort of a joint over a constant.
#pragma once
#include <vector>

#include "host/load/fields/yaml_section.hpp"
#include "host/load/recording/recording.hpp"

namespace pvg {

// Where the input's target is a joint's `current` or `pressure`, reads `constant`, effort per current or per pressure,
// and adds a column of efforts to each run: the input is then one of efforts, its target the joint's `torque`. Fails
// where the constant or the unit is none.
void make_effort(YamlSection& section, RecordedInput& input, std::vector<RecordedRun>& runs);

}  // namespace pvg
