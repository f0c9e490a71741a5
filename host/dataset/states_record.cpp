#include "host/dataset/states_record.hpp"
#include "host/base/counted.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace pvg {
namespace {

hdf5::File open_states(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored))
    throw UsageError(path.string() + ": there is no such states file");
  hdf5::File file = hdf5::File::open(path);
  if (!file.has("/time"))
    throw UsageError(path.string() + " is no states file of simulate or generate: it lacks /time");
  return file;
}

std::string text_of(const hdf5::Shape& shape) {
  std::string text;
  for (const std::uint64_t n : shape) text += (text.empty() ? "" : " x ") + std::to_string(n);
  return shape.empty() ? "one number" : text;
}

}  // namespace

StatesRecord::StatesRecord(const std::filesystem::path& path) : path_(path), file_(open_states(path)) {
  times_ = read<double>("/time", {ANY});
  demand_finite("/time", times_);
  for (std::size_t i = 1; i < times_.size(); ++i)
    if (!(times_[i] > times_[i - 1])) fail("/time", "does not ascend in step " + std::to_string(i));
}

void StatesRecord::fail(const std::string& object, const std::string& what) const {
  throw UsageError(path_.string() + " is damaged: " + object + " " + what + "; make the record again");
}

hdf5::Shape StatesRecord::demand_shape(const std::string& object, const hdf5::Shape& wanted) const {
  if (!file_.has(object)) fail(object, "is missing");
  const hdf5::Shape shape = file_.shape(object);
  bool fits = shape.size() == wanted.size();
  for (std::size_t i = 0; fits && i < shape.size(); ++i) fits = wanted[i] == ANY || shape[i] == wanted[i];
  if (!fits) {
    std::string text;
    for (const std::uint64_t n : wanted) text += (text.empty() ? "" : " x ") + (n == ANY ? "n" : std::to_string(n));
    fail(object, "holds " + text_of(shape) + " values, but must hold " + (wanted.empty() ? "one number" : text));
  }
  return shape;
}

template <class T>
std::vector<T> StatesRecord::read(const std::string& object, const hdf5::Shape& wanted) const {
  demand_shape(object, wanted);
  return file_.read<T>(object).values;
}

void StatesRecord::demand_finite(const std::string& object, const std::vector<double>& values) const {
  if (!std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); }))
    fail(object, "holds a number that is not finite");
}

std::vector<std::string> StatesRecord::names_of(const std::string& object, std::size_t n) const {
  std::vector<std::string> names = file_.texts_attribute(object, "names");
  if (names.size() != n) fail(object, "has " + counted(names.size(), "name") + " for " + counted(n, "column"));
  return names;
}

std::vector<std::size_t> StatesRecord::steps_in(const std::string& object) const {
  std::vector<std::size_t> steps;
  for (const std::int64_t step : read<std::int64_t>(object, {ANY})) {
    if (step < 0 || std::uint64_t(step) >= times_.size())
      fail(object, "names the step " + std::to_string(step) + " of " + std::to_string(times_.size()));
    if (!steps.empty() && std::size_t(step) <= steps.back()) fail(object, "does not ascend");
    steps.push_back(std::size_t(step));
  }
  return steps;
}

std::vector<std::size_t> StatesRecord::filmed_steps() const { return steps_in("/frame_step"); }

std::vector<std::size_t> StatesRecord::kept_steps() const {
  if (file_.has("/node_step")) return steps_in("/node_step");
  std::vector<std::size_t> all(times_.size());
  std::iota(all.begin(), all.end(), std::size_t(0));
  return all;
}

StatesRecord::Series StatesRecord::series(const std::string& object) const {
  Series series;
  series.values = read<double>(object, {times_.size(), ANY});
  demand_finite(object, series.values);
  series.names = names_of(object, std::size_t(file_.shape(object)[1]));
  return series;
}

std::vector<std::string> StatesRecord::poses_names(const std::string& object) const {
  return names_of(object, std::size_t(demand_shape(object, {times_.size(), ANY, 3, 4})[1]));
}

std::vector<double> StatesRecord::poses(const std::string& object) const {
  std::vector<double> values = read<double>(object, {times_.size(), ANY, 3, 4});
  demand_finite(object, values);
  return values;
}

std::vector<double> StatesRecord::row(const std::string& object, std::size_t step) const {
  std::vector<double> values = file_.read_row<double>(object, step);
  demand_finite(object, values);
  return values;
}

std::vector<double> StatesRecord::rows(const std::string& object) const {
  std::vector<double> values = file_.read<double>(object).values;
  if (!file_.has("/node_step") || !object.starts_with("/X_")) {
    demand_finite(object, values);
    return values;
  }
  const std::size_t n = times_.empty() ? 0 : values.size() / times_.size();
  for (const std::size_t step : kept_steps())
    demand_finite(object, {values.begin() + std::ptrdiff_t(step * n), values.begin() + std::ptrdiff_t((step + 1) * n)});
  return values;
}

std::vector<double> StatesRecord::start(const std::string& object) const {
  hdf5::Shape row = file_.shape(object);
  if (row.empty()) fail(object, "has no rows");
  row.erase(row.begin());
  std::vector<double> values = read<double>("/start" + object, row);
  demand_finite("/start" + object, values);
  return values;
}

std::vector<double> StatesRecord::start_camera(const std::string& name) const {
  const std::string object = "/start/camera/" + name + "/T_world_camera";
  std::vector<double> values = read<double>(object, {4, 4});
  demand_finite(object, values);
  return values;
}

