// The layout of robomimic, with MimicGen's additions: one HDF5 file for the set, demo.hdf5.
//   /data   attributes total, env_args (JSON), action_names
//   /action_offset, /action_scale [D]
//   /data/demo_<i>   attributes num_samples, episode
//     actions       [T, D]  in [-1, 1]: (actions_abs - offset) / scale, from the least to the most of the whole set
//     actions_abs   [T, D]  absolute targets [rad or m]
//     rewards, dones [T]    1 in the last row
//     states        [T, D + 12 R]  joints, then the affine poses of the objects, row by row
//     obs, next_obs /robot0_joint_pos [T, D], <camera>_image [T, H, W, 3] u8, and with a gripper /robot0_eef_pos [T,
//     3],
//                   robot0_eef_quat [T, 4] (x, y, z, w), robot0_gripper_qpos [T, 1] (its width); of more arms:
//                   robot1_...
//     datagen_info/ eef_pose [T, 4, 4], target_pose [T, 4, 4] (where it is in the next row), gripper_action [T, 1],
//                   object_poses/<object> [T, 4, 4]        of the first gripper
//   /mask/train, /mask/valid   names of demos; every tenth is for validation
#pragma once
#include <memory>

#include "host/dataset/packed_episode.hpp"

namespace pvg {

std::unique_ptr<DataSetWriter> make_robomimic_writer(const std::filesystem::path& folder, const PackedSet& set);

}  // namespace pvg
