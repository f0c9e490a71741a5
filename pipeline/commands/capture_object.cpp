// phyvisgen capture object: a mesh of any quality, splats, or depth pictures of a thing on a table become an object
// that can be simulated.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>

#include "host/base/atomic_files.hpp"
#include "host/base/counted.hpp"
#include "host/base/error.hpp"
#include "host/base/outputs.hpp"
#include "host/capture/meshes/room_mesh.hpp"
#include "host/capture/objects/lathe.hpp"
#include "host/capture/objects/mesh_pictures.hpp"
#include "host/capture/objects/object.hpp"
#include "host/capture/objects/object_parts.hpp"
#include "host/capture/objects/splats.hpp"
#include "host/capture/objects/standing_object.hpp"
#include "host/capture/objects/vessel.hpp"
#include "host/formats/picture_files.hpp"
#include "host/model/physical_scene.hpp"
#include "pipeline/command_line/command.hpp"

namespace pvg {
namespace {

struct CaptureObjectOptions {
  std::string source, output, device;
  std::string revolve, masks;                                                  // profile or masks, instead of a source
  double wall = 0;                                                             // [mm]
  double scale = 1, density = 0, mass = 0, detail = 0, bridge = 0, error = 0;  // [1, kg/m^3, kg, mm, mm, mm]
  std::size_t triangles = 2000;
  double voxel = 2, max_depth = 1.5, depth_unit = 0;  // of frames [mm, m, m]
  bool wraps = false, draws_meshes = false, as_json = false;
  bool is_soft = false, has_parts = false;
};

ObjectSource vessel_of(const CaptureObjectOptions& o) {
  std::vector<MaskedView> views = read_vessel_views(o.masks);  // before the device, whose start takes a while
  Device device(o.device, Purpose::rendering);
  const Vessel vessel = vessel_of_masks(device, std::move(views), o.scale);
  std::fprintf(stderr,
               "%s: a vessel at (%.4f, %.4f) m, %.1f mm high, its largest radius %.2f mm; outlines of %s off by "
               "%.2f pixels\n",
               o.masks.c_str(), vessel.axis.x(), vessel.axis.y(), 1e3 * vessel.height,
               1e3 * *std::max_element(vessel.radii.begin(), vessel.radii.end()),
               counted(vessel.residual_of_view.size(), "photo").c_str(), vessel.residual);
  return turned_object(o.masks, vessel.outside(), 1e-3 * o.wall);
}

ObjectSource source_of(const CaptureObjectOptions& o, const ObjectSettings& settings) {
  if (!o.masks.empty()) return vessel_of(o);
  if (!o.revolve.empty()) return read_lathe_object(o.revolve, 1e-3 * o.wall, o.scale);
  if (std::filesystem::is_directory(o.source)) {
    if (o.scale != 1) throw UsageError("--scale is for meshes and splats; the unit of depth pictures is --depth-unit");
    Capture capture = read_capture(o.source, o.depth_unit);
    Device device(o.device, Purpose::rendering);
    if (!capture.mesh.empty()) draw_depths(device, capture);
    StandingSettings standing;
    standing.voxel = 1e-3 * o.voxel;
    standing.max_depth = o.max_depth;
    std::fprintf(stderr, "%s: %s, layout of %s\n", o.source.c_str(), counted(capture.frames.size(), "frame").c_str(),
                 capture.layout.c_str());
    ObjectSource source = read_standing_object(
        device, capture, standing, [](const std::string& what) { std::fprintf(stderr, "  %s\n", what.c_str()); });
    source.name = o.source;
    return source;
  }
  if (!is_splat_file(o.source)) return read_object(o.source, settings);
  Device device(o.device, Purpose::rendering);
  return read_splat_object(device, o.source, settings);
}

// --parts
void capture_several(const CaptureObjectOptions& o, const ObjectSettings& settings) {
  if (o.source.empty() || o.is_soft || o.draws_meshes)
    throw UsageError("--parts goes with a glTF file, and not with --soft or --picture");
  const auto start = std::chrono::steady_clock::now();
  const std::vector<CapturedPart> parts = capture_parts(read_object_parts(o.source, settings), settings);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  PartialFolder folder(o.output);
  write_parts(folder.path(), parts, settings, seconds);
  folder.finish();
  if (o.as_json) {
    std::printf("%s\n", parts_report(parts, settings, seconds).dump(2).c_str());
    return;
  }
  for (const CapturedPart& part : parts)
    std::printf("%s: %zu triangles%s, %.4g kg\n", part.name.c_str(), part.object.simulation.triangles.size(),
                part.object.was_sound ? "; the source was sound" : "; wrapped around the source",
                part.object.mass.mass);
  std::printf("%s: %s that do not meet, in %.1f s\n", o.output.c_str(), counted(parts.size(), "part").c_str(), seconds);
}

void check_options(const CaptureObjectOptions& o) {
  const std::string& input = !o.revolve.empty() ? o.revolve : !o.masks.empty() ? o.masks : o.source;
  if (o.source.empty() + o.revolve.empty() + o.masks.empty() != 2 || o.output.empty())
    throw UsageError(
        "capture object needs one of a source (a mesh file or a folder of frames), --revolve PROFILE.csv and --masks "
        "FOLDER, and -o FOLDER; `phyvisgen capture object --help` shows an example");
  if (o.wall > 0 && !o.source.empty()) throw UsageError("--wall is for --revolve and --masks");
  check_apart(o.output, input, "capture object");
  check_output_folder(o.output,
                      {"simulation.obj", "visual.glb", "object.yaml", "report.json", "meshes.png", "thickness.png",
                       "tetrahedra.msh", "part_*.obj", "part_*.glb"},
                      "capture object");
}

ObjectSettings settings_of(const CaptureObjectOptions& o) {
  ObjectSettings settings;
  settings.scale = o.scale;
  settings.density = o.density;
  settings.mass = o.mass;
  settings.wrap.spacing = o.detail * 1e-3;
  settings.wrap.bridge = o.bridge * 1e-3;
  settings.error = o.error * 1e-3;
  settings.error_share = o.source.empty() ? 0.002 : 0.02;  // a profile is exact, and walls are thin
  settings.triangles = o.triangles;
  settings.always_wraps = o.wraps;
  settings.is_soft = o.is_soft;
  return settings;
}

void write_folder(const CaptureObjectOptions& o, const CapturedObject& object, const ObjectSettings& settings,
                  double seconds) {
  PartialFolder folder(o.output);
  write_object(folder.path(), object, settings, seconds);
  const std::filesystem::path picture = folder.path() / "meshes.png";
  const std::filesystem::path thickness = folder.path() / "thickness.png";
  std::filesystem::remove(picture);  // of an earlier run
  if (o.draws_meshes) {
    Device device(o.device, Purpose::rendering);
    write_picture(picture, picture_of_meshes(device, object.visual, object.simulation));
    write_picture(thickness, picture_of_thickness(device, object.visual, object.simulation,
                                                  ContactSettings{}.activation_distance));
  }
  folder.finish();
}

// What a user should know beside the first sentence.
void print_remarks(const CaptureObjectOptions& o, const CapturedObject& object, const nlohmann::ordered_json& report) {
  if (object.simulation.triangles.size() > o.triangles)
    std::printf(
        "not the %zu triangles that were asked for: fewer would cross each other, leave the surface by more than "
        "--error or, with --soft, be needles; give a larger --error or --detail\n",
        o.triangles);
  if (const double asked = o.bridge > 0 ? 1e-3 * o.bridge : object.bound; object.bridge > 0 && object.bridge < asked)
    std::printf("holes up to %.2f mm are closed, no larger ones: the surface across them would be too far away\n",
                2e3 * object.bridge);
  if (const auto& t = report["thickness"]; !t.is_null() && t["share_below"].get<double>() > 0)
    std::printf(
        "%.1f %% of its walls are thinner than %.3g mm, within which contact acts (the thinnest %.3g mm); if it is to "
        "be soft, give the task a smaller activation_distance\n",
        100 * t["share_below"].get<double>(), 1e3 * t["activation_distance"].get<double>(),
        1e3 * t["least"].get<double>());
  if (const auto& t = report["tetrahedra"]; !t.is_null())
    std::printf(
        "tetrahedra.msh: %zu tetrahedra, %zu nodes; the least dihedral angle is %.1f degrees, the largest ratio of "
        "radius to edge %.2f, %zu are slivers below 5 degrees\n",
        t["elements"].get<std::size_t>(), t["nodes"].get<std::size_t>(), t["least_dihedral_degrees"].get<double>(),
        t["largest_radius_edge"].get<double>(), t["slivers"].get<std::size_t>());
  if (o.density == 0 && o.mass == 0) std::printf("the mass is that of water: give --density or --mass\n");
}

void run_capture_object(const CaptureObjectOptions& o) {
  check_options(o);
  const auto start = std::chrono::steady_clock::now();
  const ObjectSettings settings = settings_of(o);
  if (o.has_parts) {
    capture_several(o, settings);
    return;
  }
  const CapturedObject object = capture_object(source_of(o, settings), settings);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  write_folder(o, object, settings, seconds);
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
  print_remarks(o, object, report);
}

}  // namespace

void add_capture_object(CLI::App& program) {
  CLI::App* command =
      command_group(program, "capture")
          .add_subcommand("object",
                          "A simulation mesh, a visual mesh and mass properties from any mesh or splats of a thing");
  CaptureObjectOptions& o = options_of_command(*command, run_capture_object);
  command->add_option(
      "source", o.source,
      "Mesh: .obj, .stl, .ply, .glb; holes and crossing triangles are no harm. Or Gaussian splats: .ply of 3DGS, "
      "PGSR, 2DGS, TSGS. Or a folder of depth pictures around a thing on a table, as of capture room");
  command->add_option("-o,--output", o.output, "Folder: simulation.obj, visual.glb, object.yaml, report.json");
  command->add_option(
      "--revolve", o.revolve,
      "Instead of a source: CSV with columns radius, height [m, times --scale], from the axis at the bottom "
      "along the outside to the rim (see --wall), or on along the inside to the axis");
  command->add_option("--masks", o.masks,
                      "Instead of a source: folder with nerfstudio's transforms.json whose frames have `mask_path`: a "
                      "vessel, turned about a vertical axis, on the table z = 0 (see --wall)");
  command
      ->add_option("--wall", o.wall,
                   "Of a profile that ends at the rim, and of --masks: thickness of wall and floor [mm]")
      ->check(CLI::Range(1e-3, 1e3));
  command->add_option("--scale", o.scale, "Metres per unit of the file, such as 0.001")
      ->check(CLI::Range(1e-6, 1e6))
      ->capture_default_str();
  command->add_option("--density", o.density, "[kg/m^3]; 1000 where neither it nor --mass is given")
      ->check(CLI::Range(1e-3, 1e5));
  command->add_option("--mass", o.mass, "[kg], instead of the density")->check(CLI::Range(1e-9, 1e6));
  command->add_option("--detail", o.detail, "Finest detail of the wrap [mm]; else a hundredth of the size")
      ->check(CLI::Range(1e-3, 1e4));
  command->add_option("--bridge", o.bridge, "Holes up to twice this are closed [mm]; else four details")
      ->check(CLI::Range(1e-3, 1e4));
  command->add_option("--error", o.error, "Most that simplification moves the surface [mm]; else two details")
      ->check(CLI::Range(1e-3, 1e4));
  command->add_option("--triangles", o.triangles, "Of the simulation mesh, where the error allows")
      ->check(CLI::Range(4, 100000000))  // the fewest are a tetrahedron's
      ->capture_default_str();
  command->add_flag("--wrap", o.wraps, "Wrap also a source that is closed and does not intersect itself");
  command->add_flag("--soft", o.is_soft,
                    "Also tetrahedra by TetGen: tetrahedra.msh, and object.yaml becomes a soft body of a scene");
  command->add_flag("--parts", o.has_parts,
                    "One part for each name of the nodes of a glTF file: part_NAME.obj, part_NAME.glb");
  command->add_option("--voxel", o.voxel, "Of a folder: distance of samples [mm]")
      ->check(CLI::Range(0.2, 50.0))
      ->capture_default_str();
  command->add_option("--max-depth", o.max_depth, "Of a folder: farther depths are left out [m]")
      ->check(CLI::Range(0.2, 100.0))
      ->capture_default_str();
  command
      ->add_option("--depth-unit", o.depth_unit, "Of a folder: metres per unit of the depth files; else the layout's")
      ->check(CLI::Range(1e-6, 10.0));
  command->add_option("--device", o.device,
                      "OpenCL device that fuses depth and draws splats: an index, part of its name, cpu or gpu");
  command->add_flag("--picture", o.draws_meshes,
                    "Draw both meshes side by side, meshes.png, and the thickness of the walls, thickness.png");
  command->add_flag("--json", o.as_json, "Print the report as JSON");
  command->footer(
      "Examples:\n  phyvisgen capture object scan.stl --scale 0.001 --density 1200 --picture -o can\n  phyvisgen "
      "capture object "
      "scans/can --mass 0.35 -o can\n  phyvisgen capture object --revolve glass.csv --scale 0.001 --wall 2 --density "
      "2500 -o glass\n  phyvisgen capture object --masks scans/glass --wall 2 --density 2500 -o glass\n"
      "  phyvisgen capture object pot_and_lid.glb --parts --mass 1.2 -o pot\n"
      "  phyvisgen capture object sponge.stl --scale 0.001 --soft --density 80 -o sponge");
}

}  // namespace pvg
