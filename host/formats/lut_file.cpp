#include "host/formats/lut_file.hpp"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <string>

#include "host/base/atomic_files.hpp"
#include "host/base/error.hpp"

namespace pvg {

void write_lut(const std::filesystem::path& file, const Lut& lut) {
  std::string text = "input,red,green,blue\n";
  for (std::size_t i = 0; i < LUT_SIZE; ++i)
    text += fmt::format("{:.9g},{:.9g},{:.9g},{:.9g}\n", double(i) / (LUT_SIZE - 1), double(lut.value[i][0]),
                        double(lut.value[i][1]), double(lut.value[i][2]));
  write_text_atomically(file, text);
}

Lut read_lut(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in) throw UsageError(file.string() + ": there is no such lookup table");
  const auto fail = [&](std::size_t line, const std::string& what) {
    throw UsageError(file.string() + ":" + std::to_string(line) + ": " + what);
  };
  std::string line;
  if (!std::getline(in, line) || line.rfind("input,red,green,blue", 0) != 0)
    fail(1, "the header must be input,red,green,blue");
  Lut lut;
  for (std::size_t i = 0; i < LUT_SIZE; ++i) {
    double input = 0, value[3] = {};
    if (!std::getline(in, line)) fail(i + 2, "the table ends before its 256 rows");
    if (std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf", &input, &value[0], &value[1], &value[2]) != 4)
      fail(i + 2, "four numbers are needed");
    if (!(std::abs(input * (LUT_SIZE - 1) - double(i)) < 1e-3)) fail(i + 2, "the inputs must be 0, 1/255 ... 1");
    for (std::size_t c = 0; c < 3; ++c) {
      if (!(value[c] >= 0 && value[c] <= 1)) fail(i + 2, "a value is not in [0, 1]");
      lut.value[i][c] = float(value[c]);
    }
  }
  return lut;
}

}  // namespace pvg
