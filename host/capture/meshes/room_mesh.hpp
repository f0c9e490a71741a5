// Rooms that another program reconstructed: meshes in metres with textures or colours of points.
#pragma once
#include "host/capture/room.hpp"

namespace pvg {

// A surface for each texture, and one for all that has none, with the colours of materials and points. glTF and GLB
// (z up; of trimesh, which Map-Anything writes by, colours of points are sRGB though glTF says linear), OBJ, STL and
// PLY (as they lie; without textures). UsageErrors name the file.
std::vector<CapturedSurface> read_room_mesh(const std::filesystem::path& file);

// up: of the ground's normal, roughly. Loose pieces go, triangles where settings.most_triangles is set; planes and
// frame as of a room from frames. UsageErrors where the lengths are no room's or nothing is left.
Room room_of_mesh(std::vector<CapturedSurface> surfaces, const RoomSettings& settings, const Vec3& up,
                  const std::function<void(const std::string&)>& say);

// Depths of a capture whose photos have none: what its mesh shows at each photo. The mesh may lie in the capture's
// frame or, as Map-Anything writes it, turned by 180 degrees about x: the way is taken in which the capture's points
// lie on it, and a UsageError says so where neither is.
void draw_depths(Device& device, Capture& capture);

}  // namespace pvg
