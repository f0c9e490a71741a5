// The section `shape` of a body of a scene file. Internal to the loaders.
#pragma once
#include "host/geometry/mesh.hpp"
#include "host/load/yaml_section.hpp"

namespace pvg {

// may_be_open: a body that never moves needs no inside
TriangleMesh read_surface_shape(YamlSection section, bool may_be_open);
TetMesh read_solid_shape(YamlSection section);
TriangleMesh read_sheet_shape(YamlSection section);  // of a cloth: open or closed

}  // namespace pvg
