// A room of boxes seen by a Kinect, whose truth is known exactly.
#pragma once
#include <filesystem>
#include <random>

#include "host/formats/depth_files.hpp"
#include "host/model/appearance.hpp"

namespace pvg {

double distance_to_room(const Vec3& p);  // of a point from the nearest box [m]

// Axial noise of the first Kinect (Nguyen et al. 2012), whole millimetres, nothing nearer than 0.4 m or beyond 5 m.
DepthPicture with_kinect_noise(const DepthPicture& exact, std::mt19937& random);

// Brightness of a solid pattern of waves of 60 to 210 mm, by which photos tell a place on a wall.
float wave_pattern(const Vec3& p);

// Frames in the layout of 7-Scenes, poses in a frame that is turned and shifted against the room's. With the pattern on
// the colours of the boxes where asked for.
void write_frames(const std::filesystem::path& folder, int n, int width, int height, const Pose& from_room,
                  bool is_patterned = false);

Pose some_frame();

}  // namespace pvg
