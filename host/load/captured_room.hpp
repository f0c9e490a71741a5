// A room that `capture room` wrote, as background of a scene: its surface is seen, its planes carry bodies.
#pragma once
#include "host/load/fields/fields.hpp"

namespace pvg {

struct CapturedBackground {
  std::filesystem::path room;  // room.yaml
  enum class Contact { planes, surface };
  Contact contact = Contact::planes;
  std::vector<std::string> planes;  // that carry bodies; empty: its ground
  double friction = 0.5;            // of what carries bodies
  BackgroundSection background;     // pose and shadow strength as of any other
};

// Keys of `background` with `capture`.
const Fields<CapturedBackground>& captured_background_fields();

// The background shows the room's surface; each plane that carries bodies becomes a fixed object that is not seen,
// named room_plane_N; or instead the room's solid does, named room_surface. Throws a UsageError naming file and key.
BackgroundSection add_captured_room(const CapturedBackground& captured, std::vector<ObjectSection>& objects);

}  // namespace pvg
