#include "pipeline/validation/plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/pictures/round_ticks.hpp"

namespace pvg {
namespace {

constexpr double PLOT_WIDTH = 720, HEIGHT = 450, LEFT = 90, RIGHT = 20, TOP = 40, BOTTOM = 60;  // [pixels]
constexpr const char* COLORS[] = {"#1f5fa8", "#c0392b", "#2e8b57", "#8e44ad", "#b9770e", "#117a8b", "#555555"};

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : std::string(1, c);
  return out;
}

// One axis: values to pixels.
struct Axis {
  bool is_logarithmic = false;
  double low = std::numeric_limits<double>::infinity(), high = -low;  // of the shown (logarithmic) values
  double begin = 0, end = 1;                                          // pixels

  bool can_show(double value) const { return std::isfinite(value) && (!is_logarithmic || value > 0); }
  double shown(double value) const { return is_logarithmic ? std::log10(value) : value; }
  void include(double value) {
    low = std::min(low, shown(value));
    high = std::max(high, shown(value));
  }
  void widen() {
    if (!(low <= high)) low = 0, high = 1;
    const double margin = high > low ? 0.05 * (high - low) : std::max(0.05 * std::abs(low), 1e-12);
    low -= margin;
    high += margin;
  }
  // about its middle to this many units per pixel
  void set_scale(double scale) {
    const double middle = 0.5 * (low + high), half = 0.5 * scale * std::abs(end - begin);
    low = middle - half;
    high = middle + half;
  }
  double scale() const { return (high - low) / std::abs(end - begin); }
  double pixel(double value) const { return begin + (shown(value) - low) / (high - low) * (end - begin); }

  std::vector<double> ticks() const {
    if (!is_logarithmic) return round_ticks(std::min(low, high), std::max(low, high), 6);
    std::vector<double> values;  // powers of ten
    for (const double t : round_ticks(low, high, std::max(1, int(std::min(6.0, high - low)))))
      if (t == std::round(t)) values.push_back(std::pow(10, t));
    return values;
  }
};

std::string text_at(double x, double y, const std::string& anchor, const std::string& text, const std::string& more) {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\"{}>{}</text>\n", x, y, anchor, more,
                     escaped(text));
}

std::string frame_of(const Plot& plot, const Axis& x, const Axis& y) {
  std::string out;
  for (const double value : x.ticks()) {
    const double at = x.pixel(value);
    out +=
        fmt::format("<line x1=\"{0:.1f}\" y1=\"{1}\" x2=\"{0:.1f}\" y2=\"{2}\" stroke=\"#ddd\"/>\n", at, TOP, y.begin);
    out += text_at(at, y.begin + 18, "middle", fmt::format("{:.6g}", value), "");
  }
  for (const double value : y.ticks()) {
    const double at = y.pixel(value);
    out +=
        fmt::format("<line x1=\"{1}\" y1=\"{0:.1f}\" x2=\"{2}\" y2=\"{0:.1f}\" stroke=\"#ddd\"/>\n", at, LEFT, x.end);
    out += text_at(LEFT - 6, at + 4, "end", fmt::format("{:.6g}", value), "");
  }
  out += fmt::format("<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"#333\"/>\n", LEFT, TOP,
                     x.end - LEFT, y.begin - TOP);
  out += text_at(PLOT_WIDTH / 2, 24, "middle", plot.title, " font-size=\"15\"");
  out += text_at((LEFT + x.end) / 2, HEIGHT - 16, "middle", plot.x_label, "");
  const double middle = (TOP + y.begin) / 2;
  return out + text_at(20, middle, "middle", plot.y_label, fmt::format(" transform=\"rotate(-90 20 {})\"", middle));
}

std::string arrows_of(const Curve& curve, const char* color, const Axis& x, const Axis& y) {
  std::string out;
  for (std::size_t i = 0; i + 1 < std::min(curve.x.size(), curve.y.size()); i += 2)
    out += fmt::format(
        "<path d=\"M {0:.2f} {1:.2f} L {2:.2f} {3:.2f}\" stroke=\"{4}\"/><circle cx=\"{0:.2f}\" cy=\"{1:.2f}\" "
        "r=\"1.2\" fill=\"{4}\"/>\n",
        x.pixel(curve.x[i]), y.pixel(curve.y[i]), x.pixel(curve.x[i + 1]), y.pixel(curve.y[i + 1]), color);
  return out;
}

