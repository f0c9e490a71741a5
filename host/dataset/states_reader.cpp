#include "host/dataset/states_reader.hpp"

#include <algorithm>

namespace pvg {
namespace {

hdf5::File open_states(const std::filesystem::path& path) {
  if (!std::filesystem::is_regular_file(path)) throw UsageError(path.string() + ": there is no such states file");
  hdf5::File file = hdf5::File::open(path);
  if (!file.has("/time") || !file.has("/bodies/source"))
    throw UsageError(path.string() + " is no states file of simulate or generate");
  return file;
}

}  // namespace

StatesOrigin states_origin(const std::filesystem::path& path) {
  const hdf5::File file = open_states(path);
  return {file.text_attribute("/", "task"), file.unsigned_attribute("/", "seed"),
          file.unsigned_attribute("/", "episode")};
}

StatesReader::StatesReader(const std::filesystem::path& path, const Scene& scene)
    : path_(path),
      file_(open_states(path)),
      names_(file_.texts_attribute("/bodies", "names")),
      data_sets_(file_.texts_attribute("/bodies", "data_sets")),
      source_(file_.read<std::int64_t>("/bodies/source").values),
      row_(file_.read<std::int64_t>("/bodies/row").values),
      times_(file_.read<double>("/time").values) {
  if (times_.empty()) throw UsageError(path_.string() + " holds no step; there is nothing to show");
  if (names_.size() != source_.size() || names_.size() != row_.size())
    throw UsageError(path_.string() + " is damaged: its lists of bodies differ in length");
  if (file_.has("/frame_step"))
    for (const std::int64_t step : file_.read<std::int64_t>("/frame_step").values)
      if (step >= 0 && std::size_t(step) < times_.size()) filmed_.push_back(std::size_t(step));
  const auto check_nodes = [&](const std::string& body, const Place& place, std::size_t n) {
    if (place.n_nodes != n)
      throw UsageError(path_.string() + " holds " + std::to_string(place.n_nodes) + " nodes of `" + body +
                       "`, the scene " + std::to_string(n) + "; it was made of another scene");
  };
  for (const RigidBody& body : scene.rigid_bodies) rigid_.push_back(find(body.name));
  for (const SoftBody& body : scene.soft_bodies) {
    soft_.push_back(find(body.name));
    check_nodes(body.name, soft_.back(), body.mesh.points.size());
  }
  for (const Cloth& cloth : scene.cloths) {
    cloth_.push_back(find(cloth.name));
    check_nodes(cloth.name, cloth_.back(), cloth.mesh.points.size());
  }
}

StatesReader::Place StatesReader::find(const std::string& body) const {
  const auto at = std::find(names_.begin(), names_.end(), body);
  if (at == names_.end())
    throw UsageError(path_.string() + " lacks the body `" + body + "` of the scene; it was made of another scene");
  const std::size_t i = std::size_t(at - names_.begin());
  Place place;
  place.data_set = data_sets_.at(std::size_t(source_[i]));
  place.row = std::uint64_t(row_[i]);
  const hdf5::Shape shape = file_.shape(place.data_set);
  if (shape.size() < 3 || shape[0] < times_.size())
    throw UsageError(path_.string() + " is damaged: " + place.data_set + " has fewer steps than /time");
  place.n_nodes = shape[1];
  return place;
}

std::vector<Vec3> StatesReader::nodes(const Place& place, std::size_t step) const {
  const std::vector<double> values = file_.read_row<double>(place.data_set, step);
  std::vector<Vec3> points;
  for (std::size_t i = 0; i + 2 < values.size(); i += 3) points.emplace_back(values[i], values[i + 1], values[i + 2]);
  return points;
}

SceneState StatesReader::state(std::size_t step) const {
  SceneState state;
  state.time = times_.at(step);
  std::string read;  // data set whose row is at hand
  std::vector<double> values;
  for (const Place& place : rigid_) {
    if (place.data_set != read) values = file_.read_row<double>(read = place.data_set, step);
    state.rigid.emplace_back();
    for (Eigen::Index i = 0; i < 12; ++i) state.rigid.back()(i / 4, i % 4) = values.at(12 * place.row + std::size_t(i));
  }
  for (const Place& place : soft_) state.soft.push_back(nodes(place, step));
  for (const Place& place : cloth_) state.cloth.push_back(nodes(place, step));
  return state;
}

}  // namespace pvg
