// phyvisgen calibrate camera: intrinsics and distortion from photos of a board.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "host/base/atomic_files.hpp"
#include "host/base/counted.hpp"
#include "host/base/error.hpp"
#include "host/base/outputs.hpp"
#include "host/calibration/calibration.hpp"
#include "host/formats/picture_files.hpp"
#include "pipeline/command_line/command.hpp"
#include "pipeline/validation/plot.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;

struct CalibrateCameraOptions {
  std::vector<std::string> photos;  // files or folders
  std::string output, board = "charuco,7x5,30,22", print, model = "pinhole";
  int distortion = 5;
  bool as_json = false;
};

std::vector<fs::path> photo_files(const std::vector<std::string>& given) {
  std::vector<fs::path> files;
  for (const std::string& name : given) {
    if (!fs::is_directory(name)) {
      files.push_back(name);
      continue;
    }
    const std::size_t first = files.size();
    for (const auto& entry : fs::directory_iterator(name)) {
      const std::string ending = entry.path().extension().string();
      if (ending == ".png" || ending == ".jpg" || ending == ".jpeg") files.push_back(entry.path());
    }
    std::sort(files.begin() + std::ptrdiff_t(first), files.end());
    if (files.size() == first) throw UsageError(name + " holds no photo (.png, .jpg)");
  }
  return files;
}

std::string listed(const std::vector<double>& values) {
  std::string text;
  for (const double v : values) text += fmt::format("{}{:.9g}", text.empty() ? "" : ", ", v);
  return "[" + text + "]";
}

std::vector<double> intrinsics_of(const Camera& c) { return {c.fx, c.fy, c.cx, c.cy}; }

std::string camera_yaml(const CameraCalibration& c, const Board& board) {
  std::string text =
      "# A camera as `phyvisgen calibrate camera` found it; OpenCV: pixel (0, 0) is the centre of the top left one.\n"
      "# A camera of a task takes it by `calibration: camera.yaml`.\nschema: 1\n";
  text +=
      fmt::format("model: {}\nwidth: {}\nheight: {}\n",
                  c.camera.model == Camera::Model::fisheye ? "fisheye" : "pinhole", c.camera.width, c.camera.height);
  text += "intrinsics: " + listed(intrinsics_of(c.camera)) + "   # fx, fy, cx, cy [pixels]\n";
  text += "distortion: " + listed(c.camera.distortion) + "\n";
  text += "sigma: " + listed(c.sigma) + "   # standard deviations of both, in this order\n";
  text += fmt::format("residual_px: {:.4g}\nboard: \"{}\"\n", c.residual, name_of(board));
  text += "photos:\n";
  for (const BoardPhoto& p : c.photos)
    text += fmt::format("  - {{file: \"{}\", residual_px: {:.4g}, used: {}}}\n", fs::path(p.file).filename().string(),
                        p.residual, p.is_used);
  return text;
}

nlohmann::ordered_json report(const CameraCalibration& c) {
  nlohmann::ordered_json photos = nlohmann::ordered_json::array();
  for (const BoardPhoto& p : c.photos) {
    photos.push_back({{"file", p.file}, {"residual_px", p.residual}, {"used", p.is_used}});
    if (!p.is_used) photos.back()["reason"] = p.reason;
  }
  return {{"schema", 1},
          {"model", c.camera.model == Camera::Model::fisheye ? "fisheye" : "pinhole"},
          {"width", c.camera.width},
          {"height", c.camera.height},
          {"intrinsics", intrinsics_of(c.camera)},
          {"distortion", c.camera.distortion},
          {"sigma", c.sigma},
          {"residual_px", c.residual},
          {"photos", photos}};
}

// the next 1, 2 or 5 times a power of ten below
double round_below(double value) {
  const double ten = std::pow(10, std::floor(std::log10(value)));
  return value >= 5 * ten ? 5 * ten : value >= 2 * ten ? 2 * ten : ten;
}

// What is left of all used photos' corners over the picture, long enough to be seen, and each photo's residual.
std::string residual_plots(const CameraCalibration& c) {
  constexpr double SHARE = 0.02;  // of the picture's width that the root mean square is drawn as
  const double longer = c.residual > 0 ? round_below(SHARE * c.camera.width / c.residual) : 1;
  Plot picture{
      "corners",
      fmt::format("residuals of corners, {:g} times as long; root mean square {:.3g} pixels", longer, c.residual),
      "x [pixels]",
      "y [pixels]",
      {}};
  picture.is_picture = true;
  Curve edge{"",
             {0, c.camera.width - 1.0, c.camera.width - 1.0, 0, 0},
             {0, 0, c.camera.height - 1.0, c.camera.height - 1.0, 0}};
  Curve corners, photos;
  corners.form = Curve::Form::arrows;
  photos.form = Curve::Form::bars;
  for (std::size_t i = 0; i < c.photos.size(); ++i) {
    const BoardPhoto& photo = c.photos[i];
    for (std::size_t k = 0; k < photo.differences.size(); ++k)
      for (const double length : {0.0, longer}) {
        corners.x.push_back(photo.corners[k].pixel.x() + length * photo.differences[k].x());
        corners.y.push_back(photo.corners[k].pixel.y() + length * photo.differences[k].y());
      }
    photos.x.push_back(double(i + 1));
    photos.y.push_back(photo.residual);
  }
  picture.curves = {edge, corners};
  const Plot bars{
      "photos", "residual of each photo", "photo, in the order of the file; none: left out", "pixels", {photos}};
  return svg_of(std::vector<Plot>{picture, bars});
}

