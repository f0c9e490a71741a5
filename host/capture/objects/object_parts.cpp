#include "host/capture/objects/object_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

#include "host/base/atomic_files.hpp"
#include "host/base/error.hpp"
#include "host/base/numbers.hpp"
#include "host/capture/room_files.hpp"
#include "host/formats/assimp_reader.hpp"
#include "host/formats/mesh_files.hpp"
#include "host/geometry/exact_intersection.hpp"
#include "host/geometry/mesh_checks.hpp"
#include "host/geometry/mesh_parts.hpp"
#include "host/load/gltf_scene.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;

constexpr int FINER_ATTEMPTS = 2;  // after the first

void append_mesh(const TriangleMesh& mesh, TriangleMesh& to) {
  const auto first = std::uint32_t(to.points.size());
  to.points.insert(to.points.end(), mesh.points.begin(), mesh.points.end());
  for (const Triangle& t : mesh.triangles) to.triangles.push_back({first + t[0], first + t[1], first + t[2]});
}

// the first two meshes that meet; what each does within itself does not count
std::optional<std::array<std::size_t, 2>> meeting_pair(const std::vector<const TriangleMesh*>& meshes) {
  TriangleMesh all;
  std::vector<std::uint32_t> group;
  for (std::uint32_t i = 0; i < meshes.size(); ++i) {
    append_mesh(*meshes[i], all);
    group.resize(all.triangles.size(), i);
  }
  const std::vector<std::uint8_t> no_self(meshes.size(), 0);
  const auto pair = find_intersection(all.points, all.triangles, group, no_self);
  if (!pair) return {};
  return std::array<std::size_t, 2>{group[pair->edge], group[pair->triangle]};
}

// the first two closed meshes that meet, or of which one lies in the other
std::optional<std::array<std::size_t, 2>> overlapping_pair(const std::vector<CapturedPart>& parts) {
  std::vector<const TriangleMesh*> meshes;
  for (const CapturedPart& part : parts) meshes.push_back(&part.object.simulation);
  if (const auto pair = meeting_pair(meshes)) return pair;
  for (std::size_t i = 0; i < meshes.size(); ++i)
    for (std::size_t k = i + 1; k < meshes.size(); ++k) {
      TriangleMesh both = *meshes[i];
      append_mesh(*meshes[k], both);
      if (has_overlapping_parts(both)) return std::array<std::size_t, 2>{i, k};
    }
  return {};
}

void halve(const NamedSource& part, ObjectSettings& settings) {
  if (settings.wrap.spacing <= 0) settings.wrap.spacing = size_of(part.source.mesh) / SAMPLES_ACROSS;
  settings.wrap.spacing /= 2;
  settings.wrap.bridge /= 2;
  settings.error /= 2;
}

}  // namespace

std::vector<NamedSource> read_object_parts(const fs::path& file, const ObjectSettings& settings) {
  if (const std::string ending = ending_of(file); ending != ".glb" && ending != ".gltf")
    throw UsageError("--parts needs a glTF file, whose nodes have names, and " + file.string() + " is none");
  const GltfScene scene = read_gltf_scene(file);
  std::vector<NamedSource> parts;
  for (const GltfPart& from : scene.parts) {
    if (!is_identifier(from.name))
      throw UsageError(file.string() + ": the name of a node " + IDENTIFIER_RULE + ", but is `" +
                       from.name.substr(0, 80) + "`; name the nodes that hold meshes after the parts");
    auto at = std::find_if(parts.begin(), parts.end(), [&](const NamedSource& p) { return p.name == from.name; });
    if (at == parts.end()) at = parts.insert(parts.end(), {from.name, {file.string() + ", " + from.name, {}, {}}});
    ObjectSource& source = at->source;
    const auto first = std::uint32_t(source.visual.points.size());
    for (const Vec3f& p : from.mesh.points) {
      source.visual.points.push_back(float(settings.scale) * p);
      source.mesh.points.push_back(settings.scale * p.cast<double>());
    }
    for (const Triangle& t : from.mesh.triangles) {
      source.visual.triangles.push_back({first + t[0], first + t[1], first + t[2]});
      source.mesh.triangles.push_back(source.visual.triangles.back());
    }
  }
  if (parts.size() < 2)
    throw UsageError(file.string() + ": all its meshes are of one node, `" + parts.front().name +
                     "`; leave --parts out, or name each part's node");
  for (NamedSource& part : parts) {
    Eigen::AlignedBox3d box;
    for (const Vec3& p : part.source.mesh.points) box.extend(p);
    part.source.mesh = weld_points(part.source.mesh, 1e-7 * box.diagonal().norm());
  }
  return parts;
}

