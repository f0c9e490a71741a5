// What a camera's sensor adds to the light: the lens' vignetting, the noise of electrons and of reading them out. Pure.
#pragma once
#include <cstdint>
#include <vector>

#include "host/model/scene.hpp"

namespace pvg {

// rgb: exposed linear values [height x width x 3]. Off where the camera does not ask for it. The noise depends on key
// and pixel alone: N electrons at value 1 make the standard deviation sqrt(N v + read_noise^2) / N of a value v.
void expose_sensor(const Camera& camera, std::uint32_t key, std::vector<float>& rgb);

}  // namespace pvg
