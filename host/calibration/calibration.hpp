// A camera's intrinsics from photos of a board, and a camera's place from a photo of tags, by OpenCV. A build without
// OpenCV throws a UsageError that names scripts/install_calibration.sh.
#pragma once
#include <optional>

#include "host/calibration/board.hpp"
#include "host/model/appearance.hpp"

namespace pvg {

struct BoardPhoto {
  std::string file;
  std::vector<BoardCorner> corners;
  double residual = 0;  // root mean square of its corners [pixels]; 0: not used
  bool is_used = true;
  std::string reason;                        // why it is not used
  std::vector<Eigen::Vector2d> differences;  // [n_corners] found minus computed [pixels]; empty: not used
};

struct CameraCalibration {
  Camera camera;              // model, size, focal lengths, centre, distortion
  std::vector<double> sigma;  // standard deviations of fx fy cx cy and the distortion, in this order
  double residual = 0;        // root mean square of all used corners [pixels]
  std::vector<BoardPhoto> photos;
};

struct CalibrationSettings {
  Camera::Model model = Camera::Model::pinhole;
  int n_distortion = 5;            // pinhole: 4 (k1 k2 p1 p2), 5 or 8; 0: none
  double largest_ratio = 3;        // a photo whose residual is that many times the median one is left out
  std::size_t fewest_corners = 8;  // of a photo that counts
};

// Photos that do not count, and those whose residual stands out, are left out and say why. A UsageError where fewer
// than three photos are left, or where they all show the board from one side, so that the focal length is not
// determined.
CameraCalibration calibrate_camera(std::vector<BoardPhoto> photos, int width, int height,
                                   const CalibrationSettings& settings);

// A tag of known size and place.
struct PlacedTag {
  int id = 0;
  double size = 0;  // edge, its black border included [m]
  Pose pose =
      Pose::Identity();  // tag to world: x right, y up as it stands upright, z toward the viewer; origin: middle
};

struct CameraPlace {
  Pose pose = Pose::Identity();                                       // camera (optical frame) to world
  double residual = 0;                                                // root mean square [pixels]
  Vec3 position_sigma = Vec3::Zero(), rotation_sigma = Vec3::Zero();  // along and about the camera's axes [m, rad]
  std::vector<int> used;                                              // ids
};

// UsageErrors where no tag of the list is seen.
CameraPlace place_camera(const std::vector<FoundTag>& found, const std::vector<PlacedTag>& tags, const Camera& camera);

}  // namespace pvg
