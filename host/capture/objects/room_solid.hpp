// The surface of a room as a body that others can lie on, instead of its planes. Pure.
#pragma once
#include "host/capture/room.hpp"

namespace pvg {

struct RoomSolidSettings {
  double reach = 1;               // what is farther from the room's origin is left out [m]
  double detail = 0.01;           // spacing of samples [m]
  std::size_t triangles = 20000;  // at most, where a quarter of the detail allows
};

// room.solid: a shell of 1.2 details below the surface: points are moved back by 0.6 details along their normals, the
// surface is wrapped (wrap.hpp) at that distance, so that its upper side is where the surface was, and edges collapse:
// closed, manifold and without self-intersections. UsageErrors where nothing is in reach, or where the room is closed
// all around.
void make_solid(const RoomSolidSettings& settings, Room& room);

}  // namespace pvg
