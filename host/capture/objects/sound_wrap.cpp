#include "host/capture/objects/sound_wrap.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host/base/error.hpp"
#include "host/capture/objects/surface_distance.hpp"

namespace pvg {
namespace {

constexpr int ATTEMPTS = 4;     // each with other samples
constexpr double FINER = 0.93;  // spacing and bridge of the next attempt

}  // namespace

SoundWrap sound_wrap(const NearestTriangle& source, WrapSettings settings, double bound, const std::string& name) {
  double nearest = INFINITY;  // of the sound ones
  for (int attempt = 0; attempt < ATTEMPTS; ++attempt) {
    SoundWrap out{wrap_surface(source.mesh(), settings), settings, 0};
    if (is_sound(out.mesh)) {
      out.distance = surface_distances(out.mesh, source).back();
      if (out.distance <= bound) return out;
      nearest = std::min(nearest, out.distance);
    }
    // samples lie elsewhere, and a smaller ball may enter what it bridged
    settings.spacing *= FINER;
    settings.bridge *= FINER;
  }
  if (std::isinf(nearest)) throw Failure(name + ": no sound surface was found around it; take another --detail");
  throw UsageError(
      fmt::format("{}: a surface that closes its holes and clefts is {:.2f} mm away from it, more than the {:.2f} mm "
                  "of --bridge; take another --bridge: a smaller one leaves them open",
                  name, 1e3 * nearest, 1e3 * bound));
}

}  // namespace pvg
