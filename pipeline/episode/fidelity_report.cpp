// The report of evaluate fidelity: a page with table, curves, outlines and error maps, and the numbers as JSON.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "host/base/atomic_files.hpp"
#include "host/base/counted.hpp"
#include "host/base/outputs.hpp"
#include "host/pictures/comparison.hpp"
#include "host/pictures/round_ticks.hpp"
#include "pipeline/episode/fidelity.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// infinite numbers, such as the PSNR of equal pictures, become null
Json to_json(const MeanInterval& interval) {
  return {{"mean", interval.mean}, {"low", interval.low}, {"high", interval.high}};
}

// of `gripper`, else of the first part
const std::string* main_part(const Fidelity& fidelity) {
  if (fidelity.overlap.empty()) return nullptr;
  const auto gripper = fidelity.overlap.find("gripper");
  return gripper != fidelity.overlap.end() ? &gripper->first : &fidelity.overlap.begin()->first;
}

Json summary(const Fidelity& fidelity) {
  Json json;
  if (const std::string* part = main_part(fidelity)) {
    const MeanInterval& overlap = fidelity.overlap.at(*part);
    Json& mask = json["mask"] = {{"part", *part},
                                 {"miou", overlap.mean},
                                 {"low", overlap.low},
                                 {"high", overlap.high},
                                 {"frames", fidelity.n_masks.at(*part)}};
    for (const auto& [name, interval] : fidelity.overlap) {
      mask["parts"][name] = to_json(interval);
      mask["parts"][name]["frames"] = fidelity.n_masks.at(name);
    }
  }
  if (fidelity.psnr) {
    // no package registry holds the weights of lpips
    Json& picture = json["picture"] = {{"psnr", fidelity.psnr->mean},
                                       {"ssim", fidelity.ssim->mean},
                                       {"lpips", nullptr},
                                       {"frames", fidelity.n_pictures},
                                       {"psnr_interval", to_json(*fidelity.psnr)},
                                       {"ssim_interval", to_json(*fidelity.ssim)}};
    if (fidelity.lut_psnr) {
      picture["lut_psnr"] = to_json(*fidelity.lut_psnr);
      picture["lut_ssim"] = to_json(*fidelity.lut_ssim);
    }
  }
  return json;
}

Json full_json(const Fidelity& fidelity, const std::map<std::string, Fidelity>& baselines) {
  Json json = {{"schema", 1}};
  json.update(summary(fidelity));
  json["baselines"] = Json::object();
  for (const auto& [name, baseline] : baselines) json["baselines"][name] = summary(baseline);
  return json;
}

void add_frames(const Fidelity& fidelity, Json& json) {
  for (const FrameFidelity& frame : fidelity.frames) {
    Json entry = {{"frame", frame.frame}, {"iou", frame.overlap}};
    if (frame.psnr) entry["psnr"] = *frame.psnr, entry["ssim"] = *frame.ssim;
    if (frame.lut_psnr) entry["lut_psnr"] = *frame.lut_psnr, entry["lut_ssim"] = *frame.lut_ssim;
    json["frames"].push_back(std::move(entry));
  }
}

// ---- the page

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '&' ? "&amp;" : std::string(1, c);
  return out;
}

struct Curve {
  std::string name;
  std::vector<double> values;  // by frame; NaN: none
};

