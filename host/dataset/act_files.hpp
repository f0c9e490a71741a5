// The layout of ACT and ALOHA: one HDF5 file per episode.
//   episode_<i>.hdf5   attributes sim, length (frames before padding), frames_per_second
//     /observations/qpos, /observations/qvel, /action   [T, D]  f32 [rad or m, per s]; /names in the attribute of
//     /action /observations/pictures/<camera>                     [T, H, W, 3]  u8, sRGB /is_pad [T]  u8
// The loader takes T from the first episode for all: shorter ones are filled up by their last row. action [t] is what
// is commanded after qpos [t] was seen, as in the simulated episodes of ACT (packed_episode.hpp).
#pragma once
#include <memory>

#include "host/dataset/packed_episode.hpp"

namespace pvg {

// n_rows: T, at least the frames of the longest episode
std::unique_ptr<DataSetWriter> make_act_writer(const std::filesystem::path& folder, std::size_t n_rows);

}  // namespace pvg
