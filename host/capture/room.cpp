#include "host/capture/room.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <map>

#include "host/base/counted.hpp"
#include "host/base/error.hpp"
#include "host/capture/background.hpp"
#include "host/capture/surface.hpp"
#include "host/capture/surface_views.hpp"
#include "host/capture/texture_atlas.hpp"

namespace pvg {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double BACKGROUND_TOLERANCE = 0.08;  // of depth at 1 m, from which a photo does not see it [m]
constexpr std::size_t MOST_MEASURED = 16;      // frames, where none was left out

FusedSurface fuse(Device& device, const Capture& capture, std::span<const CaptureFrame> frames,
                  const FusionSettings& settings, Room& room) {
  Box box;
  for (const CaptureFrame& frame : frames) {
    const DepthPicture picture = depth_of(capture, frame);
    check_depth_scale(capture, frame, picture);
    box.add(seen_box(frame.depth_camera, picture, settings.max_depth));
  }
  if (!(box.lo.x() <= box.hi.x())) throw UsageError("no frame shows a depth below --max-depth");
  Fusion fusion(device, settings, box);
  double seconds = 0, cpu_seconds = 0;
  const auto timed = [&](const CaptureFrame& frame, void (Fusion::*pass)(const Camera&, const DepthPicture&)) {
    const DepthPicture picture = depth_of(capture, frame);
    const auto start = Clock::now();
    const std::clock_t cpu_start = std::clock();
    (fusion.*pass)(frame.depth_camera, picture);
    seconds += std::chrono::duration<double>(Clock::now() - start).count();
    cpu_seconds += double(std::clock() - cpu_start) / CLOCKS_PER_SEC;
  };
  for (const CaptureFrame& frame : frames) timed(frame, &Fusion::mark);
  fusion.allocate();
  for (const CaptureFrame& frame : frames) timed(frame, &Fusion::integrate);
  room.ms_per_frame = 1e3 * seconds / double(frames.size());
  room.cpu_ms_per_frame = 1e3 * cpu_seconds / double(frames.size());
  room.n_blocks = fusion.n_blocks();
  room.voxel_bytes = fusion.voxel_bytes();
  return fusion.surface();
}

// the mean of where the cameras' upper edges point; hands and robots hold them upright more often than not
Vec3 upward(std::span<const CaptureFrame> frames) {
  Vec3 up = Vec3::Zero();
  for (const CaptureFrame& frame : frames) up -= frame.depth_camera.pose.linear().col(1);
  return up.normalized();
}

Vec3 mean_eye(std::span<const CaptureFrame> frames) {
  Vec3 eye = Vec3::Zero();
  for (const CaptureFrame& frame : frames) eye += frame.depth_camera.pose.translation() / double(frames.size());
  return eye;
}

void move(std::vector<CaptureFrame>& frames, const Pose& to_room) {
  for (CaptureFrame& frame : frames) {
    frame.depth_camera.pose = to_room * frame.depth_camera.pose;
    frame.color_camera.pose = to_room * frame.color_camera.pose;
  }
}

void simplify(const RoomSettings& settings, Room& room) {
  if (settings.most_triangles > 0 && room.mesh.triangles.size() > settings.most_triangles)
    room.mesh = simplified(room.mesh, settings.most_triangles, settings.fusion.voxel);
}

// Gains of the photos, then the colours of both surfaces, simplification, and the texture of what is left.
void color_room(Device& device, std::span<const CaptureFrame> frames, const RoomSettings& settings, Room& room) {
  std::vector<Camera> cameras;
  for (const CaptureFrame& frame : frames) cameras.push_back(frame.color_camera);
  const std::vector<VisualMesh> meshes = {room.mesh, room.background};
  SurfaceViews views(device, meshes, cameras);
  std::vector<DepthPicture> depths;
  for (std::size_t i = 0; i < frames.size(); ++i) depths.push_back(views.depth(i));
  const double tolerance = 3 * settings.fusion.voxel;
  const std::vector<Vec3f> normals = point_normals(room.mesh.points, room.mesh.triangles);
  room.gains = estimate_gains(device, {frames, depths, {}}, room.mesh.points, normals, tolerance);
  const Photos photos{frames, depths, room.gains};
  SurfaceColors colors = color_surface(device, photos, room.mesh.points, normals, room.mesh.triangles, tolerance);
  room.share_colored = double(colors.n_seen) / double(room.mesh.points.size());
  room.mesh.colors = std::move(colors.colors);
  simplify(settings, room);
  if (settings.has_texture) room.looks = {texture_surface(device, photos, room.mesh, tolerance)};
  if (room.background.triangles.empty()) return;
  room.background.colors = color_surface(device, photos, room.background.points,
                                         point_normals(room.background.points, room.background.triangles),
                                         room.background.triangles, std::max(tolerance, BACKGROUND_TOLERANCE))
                               .colors;
}

// Poses by depth, then by photos as well where these are registered to depth. Where the colour camera's place is only
// estimated, depth became worse by them.
void refine(Device& device, const Capture& capture, const RoomSettings& settings, bool has_photos,
            std::vector<CaptureFrame>& frames, Room& room) {
  std::vector<Pose> given;
  for (const CaptureFrame& frame : frames) given.push_back(frame.depth_camera.pose);
  room.refinement = refine_poses(device, capture, frames, settings.fusion, *settings.refinement);
  apply_poses(room.refinement->poses, frames);
  if (!has_photos || capture.colors_are_apart || settings.aligns_colors) return;
  refine_with_photos(device, capture, frames, given, settings.fusion, *settings.refinement, *room.refinement);
  apply_poses(room.refinement->poses, frames);
}

}  // namespace