std::string bars_of(const Curve& curve, const char* color, const Axis& x, const Axis& y) {
  std::string out;
  for (std::size_t i = 0; i < std::min(curve.x.size(), curve.y.size()); ++i) {
    const double left = x.pixel(curve.x[i] - 0.4), right = x.pixel(curve.x[i] + 0.4);
    const double top = std::min(y.pixel(curve.y[i]), y.pixel(0)), bottom = std::max(y.pixel(curve.y[i]), y.pixel(0));
    out += fmt::format("<rect x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\" fill=\"{}\"/>\n", left, top,
                       right - left, bottom - top, color);
  }
  return out;
}

std::string line_of(const Curve& curve, const char* color, const std::string& dash, const Axis& x, const Axis& y) {
  std::string points;
  for (std::size_t i = 0; i < std::min(curve.x.size(), curve.y.size()); ++i)
    if (x.can_show(curve.x[i]) && y.can_show(curve.y[i]))
      points += fmt::format("{:.2f},{:.2f} ", x.pixel(curve.x[i]), y.pixel(curve.y[i]));
  return fmt::format("<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.6\"{}/>\n", points, color,
                     dash);
}

std::string curve_of(const Curve& curve, std::size_t number, const Axis& x, const Axis& y) {
  const char* color = COLORS[number % std::size(COLORS)];
  const std::string dash = curve.is_reference ? " stroke-dasharray=\"6 4\"" : "";
  std::string out = curve.form == Curve::Form::arrows ? arrows_of(curve, color, x, y)
                    : curve.form == Curve::Form::bars ? bars_of(curve, color, x, y)
                                                      : line_of(curve, color, dash, x, y);
  if (curve.label.empty()) return out;
  const double at = TOP + 16 + 16 * double(number);
  out += fmt::format("<line x1=\"{}\" y1=\"{}\" x2=\"{}\" y2=\"{}\" stroke=\"{}\" stroke-width=\"2\"{}/>\n", LEFT + 10,
                     at - 4, LEFT + 34, at - 4, color, dash);
  return out + text_at(LEFT + 40, at, "start", curve.label, "");
}

}  // namespace

std::string svg_of(const Plot& plot) {
  Axis x{plot.x_is_logarithmic}, y{plot.y_is_logarithmic};
  x.begin = LEFT, x.end = PLOT_WIDTH - RIGHT;
  y.begin = HEIGHT - BOTTOM, y.end = TOP;  // upward
  for (const Curve& curve : plot.curves)
    for (std::size_t i = 0; i < std::min(curve.x.size(), curve.y.size()); ++i)
      if (x.can_show(curve.x[i]) && y.can_show(curve.y[i])) {
        const bool is_bar = curve.form == Curve::Form::bars;
        for (const double aside : {-0.5, 0.5}) x.include(curve.x[i] + (is_bar ? aside : 0));
        y.include(curve.y[i]);
        if (is_bar) y.include(0);
      }
  x.widen();
  y.widen();
  if (plot.is_picture) {
    const double scale = std::max(x.scale(), y.scale());
    x.set_scale(scale);
    y.set_scale(scale);
    std::swap(y.low, y.high);
  }
  std::string out = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\" "
      "font-family=\"sans-serif\" font-size=\"12\">\n<rect width=\"{0}\" height=\"{1}\" fill=\"white\"/>\n",
      PLOT_WIDTH, HEIGHT);
  out += frame_of(plot, x, y);
  for (std::size_t i = 0; i < plot.curves.size(); ++i) out += curve_of(plot.curves[i], i, x, y);
  return out + "</svg>\n";
}

std::string svg_of(const std::vector<Plot>& plots) {
  std::string out =
      fmt::format("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\">\n",
                  PLOT_WIDTH, HEIGHT * double(plots.size()));
  for (std::size_t i = 0; i < plots.size(); ++i)
    out += fmt::format("<g transform=\"translate(0 {})\">\n{}</g>\n", HEIGHT * double(i), svg_of(plots[i]));
  return out + "</svg>\n";
}

}  // namespace pvg
