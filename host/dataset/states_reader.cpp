#include "host/dataset/states_reader.hpp"
#include "host/base/counted.hpp"

#include <algorithm>

namespace pvg {

StatesOrigin states_origin(const std::filesystem::path& path) {
  const StatesRecord record(path);
  return {record.text("task"), record.whole("seed"), record.whole("episode")};
}

StatesReader::StatesReader(const std::filesystem::path& path, const PhysicalScene& scene)
    : record_(path), bodies_(record_.bodies()) {
  if (record_.n_steps() == 0) throw UsageError(path.string() + " holds no step; there is nothing to show");
  kept_ = record_.kept_steps();
  if (kept_.empty()) throw UsageError(path.string() + " keeps the nodes of no step; there is nothing to show");
  if (record_.has("/frame_step"))
    for (const std::size_t step : record_.filmed_steps()) {
      const auto at = std::lower_bound(kept_.begin(), kept_.end(), step);
      if (at == kept_.end() || *at != step)
        throw UsageError(path.string() + " keeps no nodes of the filmed step " + std::to_string(step) +
                         "; make the record again");
      filmed_.push_back(std::size_t(at - kept_.begin()));
    }
  const auto check_nodes = [&](const std::string& body, const StatesRecord::Body& found, std::size_t n) {
    if (found.is_rigid || found.n_nodes != n)
      throw UsageError(path.string() + " holds " + counted(found.n_nodes, "node") + " of `" + body + "`, the scene " +
                       std::to_string(n) + "; it was made of another scene" +
                       (found.is_rigid ? " or with --gripper rigid" : ""));
  };
  for (const RigidBody& body : scene.rigid_bodies) {
    rigid_.push_back(find(body.name));
    if (!rigid_.back().is_rigid)
      throw UsageError(path.string() + ": `" + body.name +
                       "` is soft there, rigid in the scene; it was made of another "
                       "scene");
  }
  for (const Display& display : scene.displays) displays_.push_back(display.name);
  if (!displays_.empty() && (!record_.has("/reading") || record_.series("/reading").names != displays_))
    throw UsageError(path.string() + " holds no readings of the scene's displays; it was made of another scene");
  for (const SoftBody& body : scene.soft_bodies) {
    soft_.push_back(find(body.name));
    check_nodes(body.name, soft_.back(), body.mesh.points.size());
  }
  for (const Cloth& cloth : scene.cloths) {
    cloth_.push_back(find(cloth.name));
    check_nodes(cloth.name, cloth_.back(), cloth.mesh.points.size());
  }
}

StatesRecord::Body StatesReader::find(const std::string& name) const {
  const auto at = std::find_if(bodies_.begin(), bodies_.end(), [&](const auto& body) { return body.name == name; });
  if (at == bodies_.end())
    throw UsageError(record_.path().string() + " lacks the body `" + name +
                     "` of the scene; it was made of another scene");
  return *at;
}

std::vector<Vec3> StatesReader::nodes(const StatesRecord::Body& place, std::size_t step) const {
  const std::vector<double> values = record_.row(place.data_set, step);
  std::vector<Vec3> points;
  for (std::size_t i = 0; i + 2 < values.size(); i += 3) points.emplace_back(values[i], values[i + 1], values[i + 2]);
  return points;
}

SceneState StatesReader::state(std::size_t kept_step) const {
  SceneState state;
  state.time = time(kept_step);
  const std::size_t step = kept_.at(kept_step);
  std::string read;  // data set whose row is at hand
  std::vector<double> values;
  for (const StatesRecord::Body& place : rigid_) {
    if (place.data_set != read) values = record_.row(read = place.data_set, step);
    state.rigid.emplace_back();
    for (Eigen::Index i = 0; i < 12; ++i) state.rigid.back()(i / 4, i % 4) = values.at(12 * place.row + std::size_t(i));
  }
  for (const StatesRecord::Body& place : soft_) state.soft.push_back(nodes(place, step));
  for (const StatesRecord::Body& place : cloth_) state.cloth.push_back(nodes(place, step));
  if (!displays_.empty()) state.reading = record_.row("/reading", step);
  return state;
}

}  // namespace pvg