void print(const CameraCalibration& c) {
  const auto sigma = [&](std::size_t i) { return i < c.sigma.size() ? fmt::format(" +- {:.3g}", c.sigma[i]) : ""; };
  const std::vector<double> k = intrinsics_of(c.camera);
  const char* names[] = {"fx", "fy", "cx", "cy"};
  for (std::size_t i = 0; i < 4; ++i) std::printf("%s %.3f%s\n", names[i], k[i], sigma(i).c_str());
  const bool is_fisheye = c.camera.model == Camera::Model::fisheye;
  const char* pinhole[] = {"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"};
  const char* fisheye[] = {"k1", "k2", "k3", "k4"};
  for (std::size_t i = 0; i < c.camera.distortion.size(); ++i)
    std::printf("%s %.5f%s\n", is_fisheye ? fisheye[i] : pinhole[i], c.camera.distortion[i], sigma(4 + i).c_str());
  std::size_t used = 0;
  for (const BoardPhoto& p : c.photos) {
    used += p.is_used;
    if (p.is_used)
      std::printf("  %s: %.3f pixels, %s\n", p.file.c_str(), p.residual, counted(p.corners.size(), "corner").c_str());
    else
      std::printf("  %s: left out, %s\n", p.file.c_str(), p.reason.c_str());
  }
  std::printf("residual %.3f pixels over %zu of %s\n", c.residual, used, counted(c.photos.size(), "photo").c_str());
}

// Where no photo shows the board, its mirror image may be there.
void refuse_mirrored_board(const std::vector<BoardPhoto>& photos, const Board& board, std::size_t fewest_corners) {
  const auto shows_board = [&](const BoardPhoto& photo) { return photo.corners.size() >= fewest_corners; };
  if (std::any_of(photos.begin(), photos.end(), shows_board)) return;
  for (const BoardPhoto& photo : photos)
    if (photo.is_used && find_mirrored_board(read_picture(photo.file), board).size() >= fewest_corners)
      throw UsageError("the board is mirrored in " + photo.file +
                       ": was it printed mirrored, or photographed from behind or in a mirror?");
}

void run_calibrate_camera(const CalibrateCameraOptions& o) {
  const Board board = parse_board(o.board);
  if (!o.print.empty()) {
    check_output_file(o.print, {".svg"}, "--print");
    write_board_svg(o.print, board);
    if (o.photos.empty()) return;
  }
  if (o.photos.empty() || o.output.empty())
    throw UsageError("calibrate camera needs photos and -o FILE.yaml, or --print BOARD.svg");
  check_output_file(o.output, {".yaml", ".yml"});
  int width = 0, height = 0;
  std::vector<BoardPhoto> photos;
  for (const fs::path& file : photo_files(o.photos)) {
    const Picture8 picture = read_picture(file);
    if (width == 0) {
      width = picture.width;
      height = picture.height;
    }
    BoardPhoto photo;
    photo.file = file.string();
    if (picture.width != width || picture.height != height) {
      photo.is_used = false;
      photo.reason = "it has another size than the first photo";
    } else {
      photo.corners = find_board(picture, board);
    }
    photos.push_back(std::move(photo));
  }
  CalibrationSettings settings;
  settings.model = o.model == "fisheye" ? Camera::Model::fisheye : Camera::Model::pinhole;
  settings.n_distortion = o.distortion;
  refuse_mirrored_board(photos, board, settings.fewest_corners);
  const CameraCalibration calibration = calibrate_camera(std::move(photos), width, height, settings);
  write_text_atomically(o.output, camera_yaml(calibration, board));
  write_text_atomically(fs::path(o.output).replace_extension(".svg"), residual_plots(calibration));
  if (o.as_json)
    std::printf("%s\n", report(calibration).dump(2).c_str());
  else
    print(calibration);
}

}  // namespace

void add_calibrate_camera(CLI::App& program) {
  CLI::App* command = command_group(program, "calibrate")
                          .add_subcommand("camera", "Intrinsics and distortion from photos of a printed board");
  CalibrateCameraOptions& o = options_of_command(*command, run_calibrate_camera);
  command->add_option("photos", o.photos, "Photos of the board from all sides, or folders of them");
  command->add_option("-o,--output", o.output,
                      "Camera file to write (.yaml); beside it a plot of the residuals (.svg)");
  command->add_option("--board", o.board, "KIND,COLUMNSxROWS,SQUARE[,TAG] in mm; KIND: charuco, chessboard or tags")
      ->capture_default_str();
  command->add_option("--print", o.print, "Write the board as SVG in true size");
  command->add_option("--model", o.model, "Of the lens")
      ->check(CLI::IsMember({"pinhole", "fisheye"}))
      ->capture_default_str();
  command->add_option("--distortion", o.distortion, "Numbers of OpenCV's distortion of a pinhole camera")
      ->check(CLI::IsMember({0, 4, 5, 8}))
      ->capture_default_str();
  command->add_flag("--json", o.as_json, "Print JSON");
  command->footer(
      "Examples:\n  phyvisgen calibrate camera --board charuco,7x5,30,22 --print board.svg\n"
      "  phyvisgen calibrate camera photos --board charuco,7x5,30,22 -o camera.yaml");
}

}  // namespace pvg
