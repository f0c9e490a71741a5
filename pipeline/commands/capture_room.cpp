// phyvisgen capture room: a room from pictures of depth with poses.
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>

#include "host/base/atomic_files.hpp"
#include "host/base/counted.hpp"
#include "host/base/error.hpp"
#include "host/base/outputs.hpp"
#include "host/calibration/tag_frame.hpp"
#include "host/capture/meshes/room_mesh.hpp"
#include "host/capture/objects/room_solid.hpp"
#include "host/capture/room_files.hpp"
#include "pipeline/command_line/command.hpp"
#include "pipeline/commands/calibrate_pose.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;

struct CaptureRoomOptions {
  std::string source, output, tags;
  double voxel = 5, max_depth = 4, depth_unit = 0, memory = 2048;  // [mm, m, m, MiB]
  double noise = 1;                                                // factor of the Kinect's
  double least_piece = 0.02;                                       // [m^2]
  int hold_out = 0, ground = -1;
  std::size_t triangles = 0;
  double pose_sigma = 10;  // [mm]
  std::string align = "auto";
  bool refines_poses = false;
  bool keeps_frame = false, leaves_holes = false, has_texture = false, as_json = false;
  std::string device;
  double contact = 0, detail = 10;  // [m, mm]; contact 0: no solid
  double scale = 1;                 // of a mesh
  std::string up = "z";             // of a mesh
  CLI::App* command = nullptr;      // tells which options were given
};

double degrees(double radians) { return radians * 180 / M_PI; }

void print_planes(const Room& room) {
  if (!room.solid.triangles.empty())
    std::printf("surface.obj: %zu triangles, half of the surface within %.2f mm of it, 95 %% within %.2f mm\n",
                room.solid.triangles.size(), 1e3 * room.solid_distances[room.solid_distances.size() / 2],
                1e3 * room.solid_distances[room.solid_distances.size() * 95 / 100]);
  for (std::size_t i = 0; i < room.planes.size(); ++i) {
    const CapturedPlane& p = room.planes[i];
    const Vec3 c = p.pose.translation(), n = p.pose.linear().col(2);
    std::printf(
        "plane_%zu: %.2f x %.2f m at (%.2f, %.2f, %.2f), normal (%.2f, %.2f, %.2f), rough by %.1f mm, known to "
        "%.2f mm%s\n",
        i, p.width, p.height, c.x(), c.y(), c.z(), n.x(), n.y(), n.z(), 1e3 * p.roughness, 1e3 * p.height_sigma,
        int(i) != room.ground ? ""
        : room.is_placed      ? "; the ground"
                              : "; the ground, z = 0");
  }
}

void print_photos(const PhotoErrors& p) {
  const PhotoPlacement& placed = p.placement;
  std::printf(
      "left-out photos, moved by %.1f mm and %.2f degrees onto the surface on the mean, %.1f mm and %.2f degrees at "
      "most: PSNR %.2f dB, SSIM %.3f; with each photo's own table %.2f dB, %.3f (not moved: %.2f dB, %.3f); of the "
      "%.1f %% that the measured surface covers %.2f and %.2f dB; as diffuse surface %.2f dB, %.3f, with tables %.2f "
      "dB, %.3f; %.1f %% have nothing\n",
      1e3 * placed.mean_shift, degrees(placed.mean_turn), 1e3 * placed.largest_shift, degrees(placed.largest_turn),
      p.psnr, p.ssim, p.psnr_lut, p.ssim_lut, placed.psnr_lut, placed.ssim_lut, 100 * p.covered, p.psnr_covered,
      p.psnr_covered_lut, p.psnr_diffuse, p.ssim_diffuse, p.psnr_diffuse_lut, p.ssim_diffuse_lut, 100 - 100 * p.drawn);
}

