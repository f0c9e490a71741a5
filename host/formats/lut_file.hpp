// lut.csv: a header `input,red,green,blue` and 256 rows, linear values in [0, 1].
#pragma once
#include <filesystem>

#include "host/pictures/lut.hpp"

namespace pvg {

void write_lut(const std::filesystem::path& file, const Lut& lut);
// Refuses, with file and line, what is not 256 rows of four numbers in [0, 1] with rising inputs.
Lut read_lut(const std::filesystem::path& file);

}  // namespace pvg
