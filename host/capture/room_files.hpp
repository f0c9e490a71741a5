// What `capture room` writes: room.glb (unlit, so that it is a shadow receiver), one box per plane as collision shape,
// room.yaml that a task's background names, report.json.
#pragma once
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>

#include "host/capture/room.hpp"

namespace pvg {

constexpr double PLANE_THICKNESS = 0.03;  // of a plane's box, behind its surface [m]

// Meshes with colours or texture as glTF, one node each; an empty one is left out. `is_unlit` makes them shadow
// receivers.
struct NamedMesh {
  std::string name;
  const VisualMesh* mesh;
  const Texture* texture = nullptr;
};
void write_captured_meshes(const std::filesystem::path& file, std::span<const NamedMesh> meshes, bool is_unlit);
void write_captured_mesh(const std::filesystem::path& file, const VisualMesh& mesh, const std::string& name,
                         bool is_unlit);

// The box of a plane, its upper side on the plane, closed and outward.
TriangleMesh plane_box(const CapturedPlane& plane);

void write_room(const std::filesystem::path& folder, const Room& room, const RoomSettings& settings);

// As docs/guide/capture.md describes.
nlohmann::ordered_json room_report(const Room& room, const RoomSettings& settings, double seconds,
                                   std::size_t peak_bytes);

}  // namespace pvg
