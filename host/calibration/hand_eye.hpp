// Where a camera is mounted on a robot's hand, from photos of tags that stand still and the hand's pose at each photo:
// A X = X B, first by Park and Martin 1994 (OpenCV) from few photos, then by least squares of all corners.
#pragma once
#include "host/calibration/calibration.hpp"

namespace pvg {

struct HandPhoto {
  std::string file;
  Pose hand = Pose::Identity();  // of the link that carries the camera, in the robot's base
  std::vector<FoundTag> found;
  double residual = 0;  // root mean square of its corners [pixels]
  bool is_used = true;
  std::string reason;  // why it is not used
};

struct HandEye {
  Pose mount = Pose::Identity();                                      // camera (optical frame) in the hand's frame
  Pose tags = Pose::Identity();                                       // frame of the tags' places in the base
  double residual = 0;                                                // of all used corners, root mean square [pixels]
  Vec3 position_sigma = Vec3::Zero(), rotation_sigma = Vec3::Zero();  // of the mount, camera's axes [m, rad]
  std::vector<HandPhoto> photos;
};

// tags: their places in one frame, wherever that is in the base. A photo without tags, and one whose residual stands
// out (three times the median, as of calibrate_camera), is left out and says why. UsageErrors where fewer than four
// photos are left, where the hand turned about one axis alone, or where more than half of the photos disagree.
HandEye calibrate_hand_eye(std::vector<HandPhoto> photos, const std::vector<PlacedTag>& tags, const Camera& camera);

}  // namespace pvg
