#include "host/identify/sensing/journal.hpp"

#include <cstring>

#include "host/base/error.hpp"
#include "host/identify/sensing/file_contents.hpp"
#include "host/identify/sensing/prediction_bytes.hpp"
#include "host/identify/sensing/question.hpp"

namespace pvg::diagnose {
namespace {

namespace fs = std::filesystem;
constexpr std::uint64_t MAGIC = 0x3267616964677670;  // "pvgdiag2"

// of a set of episodes none: what it holds is in the runs
std::vector<char> bytes_of(const fs::path& file) {
  std::error_code ignored;
  if (fs::is_directory(file, ignored)) return {};
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace

std::uint64_t journal_key(const Problem& problem, const std::string& settings) {
  std::uint64_t key = hash_of(settings);
  for (const fs::path& file : {problem.recording.file, problem.recording.scene}) key = hash_of(bytes_of(file), key);
  const auto add = [&key](const std::vector<double>& values) {
    const char* first = reinterpret_cast<const char*>(values.data());
    key = hash_of({first, sizeof(double) * values.size()}, key);
  };
  for (const Run& run : problem.runs) {
    add(run.t);
    for (const std::vector<double>& values : run.values) add(values);
    for (const TargetTable& targets : run.targets) add(targets.value);
    for (const PrescribedPath& prescribed : run.prescribed)
      for (const PathPoint& point : prescribed.path) {
        const auto pose = point.pose.matrix().reshaped();
        add({point.time});
        add({pose.begin(), pose.end()});
      }
    for (const KnownPush& push : run.pushes) {
      add({push.from, push.to});
      add(push.effect.parameters);
    }
  }
  std::error_code ignored;
  const auto built = fs::last_write_time("/proc/self/exe", ignored).time_since_epoch().count();
  std::vector<char> bytes;
  put(bytes, built);
  put_meshes(bytes, problem.scene.scene);
  put_look(bytes, problem.seen);
  put_lut(bytes, problem.lut);
  return hash_of(bytes, key);
}

Journal::Journal(fs::path file, std::uint64_t key) : file_(std::move(file)), content_(bytes_of(file_)) {
  std::vector<char> head;
  put(head, MAGIC);
  put(head, key);
  if (content_.size() < head.size() || std::memcmp(content_.data(), head.data(), head.size()) != 0) {
    content_ = head;
    std::ofstream(file_, std::ios::binary).write(head.data(), std::streamsize(head.size()));
  }
  at_ = head.size();
}

std::optional<std::vector<Prediction>> Journal::result_for(std::uint64_t question) {
  if (out_.is_open() || at_ >= content_.size()) return std::nullopt;
  const std::span<const char> rest = std::span<const char>(content_).subspan(at_);
  std::uint64_t asked = 0;
  std::optional<Unpacked> result;
  if (rest.size() >= sizeof asked) std::memcpy(&asked, rest.data(), sizeof asked);
  if (asked == question) result = unpacked(rest.subspan(sizeof asked));
  if (!result) {
    content_.resize(at_);
    return std::nullopt;
  }
  at_ += sizeof asked + result->n_bytes;
  ++n_read_;
  return std::move(result->predictions);
}

void Journal::add(std::uint64_t question, const std::vector<Prediction>& result) {
  if (file_.empty()) return;
  if (!out_.is_open()) {  // what follows the last result that was read is void
    std::error_code ignored;
    fs::resize_file(file_, at_, ignored);
    out_.open(file_, std::ios::binary | std::ios::app);
  }
  std::vector<char> bytes;
  put(bytes, question);
  const std::vector<char> content = packed(result);
  bytes.insert(bytes.end(), content.begin(), content.end());
  out_.write(bytes.data(), std::streamsize(bytes.size()));
  out_.flush();
  if (!out_) throw Failure(file_.string() + " could not be written");
}

void Journal::remove() {
  out_.close();
  std::error_code ignored;
  if (!file_.empty()) std::filesystem::remove(file_, ignored);
}

}  // namespace pvg::diagnose
