// From frames of depth and colour to a room: a coloured surface in metres, z up, with the planes that bodies can stand
// on, and how far all of it is from what was measured.
#pragma once
#include <functional>
#include <optional>

#include "host/capture/colors.hpp"
#include "host/capture/fusion.hpp"
#include "host/capture/planes.hpp"
#include "host/capture/pose_refinement.hpp"
#include "host/geometry/visual_mesh.hpp"

namespace pvg {

struct RoomSettings {
  FusionSettings fusion;
  PlaneSettings planes;
  std::optional<PoseRefinementSettings> refinement;  // none: poses are taken as they are
  double least_piece = 0.02;                         // smaller pieces are removed [m^2]
  std::size_t most_triangles = 0;                    // 0: as fused
  int hold_out = 0;                                  // every such frame is left out and measured; 0: none
  int ground = -1;                        // index of the plane that becomes z = 0; -1: the largest that faces up
  bool aligns_colors = false;             // the colour camera's place beside the depth camera is estimated
  bool keeps_frame = false;               // of the capture; else z up by the ground plane
  std::optional<Pose> room_from_capture;  // given, as by tags: neither of these two
  bool has_texture = false;               // else colours of points alone
  bool guesses_background = true;         // where photos look and no depth was measured
};

// Depths of left-out frames (of all, where none was left out) against the surface.
struct DepthErrors {
  std::size_t n_frames = 0, n_pixels = 0;
  bool are_held_out = false;
  double covered = 0;                                      // share of the measured pixels where the surface is
  double mean = 0, median = 0, p90 = 0, p95 = 0, max = 0;  // of the absolute differences [m]
};

// One of them, for whoever renders the room from the same place.
struct LeftOutPhoto {
  std::string file;                   // name of the photo in the capture's folder
  Camera camera;                      // in the room's frame
  double psnr_lut = 0, ssim_lut = 0;  // of the shadow receiver, after its own table
};

// How far left-out photos were moved onto the surface (photo_placement.cpp), and what the shadow receiver with a table
// of each photo is without that.
struct PhotoPlacement {
  double mean_shift = 0, largest_shift = 0;  // [m]
  double mean_turn = 0, largest_turn = 0;    // [rad]
  double psnr_lut = 0, ssim_lut = 0;         // of the cameras as the capture gives them [dB]
};

// Left-out photos against pictures of the surface as shadow receiver, in sRGB. Pixels where nothing is drawn are black
// in the pictures; `covered` figures are those of the measured surface alone, without the guessed background.
struct PhotoErrors {
  std::size_t n_frames = 0;
  std::vector<LeftOutPhoto> each;
  PhotoPlacement placement;                                 // of each; the cameras of `each` are where it put them
  double psnr = 0, ssim = 0, psnr_covered = 0;              // as rendered [dB]
  double psnr_lut = 0, ssim_lut = 0, psnr_covered_lut = 0;  // after a table that is fitted to each photo, its exposure
  double psnr_diffuse = 0, ssim_diffuse = 0;          // the same surfaces as diffuse, under an even sky that fits best
  double psnr_diffuse_lut = 0, ssim_diffuse_lut = 0;  // and after a table of each photo
  double covered = 0, drawn = 0;                      // share of the pixels: measured surface; with the background
};

struct Room {
  VisualMesh mesh;                      // in the room's frame, with colours where the capture has photos
  std::vector<CapturedSurface> looks;   // the same surface as it is seen, in pieces of one texture or none
  VisualMesh background;                // guessed, behind the measured surface; may be empty
  std::vector<Vec3f> gains;             // of the used photos, see exposure.hpp; empty without photos
  std::vector<CapturedPlane> planes;    // in the room's frame
  int ground = -1;                      // the plane that bodies stand on; -1: none was found
  TriangleMesh solid;                   // that bodies lie on, of objects/room_solid.hpp; may be empty
  std::vector<double> solid_distances;  // of the surface in its reach from it, ascending [m]
  bool is_placed = false;               // its frame was given; else z = 0 is the ground, or the frame the capture's
  Pose room_from_capture = Pose::Identity();
  std::optional<PoseRefinement> refinement;
  std::vector<std::string> frame_names;  // [n_frames] of the used frames
  std::optional<ColorOffset> color_offset;
  DepthErrors depth;
  std::optional<DepthErrors> depth_as_given;  // of left-out frames, where `depth` is after they were registered
  std::optional<PhotoErrors> photos;
  std::size_t n_frames = 0, n_blocks = 0, voxel_bytes = 0;
  double ms_per_frame = 0;                                // both passes of one picture, by the clock
  double cpu_ms_per_frame = 0;                            // of all the processor's cores together
  double share_colored = 0;                               // of the points that a photo sees
  std::size_t n_boundary_edges = 0, n_crowded_edges = 0;  // edges with one, with more than two triangles
};

// say: told of each step, for the user. UsageErrors name the frame.
Room capture_room(Device& device, const Capture& capture, const RoomSettings& settings,
                  const std::function<void(const std::string&)>& say);

// host/capture/room_frame.cpp
// Finds the planes of room.mesh, chooses the ground and moves the room's surfaces and planes into the room's frame: z
// up, z = 0 on the ground. up: roughly, in the capture's frame; eye: where the room was looked at from, x points away
// from it.
void place_room(const RoomSettings& settings, const Vec3& up, const Vec3& eye, Room& room);

// host/capture/held_out.cpp
DepthErrors measure_depth(Device& device, const Capture& capture, std::span<const CaptureFrame> frames,
                          const VisualMesh& mesh, double max_depth);
// The photos are placed on the surface first. surfaces: the measured one, then the guessed one
PhotoErrors measure_photos(Device& device, std::span<const CaptureFrame> held_out,
                           std::span<const CapturedSurface> surfaces);

}  // namespace pvg