Room capture_room(Device& device, const Capture& capture, const RoomSettings& settings,
                  const std::function<void(const std::string&)>& say) {
  std::vector<CaptureFrame> used, held_out;
  for (std::size_t i = 0; i < capture.frames.size(); ++i)
    (settings.hold_out > 0 && i % std::size_t(settings.hold_out) == std::size_t(settings.hold_out) / 2 ? held_out
                                                                                                       : used)
        .push_back(capture.frames[i]);
  if (used.empty()) throw UsageError("every frame is left out; give --hold-out 2 or more");
  const bool has_photos =
      std::any_of(used.begin(), used.end(), [](const CaptureFrame& frame) { return !frame.color.empty(); });
  if (settings.has_texture && !has_photos)
    throw UsageError("--texture needs photos beside the depth pictures, and no frame has one; leave it out");
  std::vector<CaptureFrame> as_given = held_out;
  Room room;
  room.n_frames = used.size();
  for (const CaptureFrame& frame : used) room.frame_names.push_back(frame.name);
  if (settings.refinement) {
    say("refining " + counted(used.size(), "pose"));
    refine(device, capture, settings, has_photos, used, room);
    register_frames(device, capture, used, held_out, settings.fusion, *settings.refinement);
  }
  say("fusing " + counted(used.size(), "picture") + " of depth");
  FusedSurface surface = without_unused(fuse(device, capture, used, settings.fusion, room));
  surface = without_small_pieces(surface, settings.least_piece);
  if (surface.triangles.empty())
    throw UsageError(
        "no surface was found: the pictures do not agree, or each piece is smaller than --least-piece; "
        "are the poses camera to world, in metres?");
  say(fmt::format("surface of {} triangles, {:.1f} m^2", surface.triangles.size(),
                  surface_area(surface.points, surface.triangles)));
  std::vector<Vec3f> normals = point_normals(surface.points, surface.triangles);
  room.mesh.points = surface.points;
  room.mesh.triangles = surface.triangles;
  if (has_photos && settings.aligns_colors) {
    say("aligning the colour camera");
    room.color_offset = align_color_camera(capture, used, surface.points, normals, settings.fusion.voxel);
    apply_color_offset(*room.color_offset, used, true);
    apply_color_offset(*room.color_offset, held_out, false);
  }
  if (has_photos && settings.guesses_background) {
    say("guessing what no depth shows");
    room.background = guess_background(device, capture, used, room.mesh, settings.fusion.max_depth);
  }
  if (has_photos) {
    say("colouring");
    color_room(device, used, settings, room);
  } else {
    simplify(settings, room);
  }
  if (room.looks.empty()) room.looks = {{room.mesh, {}}};
  say("finding planes");
  place_room(settings, upward(used), mean_eye(used), room);
  move(used, room.room_from_capture);
  move(held_out, room.room_from_capture);
  move(as_given, room.room_from_capture);
  const EdgeCounts edges = count_edges(room.mesh.triangles);
  room.n_boundary_edges = edges.boundary;
  room.n_crowded_edges = edges.crowded;
  say("measuring");
  std::span<const CaptureFrame> measured = held_out;
  if (measured.empty()) measured = std::span<const CaptureFrame>(used).first(std::min(used.size(), MOST_MEASURED));
  room.depth = measure_depth(device, capture, measured, room.mesh, settings.fusion.max_depth);
  room.depth.are_held_out = !held_out.empty();
  if (room.refinement && !held_out.empty())
    room.depth_as_given = measure_depth(device, capture, as_given, room.mesh, settings.fusion.max_depth);
  if (!held_out.empty() && !room.mesh.colors.empty()) {
    std::vector<CapturedSurface> surfaces = room.looks;
    surfaces.push_back({room.background, {}});
    room.photos = measure_photos(device, held_out, surfaces);
  }
  return room;
}

}  // namespace pvg