std::vector<CapturedPart> capture_parts(const std::vector<NamedSource>& sources, const ObjectSettings& settings) {
  if (settings.density > 0 && settings.mass > 0) throw UsageError("--density and --mass exclude each other");
  std::vector<const TriangleMesh*> meshes;
  for (const NamedSource& part : sources) meshes.push_back(&part.source.mesh);
  if (const auto pair = meeting_pair(meshes))
    throw UsageError("the parts `" + sources[(*pair)[0]].name + "` and `" + sources[(*pair)[1]].name +
                     "` of the source touch or cross each other; leave a gap between them, or leave --parts out");
  std::vector<ObjectSettings> own(sources.size(), settings);
  for (ObjectSettings& s : own) s.mass = 0;  // shared out below
  std::vector<CapturedPart> parts;
  for (std::size_t i = 0; i < sources.size(); ++i)
    parts.push_back({sources[i].name, capture_object(sources[i].source, own[i])});
  auto pair = overlapping_pair(parts);
  for (std::vector<int> attempts(sources.size(), 0); pair; pair = overlapping_pair(parts))
    for (const std::size_t i : *pair) {
      if (++attempts[i] > FINER_ATTEMPTS)
        throw UsageError("the parts `" + parts[(*pair)[0]].name + "` and `" + parts[(*pair)[1]].name +
                         "` meet or lie in each other once they are closed surfaces; give a smaller --detail and "
                         "--error, or leave a wider gap between them");
      halve(sources[i], own[i]);
      parts[i].object = capture_object(sources[i].source, own[i]);
    }
  if (settings.mass > 0) {
    double volume = 0;
    for (const CapturedPart& part : parts) volume += part.object.mass.volume;
    for (CapturedPart& part : parts) {
      MassProperties& m = part.object.mass;
      const double mass = settings.mass * m.volume / volume;
      m.inertia *= mass / m.mass;
      m.mass = mass;
    }
  }
  return parts;
}

nlohmann::ordered_json parts_report(const std::vector<CapturedPart>& parts, const ObjectSettings& settings,
                                    double seconds) {
  nlohmann::ordered_json out = {{"schema", 1}, {"seconds", seconds}, {"parts", nlohmann::ordered_json::object()}};
  for (const CapturedPart& part : parts) out["parts"][part.name] = object_report(part.object, settings, seconds);
  return out;
}

void write_parts(const fs::path& folder, const std::vector<CapturedPart>& parts, const ObjectSettings& settings,
                 double seconds) {
  std::string objects = fmt::format(
      "# Entries of `objects` and `joints` of a task; paths are relative to this folder. The joints hold the parts "
      "together:\n"
      "# leave them out where parts are loose, or give a lid's or a door's another type{}.\nobjects:\n",
      settings.density <= 0 && settings.mass <= 0 ? "; masses are those of water" : "");
  std::string joints = "joints:\n";
  for (const CapturedPart& part : parts) {
    write_text_atomically(folder / ("part_" + part.name + ".obj"), obj_text(part.object.simulation));
    write_captured_mesh(folder / ("part_" + part.name + ".glb"), part.object.visual, part.name, false);
    objects += fmt::format(
        "  - name: {0}\n    mesh: part_{0}.obj\n    visuals: [{{mesh: part_{0}.glb}}]\n    mass: {1:.6g} kg\n    "
        "friction: 0.5    # "
        "not measured\n",
        part.name, part.object.mass.mass);
    if (&part != &parts.front())
      joints += fmt::format("  - {{name: {0}_to_{1}, type: fixed, parent: {1}, child: {0}}}\n", part.name,
                            parts.front().name);
  }
  write_text_atomically(folder / "object.yaml", objects + joints);
  write_text_atomically(folder / "report.json", parts_report(parts, settings, seconds).dump(2) + "\n");
}

}  // namespace pvg
