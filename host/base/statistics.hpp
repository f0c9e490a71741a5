// Statistics of samples.
#pragma once
#include <cstddef>
#include <vector>

namespace pvg {

struct RateInterval {
  double low = 0, high = 1;
};
// Of a rate seen as `successes` in n trials, 95 %; 0 to 1 for no trial. Wilson 1927, "Probable inference, the law of
// succession, and statistical inference".
RateInterval wilson_interval(std::size_t successes, std::size_t n);

// The middle value, of an even number the mean of the two in the middle; of none, NaN.
double median(std::vector<double> values);

}  // namespace pvg