void print_report(const Room& room, const fs::path& output, double seconds) {
  if (room.n_frames == 0) {
    std::printf("%s: %zu vertices, %zu triangles of a mesh in %.1f s\n", output.c_str(), room.mesh.points.size(),
                room.mesh.triangles.size(), seconds);
    print_planes(room);
    return;
  }
  std::printf(
      "%s: %zu vertices, %zu triangles of %s in %.1f s (%.0f ms per frame, %.0f ms of "
      "processor time, %zu MiB of voxels)\n",
      output.c_str(), room.mesh.points.size(), room.mesh.triangles.size(), counted(room.n_frames, "frame").c_str(),
      seconds, room.ms_per_frame, room.cpu_ms_per_frame, room.voxel_bytes >> 20);
  if (room.refinement) {
    const PoseRefinement& r = *room.refinement;
    std::printf(
        "poses moved by %.1f mm and %.2f degrees on the mean, %.1f mm and %.2f degrees at most, in %s (%.0f ms "
        "of "
        "processor time per frame); pictures are %.2f mm from what the others show, before %.2f mm\n",
        1e3 * r.mean_shift, degrees(r.mean_turn), 1e3 * r.largest_shift, degrees(r.largest_turn),
        counted(std::uint64_t(r.n_sweeps), "sweep").c_str(), r.cpu_ms_per_frame, 1e3 * r.distance_after,
        1e3 * r.distance_before);
    for (const UnrefinedFrame& f : r.unrefined)
      std::printf("%s keeps its pose: only %.1f %% of its pixels are near what other frames show\n", f.name.c_str(),
                  100 * f.share);
  }
  const DepthErrors& d = room.depth;
  std::printf(
      "depth of %zu %s frames: %.1f %% covered; off by %.1f mm in the median, %.1f mm at 90 %%, %.1f mm at 95 "
      "%%\n",
      d.n_frames, d.are_held_out ? "left-out" : "used", 100 * d.covered, 1e3 * d.median, 1e3 * d.p90, 1e3 * d.p95);
  if (room.depth_as_given)
    std::printf("with the given poses of these frames instead of registered ones: %.1f mm, %.1f mm, %.1f mm\n",
                1e3 * room.depth_as_given->median, 1e3 * room.depth_as_given->p90, 1e3 * room.depth_as_given->p95);
  if (room.photos) print_photos(*room.photos);
  print_planes(room);
}

RoomSettings settings_of(const CaptureRoomOptions& o, bool colors_are_apart) {
  RoomSettings settings;
  settings.fusion.voxel = o.voxel * 1e-3;
  settings.fusion.max_depth = o.max_depth;
  settings.fusion.max_bytes = std::size_t(o.memory) << 20;
  settings.fusion.noise.base *= o.noise;
  settings.fusion.noise.growth *= o.noise;
  settings.least_piece = o.least_piece;
  settings.hold_out = o.hold_out;
  settings.ground = o.ground;
  settings.most_triangles = o.triangles;
  settings.keeps_frame = o.keeps_frame;
  settings.guesses_background = !o.leaves_holes;
  settings.has_texture = o.has_texture;
  if (o.refines_poses) settings.refinement.emplace().sigma = o.pose_sigma * 1e-3;
  settings.aligns_colors = o.align == "yes" || (o.align == "auto" && colors_are_apart);
  return settings;
}

// The room's frame by tags in the photos, whose poses in the capture are known.
TagFrame frame_of_tags(const CaptureRoomOptions& o, const Capture& capture) {
  if (o.keeps_frame) throw UsageError("--tags and --keep-frame exclude each other");
  if (capture.colors_are_apart)
    throw UsageError("--tags needs photos that are registered to the depth pictures; those of " + capture.layout +
                     " are of another sensor, whose place beside the depth camera the files do not give");
  const std::vector<PlacedTag> tags = read_tags(o.tags);
  std::vector<TagPhoto> photos;
  for (const CaptureFrame& frame : capture.frames)
    if (!frame.color.empty()) photos.push_back({frame.name, frame.color_camera, find_tags_finely(color_of(frame))});
  if (photos.empty()) throw UsageError("--tags needs photos beside the depth pictures, and no frame has one");
  return locate_tags(photos, tags);
}

// What is read from the source, and the room that is made of it.
struct MadeRoom {
  Room room;
  RoomSettings settings;
  std::size_t peak_bytes = 0;  // of the device
};

void tell_step(const std::string& what) { std::fprintf(stderr, "  %s\n", what.c_str()); }

