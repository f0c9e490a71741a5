// What training normalises by: least, most, mean, deviation and quantiles of each number of a feature.
#pragma once
#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <vector>

namespace pvg {

inline constexpr std::array<double, 5> QUANTILES = {0.01, 0.10, 0.50, 0.90, 0.99};
inline constexpr std::array<const char*, 5> QUANTILE_NAMES = {"q01", "q10", "q50", "q90", "q99"};

// Of one number.
struct NumberStats {
  double min = 0, max = 0, mean = 0, std = 0;
  std::array<double, 5> quantiles{};
};

// Quantiles between two values are linear, as numpy's. std: of all values, divided by their number.
NumberStats stats_of(std::vector<double> values);

// Pixels of many pictures, counted by channel and value.
class PixelCounts {
 public:
  void add(std::span<const std::uint8_t> rgb);
  void add(const PixelCounts& other);
  std::array<NumberStats, 3> stats() const;  // in [0, 1]; a quantile is the least value with so many at or below it

 private:
  std::array<std::array<std::uint64_t, 256>, 3> counts_{};
};

// {"min": [..], "max": .., "mean": .., "std": .., "count": [n], "q01": ..}: a list per name, and for the three channels
// of a picture lists of the shape (3, 1, 1). std is at least what `least_std` says, number by number: what never moves
// would otherwise be divided by nearly nothing.
nlohmann::ordered_json to_json(std::span<const NumberStats> stats, std::size_t count, bool is_picture,
                               std::span<const double> least_std);

}  // namespace pvg
