// Where everything was, step by step, from a states file (states_file.hpp), for the scene that it was made of.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "host/dataset/states_record.hpp"
#include "host/model/physical_scene.hpp"
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
  StatesReader(const std::filesystem::path& file, const PhysicalScene& scene);

  // Steps are counted among those whose nodes are kept: all, or of `record: {states: frames}` those of frames.
  std::size_t n_steps() const { return kept_.size(); }
  double time(std::size_t step) const { return record_.times().at(kept_.at(step)); }  // [s]
  // steps that were filmed; empty where there were no pictures
  const std::vector<std::size_t>& filmed_steps() const { return filmed_; }
  SceneState state(std::size_t step) const;  // at the step's end

 private:
  StatesRecord::Body find(const std::string& body) const;
  std::vector<Vec3> nodes(const StatesRecord::Body& place, std::size_t step) const;

  StatesRecord record_;
  std::vector<StatesRecord::Body> bodies_;
  std::vector<std::size_t> kept_, filmed_;
  std::vector<StatesRecord::Body> rigid_, soft_, cloth_;
  std::vector<std::string> displays_;
};

}  // namespace pvg
