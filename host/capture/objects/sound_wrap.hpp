// A wrap that is sound and keeps a bound of its distance to the source: several are tried. Pure.
#pragma once
#include <string>

#include "host/capture/objects/wrap.hpp"

namespace pvg {

struct SoundWrap {
  TriangleMesh mesh;      // is_sound
  WrapSettings settings;  // of the attempt that it came from
  double distance = 0;    // of no point of it to the source is it more [m]; <= the bound
};

// Wraps with the given spacing and bridge [m, > 0], and where the result is not sound or farther than `bound` [m] from
// the source, with finer ones, three times. name: of the source, for messages. A UsageError where all sound ones were
// too far, a Failure where none was sound.
SoundWrap sound_wrap(const NearestTriangle& source, WrapSettings settings, double bound, const std::string& name);

}  // namespace pvg