// values over the number of the frame
std::string plot(const std::string& title, const std::vector<Curve>& curves) {
  constexpr double WIDTH = 640, HEIGHT = 200, LEFT = 50, RIGHT = 120, TOP = 24, BOTTOM = 24;
  constexpr const char* COLORS[] = {"#1668a8", "#c2491d", "#4c8a2b", "#7a4fa3", "#8a6d1d"};
  double low = INFINITY, high = -INFINITY;
  std::size_t n = 0;
  for (const Curve& curve : curves) {
    n = std::max(n, curve.values.size());
    for (const double v : curve.values)
      if (std::isfinite(v)) low = std::min(low, v), high = std::max(high, v);
  }
  if (!(low <= high)) return "";
  if (low == high) low -= 0.5, high += 0.5;
  const double pad = 0.05 * (high - low);
  low -= pad, high += pad;
  const auto x = [&](std::size_t i) {
    return LEFT + (WIDTH - LEFT - RIGHT) * (n > 1 ? double(i) / double(n - 1) : 0.5);
  };
  const auto y = [&](double v) { return HEIGHT - BOTTOM - (HEIGHT - TOP - BOTTOM) * (v - low) / (high - low); };
  std::string svg =
      fmt::format("<svg viewBox='0 0 {} {}'><text x='{}' y='15'>{}</text>", WIDTH, HEIGHT, LEFT, escaped(title));
  for (const double v : round_ticks(low, high, 5))
    svg += fmt::format(
        "<line x1='{}' x2='{}' y1='{:.1f}' y2='{:.1f}' class='grid'/><text x='{}' y='{:.1f}' class='end'>{:g}</text>",
        LEFT, WIDTH - RIGHT, y(v), y(v), LEFT - 5, y(v) + 4, v);
  for (std::size_t k = 0; k < curves.size(); ++k) {
    const char* color = COLORS[k % std::size(COLORS)];
    std::string path;
    for (std::size_t i = 0; i < curves[k].values.size(); ++i)
      if (std::isfinite(curves[k].values[i]))
        path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? 'M' : 'L', x(i), y(curves[k].values[i]));
    svg += fmt::format("<path d='{}' fill='none' stroke='{}'/><text x='{}' y='{}' fill='{}'>{}</text>", path, color,
                       WIDTH - RIGHT + 8, TOP + 14 * double(k + 1), color, escaped(curves[k].name));
  }
  return svg + "</svg>\n";
}

template <class Number>
Curve curve(const std::string& name, const Fidelity& fidelity, const Number& number) {
  Curve c{name, {}};
  for (const FrameFidelity& frame : fidelity.frames) c.values.push_back(number(frame));
  return c;
}

std::string curves(const Fidelity& fidelity, const std::map<std::string, Fidelity>& baselines) {
  const auto of_part = [](const std::string& part) {
    return [part](const FrameFidelity& frame) {
      const auto found = frame.overlap.find(part);
      return found == frame.overlap.end() ? double(NAN) : found->second;
    };
  };
  std::string html;
  std::vector<Curve> overlaps;
  for (const auto& [part, interval] : fidelity.overlap) overlaps.push_back(curve(part, fidelity, of_part(part)));
  if (const std::string* part = main_part(fidelity))
    for (const auto& [name, baseline] : baselines) overlaps.push_back(curve(name, baseline, of_part(*part)));
  html += plot("IoU of masks, by frame", overlaps);
  const auto add = [&](const std::string& title, std::optional<double> FrameFidelity::*before,
                       std::optional<double> FrameFidelity::*after) {
    const auto number = [](std::optional<double> FrameFidelity::*member) {
      return [member](const FrameFidelity& frame) { return (frame.*member).value_or(NAN); };
    };
    std::vector<Curve> lines = {curve("simulated", fidelity, number(before))};
    if (fidelity.lut_psnr) lines.push_back(curve("with LUT", fidelity, number(after)));
    for (const auto& [name, baseline] : baselines) lines.push_back(curve(name, baseline, number(before)));
    html += plot(title, lines);
  };
  add("PSNR [dB], by frame", &FrameFidelity::psnr, &FrameFidelity::lut_psnr);
  add("SSIM, by frame", &FrameFidelity::ssim, &FrameFidelity::lut_ssim);
  return html;
}

std::string cells(const std::string& name, const std::string& what, const MeanInterval& interval, std::size_t n,
                  int digits) {
  return fmt::format("<tr><td>{}</td><td>{}</td><td>{:.{}f}</td><td>{:.{}f} to {:.{}f}</td><td>{}</td></tr>\n",
                     escaped(name), escaped(what), interval.mean, digits, interval.low, digits, interval.high, digits,
                     n);
}

std::string rows(const std::string& name, const Fidelity& fidelity) {
  std::string html;
  for (const auto& [part, interval] : fidelity.overlap)
    html += cells(name, "mean IoU, " + part, interval, fidelity.n_masks.at(part), 4);
  if (fidelity.psnr) html += cells(name, "PSNR [dB]", *fidelity.psnr, fidelity.n_pictures, 2);
  if (fidelity.ssim) html += cells(name, "SSIM", *fidelity.ssim, fidelity.n_pictures, 4);
  if (fidelity.lut_psnr) html += cells(name + " with LUT", "PSNR [dB]", *fidelity.lut_psnr, fidelity.n_pictures, 2);
  if (fidelity.lut_ssim) html += cells(name + " with LUT", "SSIM", *fidelity.lut_ssim, fidelity.n_pictures, 4);
  return html;
}

