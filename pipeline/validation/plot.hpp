// Curves over two axes as an SVG file.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace pvg {

struct Curve {
  enum class Form { line, arrows, bars };
  std::string label;  // empty: none is drawn
  std::vector<double> x, y;
  bool is_reference = false;  // dashed: what is expected
  Form form = Form::line;     // arrows: from each even point, a dot, to the next; bars: around x, from zero to y
};

struct Plot {
  std::string name, title;       // name: of the file
  std::string x_label, y_label;  // with units
  std::vector<Curve> curves;
  bool x_is_logarithmic = false, y_is_logarithmic = false;
  bool is_picture = false;  // y points down, and a unit is as long along x as along y
};

// The drawing as text. Points that are not finite, or not positive on a logarithmic axis, are left out.
std::string svg_of(const Plot& plot);
std::string svg_of(const std::vector<Plot>& plots);  // one below the other

}  // namespace pvg
