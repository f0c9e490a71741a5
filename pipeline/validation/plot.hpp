// Curves over two axes as an SVG file.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace pvg {

struct Curve {
  std::string label;
  std::vector<double> x, y;
  bool is_reference = false;  // dashed: what is expected
};

struct Plot {
  std::string name, title;       // name: of the file
  std::string x_label, y_label;  // with units
  std::vector<Curve> curves;
  bool x_is_logarithmic = false, y_is_logarithmic = false;
};

// The drawing as text. Points that are not finite, or not positive on a logarithmic axis, are left out.
std::string svg_of(const Plot& plot);

}  // namespace pvg
