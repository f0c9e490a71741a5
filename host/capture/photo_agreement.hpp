// How photos have to move so that they agree on the brightness of the surface: the other half of a refined pose, which
// tells what depth does not show, such as a place along a wall.
#pragma once
#include <span>

#include "host/capture/fusion.hpp"
#include "host/pictures/gray_photo.hpp"

namespace pvg {

class PhotoAgreement {
 public:
  // Colour cameras stay where they are beside their depth cameras. Photos are blurred by so many rounds
  // (gray_photo.hpp). Frames without photo count for nothing.
  PhotoAgreement(Device& device, std::span<const CaptureFrame> frames, int blur_rounds);

  // Takes points of the surface, and what every photo shows of them from where the frames are now.
  void look(const Capture& capture, std::span<const CaptureFrame> frames, const FusedSurface& surface, double voxel);
  // Of a photo from this pose of its depth camera, against the means of the others; in the units of a depth picture of
  // which n_pixels count, with the unknowns of Fusion::registration.
  RegistrationSums registration(std::size_t frame, const Pose& depth_pose, double n_pixels) const;
  // The photo as it is seen from there counts from here on.
  void update(std::size_t frame, const Pose& depth_pose);

  double disagreement() const;  // root mean square of all photos about the means of the others, in sRGB

 private:
  struct Sight {
    std::uint32_t point;
    double value;  // of the photo with its gain; negative: outside
  };
  struct View {
    Camera camera;  // without distortion
    Pose in_depth_camera;
    GrayPhoto photo;
    double gain = 1;
    std::vector<Sight> sights;
  };
  bool see(const View& view, const Pose& depth_pose, const Vec3& point, double& value,
           Eigen::Matrix<double, 1, 6>* slope) const;
  double mean_of_others(const Sight& sight) const;  // negative: too few see it
  void bring_to_one_exposure(std::span<const CaptureFrame> frames);

  Device& device_;
  std::vector<View> views_;  // [n_frames]
  std::vector<Vec3> points_;
  std::vector<double> sum_, count_;  // of each point, over the photos that see it
  double sigma_ = 0;                 // of a photo's brightness about the others' mean, in sRGB
};

}  // namespace pvg
