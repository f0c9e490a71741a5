// An object of several named parts, each with a mesh of its own, that do not intersect each other. Pure.
#pragma once
#include "host/capture/objects/object.hpp"

namespace pvg {

struct NamedSource {
  std::string name;  // of the node, an identifier
  ObjectSource source;
};

struct CapturedPart {
  std::string name;
  CapturedObject object;
};

// The meshes of a glTF file by the names of their nodes, in the order of the file; nodes of one name are one part.
// UsageErrors where a name is no identifier, and where there is one part alone.
std::vector<NamedSource> read_object_parts(const std::filesystem::path& file, const ObjectSettings& settings);

// capture_object of each; settings.mass is that of all together. Where parts meet though those of the source do not,
// their detail and error are halved, twice at most. A UsageError names parts of the source that meet, and those that
// still do.
std::vector<CapturedPart> capture_parts(const std::vector<NamedSource>& sources, const ObjectSettings& settings);

// part_NAME.obj and part_NAME.glb of each part, object.yaml with all of them and fixed joints between them, report.json
void write_parts(const std::filesystem::path& folder, const std::vector<CapturedPart>& parts,
                 const ObjectSettings& settings, double seconds);
nlohmann::ordered_json parts_report(const std::vector<CapturedPart>& parts, const ObjectSettings& settings,
                                    double seconds);

}  // namespace pvg
