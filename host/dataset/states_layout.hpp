// Which data set of states.h5 holds which body, and all that is written into the file once (states_file.hpp lists it).
#pragma once
#include <span>
#include <string>
#include <vector>

#include "host/dataset/states_file.hpp"
#include "host/hdf5/series.hpp"

namespace pvg {

struct StatesLayout {
  std::vector<std::size_t> driven, links, rigids;  // of Scene::joints, of Scene::rigid_bodies
  std::vector<std::string> soft, cloths;           // data set of each
};

StatesLayout lay_out_states(const PhysicalScene& scene, const EpisodeHeader& header);

inline constexpr int DEFLATE = 8;  // level: 7 is 0.5 % larger in 0.7 of the time

// How a series with rows of this shape is kept where the states are not `full`; the values are the same.
hdf5::Storage compressed(const hdf5::Shape& row, std::size_t bytes_per_value);

std::vector<double> flat(std::span<const Vec3> points);  // [n x 3]

// After the series of the layout's data sets are open: they get attributes.
void write_constants(hdf5::File& file, const Scene& scene, const EpisodeHeader& header,
                     std::span<const DisabledPair> disabled, const StatesLayout& layout);

}  // namespace pvg
