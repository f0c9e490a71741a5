// How far two pictures are apart. Both [height x width x 3], in [0, 1], of any coding. Pure.
#pragma once
#include <span>

namespace pvg {

// Peak signal-to-noise ratio, 10 log10(1 / mean square error) [dB]; equal pictures: infinity.
double psnr(std::span<const float> a, std::span<const float> b);

// Structural similarity of the luma (Wang et al. 2004): Gaussian window of 11 x 11 and sigma 1.5, K1 = 0.01, K2 = 0.03,
// mean over all windows that lie inside. Pictures smaller than a window: one window of all pixels.
double ssim(std::span<const float> a, std::span<const float> b, int width, int height);

}  // namespace pvg
