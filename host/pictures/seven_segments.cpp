#include "host/pictures/seven_segments.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>

namespace pvg {
namespace {

// a rectangle in a place of 1 x 1, y down
struct Segment {
  char name;
  double x0, x1, y0, y1;
};

//  _a_
// f   b
//  -g-
// e   c
//  _d_ .
constexpr Segment SEGMENTS[] = {
    {'a', 0.21, 0.69, 0.14, 0.22}, {'b', 0.66, 0.76, 0.18, 0.47}, {'c', 0.66, 0.76, 0.53, 0.82},
    {'d', 0.21, 0.69, 0.78, 0.86}, {'e', 0.14, 0.24, 0.53, 0.82}, {'f', 0.14, 0.24, 0.18, 0.47},
    {'g', 0.21, 0.69, 0.46, 0.54}, {'.', 0.86, 0.96, 0.78, 0.86},
};
constexpr std::string_view LIT[10] = {"abcdef", "bc",     "abdeg", "abcdg",   "bcfg",
                                      "acdfg",  "acdefg", "abc",   "abcdefg", "abcdfg"};

std::string_view lit_by(char figure) {
  if (figure == '.') return ".";
  if (figure == '-') return "g";
  return figure >= '0' && figure <= '9' ? LIT[figure - '0'] : std::string_view();
}

void light(Texture& picture, const Segment& segment, double left, double width) {
  const auto column = [&](double x) { return std::clamp(int(std::lround(left + x * width)), 0, picture.width); };
  const auto row = [&](double y) { return int(std::lround(y * picture.height)); };
  for (int y = row(segment.y0); y < row(segment.y1); ++y)
    for (int x = column(segment.x0); x < column(segment.x1); ++x)
      std::fill_n(&picture.rgba[4 * (std::size_t(y) * std::size_t(picture.width) + std::size_t(x))], 3, 255);
}

}  // namespace

Texture seven_segments(const std::string& figures, int n_places, int width, int height) {
  Texture picture{width, height, {}};
  picture.rgba.assign(4 * std::size_t(width) * std::size_t(height), 0);
  for (std::size_t i = 3; i < picture.rgba.size(); i += 4) picture.rgba[i] = 255;
  const double place_width = double(width) / n_places;
  int place = n_places - int(figures.size()) + int(std::count(figures.begin(), figures.end(), '.'));
  for (const char figure : figures) {
    const int at = figure == '.' ? place - 1 : place++;  // a point shares the place of the digit before it
    for (const Segment& segment : SEGMENTS)
      if (lit_by(figure).find(segment.name) != std::string_view::npos)
        light(picture, segment, at * place_width, place_width);
  }
  return picture;
}

}  // namespace pvg