std::vector<StatesRecord::Body> StatesRecord::bodies() const {
  if (!file_.has("/bodies/source"))
    throw UsageError(path_.string() + " is no states file of simulate or generate: it lacks /bodies/source");
  const std::vector<std::string> names = file_.texts_attribute("/bodies", "names"),
                                 sets = file_.texts_attribute("/bodies", "data_sets");
  const std::uint64_t n = names.size();
  const auto source = read<std::int64_t>("/bodies/source", {n}), row = read<std::int64_t>("/bodies/row", {n}),
             is_fixed = read<std::int64_t>("/bodies/is_fixed", {n});
  std::vector<Body> bodies(n);
  for (std::size_t i = 0; i < n; ++i) {
    if (source[i] < 0 || std::size_t(source[i]) >= sets.size())
      fail("/bodies/source", "names the data set " + std::to_string(source[i]) + " of " + std::to_string(sets.size()));
    Body& body = bodies[i];
    body = {names[i], sets[std::size_t(source[i])], i, 0, 0, source[i] < 2, is_fixed[i] != 0};
    const hdf5::Shape wanted =
        body.is_rigid ? hdf5::Shape{times_.size(), ANY, 3, 4} : hdf5::Shape{times_.size(), ANY, 3};
    const hdf5::Shape shape = demand_shape(body.data_set, wanted);
    if (body.is_rigid && (row[i] < 0 || std::uint64_t(row[i]) >= shape[1]))
      fail("/bodies/row",
           "names the row " + std::to_string(row[i]) + " of " + std::to_string(shape[1]) + " in " + body.data_set);
    body.row = body.is_rigid ? std::size_t(row[i]) : 0;
    body.n_nodes = body.is_rigid ? 0 : std::size_t(shape[1]);
  }
  return bodies;
}

StatesRecord::Mesh StatesRecord::mesh(const Body& body) const {
  const std::string at = "/mesh/" + body.name;
  Mesh mesh{read<double>(at + "/rest", {ANY, 3}), read<std::uint32_t>(at + "/triangles", {ANY, 3})};
  demand_finite(at + "/rest", mesh.rest);
  if (const auto owner = read<std::int64_t>(at + "/body", {}); owner.front() != std::int64_t(body.number))
    fail(at + "/body",
         "names the body " + std::to_string(owner.front()) + " instead of " + std::to_string(body.number));
  const std::size_t n = mesh.rest.size() / 3;
  if (!body.is_rigid && n != body.n_nodes)
    fail(at + "/rest", "holds " + counted(n, "point") + ", " + body.data_set + " " + std::to_string(body.n_nodes));
  for (const std::uint32_t corner : mesh.triangles)
    if (corner >= n) fail(at + "/triangles", "names the vertex " + std::to_string(corner) + " of " + std::to_string(n));
  return mesh;
}

std::vector<std::pair<std::size_t, std::size_t>> StatesRecord::noncolliding(std::size_t n_bodies) const {
  const auto numbers = read<std::int64_t>("/bodies/noncolliding", {ANY, 2});
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (std::size_t i = 0; i + 1 < numbers.size(); i += 2) {
    for (const std::int64_t body : {numbers[i], numbers[i + 1]})
      if (body < 0 || std::uint64_t(body) >= n_bodies)
        fail("/bodies/noncolliding", "names the body " + std::to_string(body) + " of " + std::to_string(n_bodies));
    pairs.emplace_back(std::minmax(std::size_t(numbers[i]), std::size_t(numbers[i + 1])));
  }
  return pairs;
}

StatesRecord::PairForces StatesRecord::pair_forces() const {
  PairForces forces;
  forces.normal = read<double>("/pair_force/normal", {ANY, 3});
  demand_finite("/pair_force/normal", forces.normal);
  const std::size_t n = forces.normal.size() / 3;
  forces.bodies = read<std::int64_t>("/pair_force/bodies", {n, 2});
  for (const std::int64_t offset : read<std::int64_t>("/pair_force/offset", {times_.size() + 1})) {
    if (offset < 0 || std::uint64_t(offset) > n ||
        (!forces.offset.empty() && std::size_t(offset) < forces.offset.back()))
      fail("/pair_force/offset", "does not ascend from 0 to " + std::to_string(n));
    forces.offset.push_back(std::size_t(offset));
  }
  return forces;
}

StatesRecord::CameraRows StatesRecord::camera(const std::string& name, std::size_t n_frames) const {
  const std::string at = "/camera/" + name;
  CameraRows rows{read<double>(at + "/K", {n_frames, 3, 3}), read<double>(at + "/T_world_camera", {n_frames, 4, 4})};
  demand_finite(at + "/K", rows.K);
  demand_finite(at + "/T_world_camera", rows.T_world_camera);
  return rows;
}

std::vector<std::pair<std::string, double>> StatesRecord::sampled() const {
  std::vector<std::pair<std::string, double>> drawn;
  if (!file_.has("/sampled")) return drawn;
  const std::vector<double> values = read<double>("/sampled", {ANY});
  const std::vector<std::string> names = names_of("/sampled", values.size());
  for (std::size_t i = 0; i < values.size(); ++i) drawn.emplace_back(names[i], values[i]);
  return drawn;
}

std::string StatesRecord::text(const std::string& attribute) const { return file_.text_attribute("/", attribute); }

std::uint64_t StatesRecord::whole(const std::string& attribute) const {
  return file_.unsigned_attribute("/", attribute);
}

double StatesRecord::positive(const std::string& attribute) const {
  const double value = file_.number_attribute("/", attribute);
  if (!(value > 0 && std::isfinite(value))) fail("the attribute `" + attribute + "`", "must be above 0");
  return value;
}

}  // namespace pvg
