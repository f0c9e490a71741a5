// Path-traced photos of boards and tags, whose truth is known.
#pragma once
#include "host/calibration/board.hpp"
#include "host/model/scene.hpp"

namespace pvg {

// A real camera: barrel distortion, a little blur from its aperture, shot noise.
Camera real_camera();

// optical frame at `eye` that looks at `at`, turned about its axis
Pose looking(const Vec3& eye, const Vec3& at, double roll);

// the board in the plane z = 0 with a white margin, seen from +z under an even sky
Scene board_scene(const Board& board);

// one photo from each pose
std::vector<Picture8> photos(Scene scene, const Camera& optics, const std::vector<Pose>& poses, int samples);

}  // namespace pvg
