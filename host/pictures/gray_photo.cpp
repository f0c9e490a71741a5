#include "host/pictures/gray_photo.hpp"

#include <cmath>

namespace pvg {

bool GrayPhoto::at(double x, double y, double& v, Eigen::Vector2d& slope) const {
  const int i = int(std::floor(x)), j = int(std::floor(y));
  if (i < 0 || j < 0 || i + 1 >= width || j + 1 >= height) return false;
  const double f = x - i, g = y - j;
  const float* p = &value[std::size_t(j) * std::size_t(width) + std::size_t(i)];
  const double a = p[0], b = p[1], c = p[width], d = p[width + 1];
  v = (a * (1 - f) + b * f) * (1 - g) + (c * (1 - f) + d * f) * g;
  slope = {(b - a) * (1 - g) + (d - c) * g, (c - a) * (1 - f) + (d - b) * f};
  return true;
}

GrayPhoto gray_of(const Picture8& picture) {
  GrayPhoto gray{picture.width, picture.height, {}};
  for (std::size_t i = 0; i + 2 < picture.rgb.size(); i += 3)
    gray.value.push_back(float(0.299 * picture.rgb[i] + 0.587 * picture.rgb[i + 1] + 0.114 * picture.rgb[i + 2]) / 255);
  return gray;
}

void blur(GrayPhoto& photo, int rounds) {
  for (int k = 0; k < rounds; ++k)
    for (int axis = 0; axis < 2; ++axis) {
      std::vector<float> out(photo.value.size());
      const int step = axis == 0 ? 1 : photo.width;
      for (int y = 0; y < photo.height; ++y)
        for (int x = 0; x < photo.width; ++x) {
          const int at = y * photo.width + x, along = axis == 0 ? x : y,
                    last = (axis == 0 ? photo.width : photo.height) - 1;
          const float* v = photo.value.data();
          out[std::size_t(at)] =
              0.5f * v[at] + 0.25f * v[along > 0 ? at - step : at] + 0.25f * v[along < last ? at + step : at];
        }
      photo.value.swap(out);
    }
}

}  // namespace pvg
