// Path-traced photos of boards and tags, whose truth is known.
#pragma once
#include "host/calibration/board.hpp"
#include "host/calibration/calibration.hpp"
#include "host/model/scene.hpp"

namespace pvg {

// A real camera: barrel distortion, a little blur from its aperture, shot noise.
Camera real_camera();

// optical frame at `eye` that looks at `at`, turned about its axis
Pose looking(const Vec3& eye, const Vec3& at, double roll);

// that look at the middle of a board of 220 x 160 mm from all sides, tilted by up to 45 degrees, 0.25 to 0.31 m away
std::vector<Pose> poses_around_board(int n);

// the board in the plane z = 0 with a white margin, seen from +z under an even sky
Scene board_scene(const Board& board);

// one photo from each pose
std::vector<Picture8> photos(Scene scene, const Camera& optics, const std::vector<Pose>& poses, int samples);

// The same of a scene that moves with photo i at velocity[i], in the frame of its camera [m/s], and is where it was
// given when the last row is read (Camera::row_time).
std::vector<Picture8> photos_in_motion(Scene scene, const Camera& optics, const std::vector<Pose>& poses,
                                       const std::vector<Vec3>& velocity, int samples);

// What photos of a board, all of one size, say of their camera, with k1, k2, p1 and p2.
CameraCalibration calibration_from(const std::vector<Picture8>& pictures, const Board& board);

}  // namespace pvg
