// Where everything was, step by step, from a states file (states_file.hpp), for the scene that it was made of.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "host/formats/hdf5.hpp"
#include "host/model/scene.hpp"
#include "host/model/state.hpp"

namespace pvg {

// Which draw of a task a states file shows; a scene file's states have both 0.
struct StatesOrigin {
  std::string name;  // of the task or scene
  std::uint64_t seed = 0, episode = 0;
};
StatesOrigin states_origin(const std::filesystem::path& file);

class StatesReader {
 public:
  // Throws a UsageError that names a body which the file lacks, or which has another number of nodes there.
  StatesReader(const std::filesystem::path& file, const Scene& scene);

  std::size_t n_steps() const { return times_.size(); }
  double time(std::size_t step) const { return times_.at(step); }  // [s]
  // steps that were filmed; empty where there were no pictures
  const std::vector<std::size_t>& filmed_steps() const { return filmed_; }
  SceneState state(std::size_t step) const;  // at the step's end

 private:
  struct Place {  // of a body
    std::string data_set;
    std::uint64_t row = 0, n_nodes = 0;
  };
  Place find(const std::string& body) const;
  std::vector<Vec3> nodes(const Place& place, std::size_t step) const;

  std::filesystem::path path_;
  hdf5::File file_;
  std::vector<std::string> names_, data_sets_;
  std::vector<std::int64_t> source_, row_;
  std::vector<double> times_;
  std::vector<std::size_t> filmed_;
  std::vector<Place> rigid_, soft_, cloth_;
};

}  // namespace pvg
