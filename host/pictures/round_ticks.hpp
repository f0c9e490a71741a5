// Where the axes of a plot have their marks.
#pragma once
#include <vector>

namespace pvg {

// Round numbers (1, 2 or 5 times a power of ten apart) within [low, high], about n of them; low < high.
std::vector<double> round_ticks(double low, double high, int n);

}  // namespace pvg
