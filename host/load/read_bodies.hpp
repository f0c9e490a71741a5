// The sections `bodies`, `joints` and `stitches` of a scene file. Internal to the loaders.
#pragma once
#include "host/load/fields/yaml_section.hpp"
#include "host/load/scene_file.hpp"

namespace pvg {

// Adds what `section` describes to file.added (and, of joints with a drive, to file.targets).
void read_body(YamlSection& section, SceneFile& file);
void read_joint(YamlSection& section, SceneFile& file);
void read_stitch(YamlSection& section, SceneFile& file);

}  // namespace pvg