constexpr const char* HEAD = R"(<!doctype html><html lang='en'><meta charset='utf-8'><title>Fidelity</title><style>
body{font:15px/1.5 sans-serif;max-width:1000px;margin:2em auto;padding:0 1em;color:#222}
table{border-collapse:collapse}td,th{padding:.2em .8em;border-bottom:1px solid #ddd;text-align:left}
svg{width:100%;max-width:760px;font-size:11px}.grid{stroke:#ddd}.end{text-anchor:end}
.frames{display:grid;grid-template-columns:repeat(auto-fill,minmax(300px,1fr));gap:1em}img{width:100%}
figure{margin:0}figcaption{font-size:13px;color:#555}
</style><h1>Fidelity</h1>
)";

// outlines and error maps of one frame, as figures of the page
std::string frame_figures(const fs::path& folder, const SeenFolder& real, const SeenFolder& simulated,
                          const FrameFidelity& frame) {
  std::string html;
  const auto figure = [&](const std::string& file, const std::string& caption) {
    html += fmt::format("<figure><img src='{}' alt=''><figcaption>{}</figcaption></figure>\n", escaped(file),
                        escaped(caption));
  };
  const auto picture = real.pictures.find(frame.frame);
  for (const auto& [part, overlap] : frame.overlap) {
    const Mask8 &a = real.masks.at(part).at(frame.frame), &b = simulated.masks.at(part).at(frame.frame);
    Picture8 below{a.width, a.height, std::vector<std::uint8_t>(3 * a.pixels.size(), 60)};
    if (picture != real.pictures.end()) {
      Picture8 photo = read_picture(picture->second);
      if (photo.width == a.width && photo.height == a.height) below = std::move(photo);
    }
    const std::string file = "overlays/" + frame.frame + "_" + part + ".png";
    write_picture(folder / file, outline_overlay(below, a.pixels, b.pixels));
    figure(file, fmt::format("{}, {}: IoU {:.4f}", frame.frame, part, overlap));
  }
  if (frame.psnr) {
    const std::string file = "errors/" + frame.frame + ".png";
    write_picture(folder / file,
                  error_map(read_picture(picture->second), read_picture(simulated.pictures.at(frame.frame))));
    figure(file, fmt::format("{}, error: PSNR {:.2f} dB, SSIM {:.4f}", frame.frame, *frame.psnr, *frame.ssim));
  }
  return html;
}

}  // namespace

std::string fidelity_json(const Fidelity& fidelity, const std::map<std::string, Fidelity>& baselines) {
  return full_json(fidelity, baselines).dump(2) + "\n";
}

void write_fidelity_report(const fs::path& folder, const SeenFolder& real, const SeenFolder& simulated,
                           const Fidelity& fidelity, const std::map<std::string, Fidelity>& baselines,
                           std::size_t n_shown) {
  for (const fs::path& part : {folder, folder / "overlays", folder / "errors"}) make_writable_folder(part);
  std::string page = HEAD;
  page += fmt::format("<p>{} against {}: {}.</p>\n", escaped(simulated.folder.string()), escaped(real.folder.string()),
                      counted(fidelity.frames.size(), "frame"));
  page +=
      "<table><tr><th></th><th></th><th>mean</th><th>95 % interval over stretches of time</th><th>frames</th></tr>\n";
  page += rows("simulated", fidelity);
  for (const auto& [name, baseline] : baselines) page += rows(name, baseline);
  page += "</table>\n" + curves(fidelity, baselines);
  page +=
      "<p>Outlines: green real, magenta simulated, white both. Errors: mean absolute difference of the channels, black "
      "0, white from 0.25 on.</p><div class='frames'>\n";
  const std::size_t n = fidelity.frames.size(), shown = std::min(n, n_shown);
  for (std::size_t k = 0; k < shown; ++k)
    page += frame_figures(folder, real, simulated, fidelity.frames[k * n / shown]);
  page += "</div>\n";
  Json json = full_json(fidelity, baselines);
  add_frames(fidelity, json);
  write_text_atomically(folder / "report.json", json.dump(2) + "\n");
  write_text_atomically(folder / "index.html", page);
}

}  // namespace pvg
