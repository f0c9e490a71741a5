// phyvisgen capture object: a mesh of any quality becomes an object that can be simulated.
#include <chrono>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>

#include "host/base/atomic_files.hpp"
#include "host/base/error.hpp"
#include "host/base/outputs.hpp"
#include "host/capture/object.hpp"
#include "pipeline/command_line/command.hpp"

namespace pvg {
namespace {

struct CaptureObjectOptions {
  std::string source, output;
  double scale = 1, density = 0, mass = 0, detail = 0, bridge = 0, error = 0;  // [1, kg/m^3, kg, mm, mm, mm]
  std::size_t triangles = 2000;
  bool wraps = false, as_json = false;
};

void run_capture_object(const CaptureObjectOptions& o) {
  if (o.source.empty() || o.output.empty())
    throw UsageError(
        "capture object needs a mesh file and -o FOLDER; `phyvisgen capture object --help` shows an "
        "example");
  check_apart(o.output, o.source, "capture object");
  check_output_folder(o.output, {"simulation.obj", "visual.glb", "object.yaml", "report.json"}, "capture object");
  const auto start = std::chrono::steady_clock::now();
  ObjectSettings settings;
  settings.scale = o.scale;
  settings.density = o.density;
  settings.mass = o.mass;
  settings.wrap.spacing = o.detail * 1e-3;
  settings.wrap.bridge = o.bridge * 1e-3;
  settings.error = o.error * 1e-3;
  settings.triangles = o.triangles;
  settings.always_wraps = o.wraps;
  const CapturedObject object = capture_object(o.source, settings);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  PartialFolder folder(o.output);
  write_object(folder.path(), object, settings, seconds);
  folder.finish();
  const nlohmann::ordered_json report = object_report(object, settings, seconds);
  if (o.as_json) {
    std::printf("%s\n", report.dump(2).c_str());
    return;
  }
  const nlohmann::ordered_json& d = report["distance"];
  std::printf(
      "%s: %zu triangles, closed, without self-intersections%s, in %.1f s; off the source by %.2f mm on the mean, "
      "%.2f mm at most; %.4g kg\n",
      o.output.c_str(), object.simulation.triangles.size(),
      object.was_sound ? "; the source was sound" : "; wrapped around the source", seconds,
      1e3 * d["mean"].get<double>(), 1e3 * d["max"].get<double>(), object.mass.mass);
  if (object.simulation.triangles.size() > o.triangles)
    std::printf(
        "not the %zu triangles that were asked for: fewer would cross each other or leave the surface by more than "
        "--error; give a larger --error or --detail\n",
        o.triangles);
  if (o.density == 0 && o.mass == 0) std::printf("the mass is that of water: give --density or --mass\n");
}

}  // namespace

void add_capture_object(CLI::App& program) {
  CLI::App* command =
      command_group(program, "capture")
          .add_subcommand("object", "A simulation mesh, a visual mesh and mass properties from any mesh of a thing");
  CaptureObjectOptions& o = options_of_command(*command, run_capture_object);
  command->add_option("source", o.source, "Mesh: .obj, .stl, .ply, .glb; holes and crossing triangles are no harm");
  command->add_option("-o,--output", o.output, "Folder: simulation.obj, visual.glb, object.yaml, report.json");
  command->add_option("--scale", o.scale, "Metres per unit of the file, such as 0.001")->check(CLI::Range(1e-6, 1e6));
  command->add_option("--density", o.density, "[kg/m^3]")->check(CLI::Range(1e-3, 1e5));
  command->add_option("--mass", o.mass, "[kg], instead of the density")->check(CLI::Range(1e-9, 1e6));
  command->add_option("--detail", o.detail, "Finest detail of the wrap [mm]; else a hundredth of the size")
      ->check(CLI::Range(1e-3, 1e4));
  command->add_option("--bridge", o.bridge, "Holes up to twice this are closed [mm]; else four details")
      ->check(CLI::Range(1e-3, 1e4));
  command->add_option("--error", o.error, "Most that simplification moves the surface [mm]; else two details")
      ->check(CLI::Range(1e-3, 1e4));
  command->add_option("--triangles", o.triangles, "Of the simulation mesh, where the error allows");
  command->add_flag("--wrap", o.wraps, "Wrap also a source that is closed and does not intersect itself");
  command->add_flag("--json", o.as_json, "Print the report as JSON");
  command->footer("Example:\n  phyvisgen capture object scan.stl --scale 0.001 --density 1200 -o can");
}

}  // namespace pvg