MadeRoom room_of_frames(const CaptureRoomOptions& o) {
  for (const char* of_meshes : {"--up", "--scale"})
    if (o.command->count(of_meshes) > 0) throw UsageError(std::string(of_meshes) + " is for a mesh, not for frames");
  Capture capture = read_capture(o.source, o.depth_unit);
  MadeRoom made{{}, settings_of(o, capture.colors_are_apart)};
  if (!o.tags.empty()) {
    const TagFrame frame = frame_of_tags(o, capture);
    made.settings.room_from_capture = frame.world_from_capture;
    std::fprintf(stderr, "%s in %s: corners are %.2f mm from their places, lengths %.2f %% off\n",
                 counted(frame.used.size(), "tag").c_str(), counted(frame.n_photos, "photo").c_str(),
                 1e3 * frame.residual, 100 * (1 / frame.scale - 1));
  }
  Device device(o.device, Purpose::rendering);
  std::fprintf(stderr, "%s: %s, layout of %s\n", o.source.c_str(), counted(capture.frames.size(), "frame").c_str(),
               capture.layout.c_str());
  if (!capture.mesh.empty()) {
    tell_step("no depth maps: depths are drawn of " + capture.mesh.filename().string());
    draw_depths(device, capture);
  }
  made.room = capture_room(device, capture, made.settings, tell_step);
  made.peak_bytes = device.peak_bytes();
  return made;
}

Vec3 axis_of(const std::string& name) {
  const double sign = name.front() == '-' ? -1 : 1;
  return sign * Vec3::Unit(name.back() - 'x');
}

MadeRoom room_of_mesh_file(const CaptureRoomOptions& o) {
  for (const char* of_frames : {"--max-depth", "--depth-unit", "--noise", "--memory", "--hold-out", "--tags",
                                "--texture", "--refine-poses", "--align-colors", "--leave-holes", "--device"})
    if (o.command->count(of_frames) > 0)
      throw UsageError(std::string(of_frames) + " is for frames, and " + o.source + " is a mesh");
  MadeRoom made{{}, settings_of(o, false)};
  std::vector<CapturedSurface> surfaces = read_room_mesh(o.source);
  for (CapturedSurface& surface : surfaces)
    for (Vec3f& p : surface.mesh.points) p *= float(o.scale);
  made.room = room_of_mesh(std::move(surfaces), made.settings, axis_of(o.up), tell_step);
  return made;
}

void run_capture_room(const CaptureRoomOptions& o) {
  if (o.source.empty() || o.output.empty())
    throw UsageError(
        "capture room needs a folder of frames or a mesh, and -o FOLDER; `phyvisgen capture room --help` shows an "
        "example");
  if (o.hold_out == 1) throw UsageError("--hold-out 1 leaves every frame out; take 2 or more");
  check_apart(o.output, o.source, "capture room");
  check_output_folder(o.output, {"room.glb", "room.yaml", "plane_*.obj", "surface.obj", "report.json", "poses.csv"},
                      "capture room");
  if (o.command->count("--detail") > 0 && o.contact == 0)
    throw UsageError("--detail is that of --contact, which is not given");
  const auto start = std::chrono::steady_clock::now();
  const bool is_mesh = fs::is_regular_file(o.source);
  MadeRoom made = is_mesh ? room_of_mesh_file(o) : room_of_frames(o);
  Room& room = made.room;
  if (o.contact > 0) {
    tell_step("making the surface solid");
    make_solid({o.contact, 1e-3 * o.detail}, room);
  }
  if (room.ground < 0 && !o.keeps_frame && !room.is_placed)
    std::fprintf(stderr, "phyvisgen: no plane faces up, so the room keeps the capture's frame; see --ground%s\n",
                 is_mesh ? " and --up" : "");
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const nlohmann::ordered_json report = room_report(room, made.settings, seconds, made.peak_bytes);
  PartialFolder folder(o.output);
  write_room(folder.path(), room, made.settings);
  write_text_atomically(folder.path() / "report.json", report.dump(2) + "\n");
  folder.finish();
  if (o.as_json)
    std::printf("%s\n", report.dump(2).c_str());
  else
    print_report(room, o.output, seconds);
}

}  // namespace

