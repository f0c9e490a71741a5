// The planes of a room and the frame that they give it: z up, z = 0 on the ground.
#pragma once
#include "host/capture/room.hpp"

namespace pvg {

// Finds the planes of room.mesh, chooses the ground and moves the room's surfaces and planes into the room's frame.
// up: roughly, in the capture's frame; eye: where the room was looked at from, x points away from it.
void place_room(const RoomSettings& settings, const Vec3& up, const Vec3& eye, Room& room);

}  // namespace pvg
