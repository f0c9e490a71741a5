#include "host/pictures/round_ticks.hpp"

#include <cmath>

namespace pvg {

std::vector<double> round_ticks(double low, double high, int n) {
  const double rough = (high - low) / n, power = std::pow(10, std::floor(std::log10(rough)));
  double step = 10 * power;
  for (const double factor : {5.0, 2.0, 1.0})
    if (factor * power >= rough) step = factor * power;
  std::vector<double> marks;
  for (double i = std::ceil(low / step); i * step <= high; ++i) marks.push_back(i * step + 0.0);  // + 0: no "-0"
  return marks;
}

}  // namespace pvg
