// Where a capture stands in the world of tags of known size and place, by photos whose poses in the capture are known.
// A corner is the point p that is nearest to all rays o_i + t d_i that see it:
//   sum_i (I - d_i d_i^T) (p - o_i) = 0,
// and the capture's place is the rigid motion that brings these points nearest to the given ones (Umeyama 1991).
#pragma once
#include <span>

#include "host/calibration/calibration.hpp"

namespace pvg {

struct TagPhoto {
  std::string name;  // for messages
  Camera camera;     // optics, and pose: camera to the capture's frame
  std::vector<FoundTag> found;
};

struct TagFrame {
  Pose world_from_capture = Pose::Identity();
  double residual = 0;    // root mean square distance of the corners from their given places [m]
  double scale = 1;       // of given distances over those of the capture
  std::vector<int> used;  // ids, ascending
  std::size_t n_photos = 0;
};

// Corners count that two photos see from directions at least `least_angle` [rad] apart. UsageErrors where no tag has
// four such corners, and where the capture's lengths differ from the given ones by more than a twentieth.
TagFrame locate_tags(std::span<const TagPhoto> photos, const std::vector<PlacedTag>& tags, double least_angle = 0.05);

}  // namespace pvg
