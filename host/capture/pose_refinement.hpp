// Poses of a capture's depth pictures, refined from frame to model: a picture is taken out of the fused distances,
// moved by Gauss-Newton so that it lies on what the others show, and fused again (Bylow et al. 2013; Dai et al. 2017).
#pragma once
#include <span>

#include "host/capture/fusion.hpp"

namespace pvg {

struct PoseRefinementSettings {
  double sigma = 0.01;   // standard deviation of a given pose [m], and of its rotation [rad], which is as much at 1 m
  int most_sweeps = 10;  // over all frames, at each of the two sizes of voxels
};

struct UnrefinedFrame {
  std::string name;
  double share = 0;  // of its pixels, near what other frames show
};

struct PoseRefinement {
  std::vector<Pose> poses;  // [n_frames] of the depth cameras, in the capture's frame
  std::vector<UnrefinedFrame> unrefined;
  double mean_shift = 0, largest_shift = 0;  // of the cameras [m]
  double mean_turn = 0, largest_turn = 0;    // [rad]
  // root mean square distance of pictures from what the others show, weighted by the noise of depth, at the coarse
  // voxels: with the given poses, with the refined ones [m]
  double distance_before = 0, distance_after = 0;
  // root mean square disagreement of the photos, blurred by a pixel, before and after they counted [sRGB]; 0: none did
  double disagreement_before = 0, disagreement_after = 0;
  int n_sweeps = 0;
  double cpu_ms_per_frame = 0;
};

// The mean motion of all frames is removed: the capture's frame stays where it is. UsageErrors name the frame.
PoseRefinement refine_poses(Device& device, const Capture& capture, std::span<const CaptureFrame> frames,
                            const FusionSettings& fusion, const PoseRefinementSettings& settings);

// Goes on from refined frames, by depth and photos together: what depth does not show, colours do. The colour cameras
// must be where they are beside the depth cameras. given: poses before any refinement.
void refine_with_photos(Device& device, const Capture& capture, std::span<const CaptureFrame> frames,
                        std::span<const Pose> given, const FusionSettings& fusion,
                        const PoseRefinementSettings& settings, PoseRefinement& refined);

// Moves frames onto the surface that others make, such as left-out ones; colour cameras move along.
void register_frames(Device& device, const Capture& capture, std::span<const CaptureFrame> fused,
                     std::span<CaptureFrame> frames, const FusionSettings& fusion,
                     const PoseRefinementSettings& settings);

// The step (rotation, translation) of one picture: with sums of Gauss-Newton at a pose that is `off` from the given
// one. Where the sums know nothing the pose stays, or goes back to where it was given.
Eigen::Matrix<double, 6, 1> refining_step(const RegistrationSums& sums, const Eigen::Matrix<double, 6, 1>& off,
                                          double sigma);

// The poses moved as one, so that neither the mean rotation nor the mean place differs from those given.
void hold_mean(std::span<const Pose> given, std::span<Pose> poses);

// Frames with these poses of the depth cameras; colour cameras move along.
void apply_poses(std::span<const Pose> poses, std::span<CaptureFrame> frames);

}  // namespace pvg
