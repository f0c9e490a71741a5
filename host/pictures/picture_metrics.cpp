#include "host/pictures/picture_metrics.hpp"

#include <cmath>
#include <limits>
#include <vector>

namespace pvg {
namespace {

constexpr int WINDOW = 11;
constexpr double SIGMA = 1.5, C1 = 0.01 * 0.01, C2 = 0.03 * 0.03;

std::vector<double> luma(std::span<const float> rgb) {
  std::vector<double> y(rgb.size() / 3);
  for (std::size_t i = 0; i < y.size(); ++i)
    y[i] = 0.299 * rgb[3 * i] + 0.587 * rgb[3 * i + 1] + 0.114 * rgb[3 * i + 2];
  return y;
}

// sums over all windows inside, weights along each axis
std::vector<double> filtered(const std::vector<double>& picture, int w, int h, const std::vector<double>& x_weight,
                             const std::vector<double>& y_weight) {
  const int nx = int(x_weight.size()), ny = int(y_weight.size()), out_w = w - nx + 1, out_h = h - ny + 1;
  std::vector<double> rows(std::size_t(out_w) * std::size_t(h)), out(std::size_t(out_w) * std::size_t(out_h));
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < out_w; ++x)
      for (int k = 0; k < nx; ++k)
        rows[std::size_t(y * out_w + x)] += x_weight[std::size_t(k)] * picture[std::size_t(y * w + x + k)];
  for (int y = 0; y < out_h; ++y)
    for (int x = 0; x < out_w; ++x)
      for (int k = 0; k < ny; ++k)
        out[std::size_t(y * out_w + x)] += y_weight[std::size_t(k)] * rows[std::size_t((y + k) * out_w + x)];
  return out;
}

std::vector<double> window(int n) {
  std::vector<double> weight(std::size_t(n < WINDOW ? n : WINDOW));
  double sum = 0;
  for (std::size_t i = 0; i < weight.size(); ++i) {
    const double d = (double(i) - 0.5 * double(weight.size() - 1)) / SIGMA;
    sum += weight[i] = std::exp(-0.5 * d * d);
  }
  for (double& x : weight) x /= sum;
  return weight;
}

}  // namespace

double psnr(std::span<const float> a, std::span<const float> b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (double(a[i]) - b[i]) * (double(a[i]) - b[i]);
  return sum > 0 ? 10 * std::log10(double(a.size()) / sum) : std::numeric_limits<double>::infinity();
}

double ssim(std::span<const float> a, std::span<const float> b, int width, int height) {
  const std::vector<double> x = luma(a), y = luma(b), wx = window(width), wy = window(height);
  const auto mean_of_product = [&](const std::vector<double>& p, const std::vector<double>& q) {
    std::vector<double> product(p.size());
    for (std::size_t i = 0; i < p.size(); ++i) product[i] = p[i] * q[i];
    return filtered(product, width, height, wx, wy);
  };
  const std::vector<double> mx = filtered(x, width, height, wx, wy), my = filtered(y, width, height, wx, wy),
                            xx = mean_of_product(x, x), yy = mean_of_product(y, y), xy = mean_of_product(x, y);
  double sum = 0;
  for (std::size_t i = 0; i < mx.size(); ++i) {
    const double m = mx[i] * my[i], m2 = mx[i] * mx[i] + my[i] * my[i];
    sum += (2 * m + C1) * (2 * (xy[i] - m) + C2) / ((m2 + C1) * (xx[i] + yy[i] - m2 + C2));
  }
  return sum / double(mx.size());
}

}  // namespace pvg
