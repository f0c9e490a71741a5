// The layout of UMI and Diffusion Policy: Zarr version 2 in a zip that stores without compressing, dataset.zarr.zip.
//   /data/robot<i>_eef_pos [N, 3, m]            of the tool frame, in the world
//   /data/robot<i>_eef_rot_axis_angle [N, 3, rad]
//   /data/robot<i>_gripper_width [N, 1, m]
//   /data/robot<i>_demo_start_pose, robot<i>_demo_end_pose [N, 6]     position and axis times angle of the episode's
//   ends /data/camera<i>_rgb [N, 224, 224, 3] u8     the square in the middle of the picture; one chunk per picture
//   /meta/episode_ends [episodes] i64           rows up to the end of each episode
// All numbers are f32. Cameras: those on the robots, or all where none is; actions are made of the poses by the
// trainer.
#pragma once
#include <memory>

#include "host/dataset/packed_episode.hpp"

namespace pvg {

std::unique_ptr<DataSetWriter> make_umi_zarr_writer(const std::filesystem::path& folder);

}  // namespace pvg
