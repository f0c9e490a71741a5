#include "host/dataset/checkpoint_file.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/base/atomic_files.hpp"
#include "host/hdf5/file.hpp"

namespace pvg {
namespace {

constexpr std::int64_t SCHEMA = 6;

// An anchor as numbers: kind and sites of its pair, strain.
constexpr std::size_t ANCHOR_LENGTH = 8;
constexpr std::size_t PAIR_LENGTH = std::tuple_size_v<PairKey>;

std::vector<double> to_numbers(const std::vector<FrictionAnchor>& anchors) {
  std::vector<double> numbers;
  for (const FrictionAnchor& anchor : anchors) {
    numbers.insert(numbers.end(), anchor.pair.begin(), anchor.pair.end());
    numbers.insert(numbers.end(), anchor.strain.begin(), anchor.strain.end());
  }
  return numbers;
}

std::vector<FrictionAnchor> to_anchors(const std::vector<double>& numbers) {
  if (numbers.size() % ANCHOR_LENGTH != 0) throw UsageError("its anchors are not whole");
  std::vector<FrictionAnchor> anchors(numbers.size() / ANCHOR_LENGTH);
  for (std::size_t i = 0; i < anchors.size(); ++i) {
    const double* number = &numbers[i * ANCHOR_LENGTH];
    for (std::size_t k = 0; k < PAIR_LENGTH; ++k) {
      if (!(number[k] >= 0 && number[k] <= std::numeric_limits<std::uint32_t>::max()))
        throw UsageError("its anchors name sites that are no numbers of sites");
      anchors[i].pair[k] = std::uint32_t(number[k]);
    }
    anchors[i].strain = Eigen::Map<const Vec3>(number + PAIR_LENGTH);
  }
  return anchors;
}

// Every field of a checkpoint, once: what is written is what is read. A new field is a line here.
template <class Checkpoint, class Visit>
void for_each_field(Checkpoint& checkpoint, const Visit& visit) {
  visit("/position", checkpoint.position);
  visit("/history/velocity", checkpoint.history.velocity);
  visit("/history/position_before", checkpoint.history.position_before);
  visit("/history/velocity_before", checkpoint.history.velocity_before);
  visit("/history/velocity_two_before", checkpoint.history.velocity_two_before);
  visit("/history/length_before", checkpoint.history.length_before);
  visit("/anchors", checkpoint.anchors);
  visit("/time", checkpoint.time);
  visit("/joint_position", checkpoint.joint_position);
  visit("/targets", checkpoint.targets);
  visit("/couplings", checkpoint.couplings);
  visit("/past_targets", checkpoint.past_targets);
  visit("/pressing", checkpoint.pressing);
  visit("/flowed", checkpoint.flowed);
  visit("/reading", checkpoint.reading);
  visit("/joint_motion", checkpoint.joint_motion);
}

struct Writer {
  hdf5::File& file;
  void operator()(const std::string& name, const std::vector<double>& values) const {
    file.write<double>(name, {values.size()}, values);
  }
  // one after the other, with where each begins
  void operator()(const std::string& name, const std::vector<std::vector<double>>& lists) const {
    std::vector<double> values;
    std::vector<std::int64_t> offset = {0};
    for (const std::vector<double>& list : lists) {
      values.insert(values.end(), list.begin(), list.end());
      offset.push_back(std::int64_t(values.size()));
    }
    file.write<double>(name + "/values", {values.size()}, values);
    file.write<std::int64_t>(name + "/offset", {offset.size()}, offset);
  }
  void operator()(const std::string& name, const std::vector<std::vector<FrictionAnchor>>& worlds) const {
    std::vector<std::vector<double>> lists;
    for (const std::vector<FrictionAnchor>& anchors : worlds) lists.push_back(to_numbers(anchors));
    (*this)(name, lists);
  }
};

struct Reader {
  const hdf5::File& file;
  static void demand_finite(const std::string& name, const std::vector<double>& values) {
    if (!std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); }))
      throw UsageError(name + " holds a number that is not finite");
  }
  void operator()(const std::string& name, std::vector<double>& values) const {
    values = file.read<double>(name).values;
    demand_finite(name, values);
  }
  void operator()(const std::string& name, std::vector<std::vector<double>>& lists) const {
    const std::vector<double> values = file.read<double>(name + "/values").values;
    const std::vector<std::int64_t> offset = file.read<std::int64_t>(name + "/offset").values;
    demand_finite(name, values);
    if (offset.empty() || offset.front() != 0 || std::uint64_t(offset.back()) != values.size())
      throw UsageError("the lists of " + name + " do not fit its values");
    for (std::size_t i = 0; i + 1 < offset.size(); ++i) {
      if (offset[i] < 0 || offset[i] > offset[i + 1] || std::size_t(offset[i + 1]) > values.size())
        throw UsageError("the lists of " + name + " do not fit its values");
      lists.emplace_back(values.begin() + offset[i], values.begin() + offset[i + 1]);
    }
  }
  void operator()(const std::string& name, std::vector<std::vector<FrictionAnchor>>& worlds) const {
    std::vector<std::vector<double>> lists;
    (*this)(name, lists);
    for (const std::vector<double>& numbers : lists) worlds.push_back(to_anchors(numbers));
  }
};

}  // namespace

void write_checkpoint(const std::filesystem::path& path, const SavedCheckpoint& saved) {
  const std::filesystem::path absolute = std::filesystem::absolute(path);
  PartialFile partial(absolute);
  hdf5::File file = hdf5::File::create(partial.path());
  for_each_field(saved.checkpoint, Writer{file});
  file.attribute("/", "schema", SCHEMA);
  file.attribute("/", "scene", saved.scene);
  file.close();
  partial.finish();
}

SavedCheckpoint read_checkpoint(const std::filesystem::path& path) {
  if (!std::filesystem::exists(path)) throw UsageError(path.string() + ": there is no such checkpoint");
  try {
    const hdf5::File file = hdf5::File::open(path);
    if (file.number_attribute("/", "schema") != double(SCHEMA))
      throw UsageError("its schema is not " + std::to_string(SCHEMA));
    SavedCheckpoint saved;
    for_each_field(saved.checkpoint, Reader{file});
    saved.scene = file.text_attribute("/", "scene");
    return saved;
  } catch (const std::runtime_error& error) {  // of ours: what is wrong with the file
    throw UsageError(path.string() + " is no checkpoint that can be resumed: " + error.what());
  }
}

}  // namespace pvg