void add_capture_room(CLI::App& program) {
  CLI::App* command =
      command_group(program, "capture")
          .add_subcommand("room", "A metric room with its planes from depth pictures with poses, or a mesh");
  CaptureRoomOptions& o = options_of_command(*command, run_capture_room);
  o.command = command;
  command->add_option(
      "source", o.source,
      "Frames: 7-Scenes, TUM RGB-D, nerfstudio, COLMAP with depth maps or a mesh beside (Map-Anything); "
      "or a mesh in metres: .glb, .gltf, .ply, .obj");
  command->add_option("-o,--output", o.output,
                      "Folder to write: room.glb, room.yaml, plane_N.obj, report.json, poses.csv, surface.obj");
  command->add_option("--voxel", o.voxel, "Distance of samples [mm]")
      ->check(CLI::Range(0.2, 200.0))
      ->capture_default_str();
  command->add_option("--max-depth", o.max_depth, "Farther depths are left out [m]")
      ->check(CLI::Range(0.2, 100.0))
      ->capture_default_str();
  command->add_option("--depth-unit", o.depth_unit, "Metres per unit of the depth files; else the layout's")
      ->check(CLI::Range(1e-6, 10.0));
  command->add_option("--noise", o.noise, "Of the depth sensor, as a factor of the first Kinect's")
      ->check(CLI::Range(0.01, 100.0))
      ->capture_default_str();
  command->add_option("--memory", o.memory, "Most device memory for voxels [MiB]")
      ->check(CLI::Range(16.0, 1e6))
      ->capture_default_str();
  command->add_option("--least-piece", o.least_piece, "Smaller loose pieces are removed [m^2]")
      ->check(CLI::Range(0.0, 100.0))
      ->capture_default_str();
  command->add_option("--triangles", o.triangles, "Simplify to about so many");
  command->add_option("--hold-out", o.hold_out, "Leave every N-th frame out and measure the room by it")
      ->check(CLI::Range(0, 1000));
  command
      ->add_option(
          "--ground", o.ground,
          "Number of the plane that becomes z = 0 (with --tags: that bodies stand on); else the largest that faces up")
      ->check(CLI::Range(0, 100));
  command->add_option("--tags", o.tags,
                      "YAML: tags: [{id, size, position, rotation}], whose frame the room gets, z up");
  command
      ->add_option("--contact", o.contact,
                   "Make the surface within this distance of the origin a solid [m], for `contact: surface` of a task")
      ->check(CLI::Range(0.01, 100.0));
  command->add_option("--detail", o.detail, "Of that solid: finest detail [mm]")
      ->check(CLI::Range(0.1, 1000.0))
      ->capture_default_str();
  command->add_option("--up", o.up, "Of a mesh: the axis that points up, after glTF's y up became z up")
      ->check(CLI::IsMember({"x", "y", "z", "-x", "-y", "-z"}))
      ->capture_default_str();
  command->add_option("--scale", o.scale, "Of a mesh: metres per unit of the file")
      ->check(CLI::Range(1e-6, 1e6))
      ->capture_default_str();
  command->add_flag("--keep-frame", o.keeps_frame, "Keep the capture's frame instead of z up");
  command->add_flag("--leave-holes", o.leaves_holes, "Guess no background where photos look and no depth was measured");
  command->add_flag("--texture", o.has_texture,
                    "A texture cut from the sharpest photos, instead of colours of points, the means of all photos");
  CLI::Option* refines =
      command->add_flag("--refine-poses", o.refines_poses, "Move each depth picture onto what the others show");
  command
      ->add_option("--pose-sigma", o.pose_sigma,
                   "Standard deviation of the given poses [mm], as much at 1 m by rotation; for --refine-poses")
      ->check(CLI::Range(0.1, 200.0))
      ->capture_default_str()
      ->needs(refines);
  command->add_option("--align-colors", o.align, "Estimate the colour camera's place beside the depth camera")
      ->check(CLI::IsMember({"auto", "yes", "no"}))
      ->capture_default_str();
  command->add_option("--device", o.device, "OpenCL device: an index, part of its name, cpu or gpu");
  command->add_flag("--json", o.as_json, "Print the report as JSON");
  command->footer(
      "A task shows the room by `background: {capture: FOLDER}`.\n"
      "Examples:\n  phyvisgen capture room scans/kitchen -o room --hold-out 5\n"
      "  phyvisgen capture room scans/kitchen -o room --triangles 40000 --texture\n"
      "  phyvisgen capture room scans/kitchen -o room --contact 1 --detail 10\n"
      "  phyvisgen capture room kitchen.glb -o room --triangles 40000\n"
      "  phyvisgen capture room kitchen.ply -o room --up y --scale 0.001\n"
      "  phyvisgen capture room scans/kitchen -o room --refine-poses --pose-sigma 10\n"
      "  phyvisgen capture room scans/kitchen -o room --tags tags.yaml");
}

}  // namespace pvg
