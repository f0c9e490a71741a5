#include "host/identify/sensing/journal.hpp"

#include <cstring>

#include "host/base/error.hpp"
#include "host/identify/sensing/prediction_bytes.hpp"

namespace pvg::diagnose {
namespace {

namespace fs = std::filesystem;
constexpr std::uint64_t MAGIC = 0x3167616964677670;  // "pvgdiag1"

std::vector<char> bytes_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace

std::uint64_t hash_of(std::span<const char> bytes, std::uint64_t so_far) {
  for (const char byte : bytes) so_far = (so_far ^ static_cast<unsigned char>(byte)) * 1099511628211u;
  return so_far;
}

std::uint64_t question_of(std::span<const Job> jobs) {
  std::vector<char> bytes;
  for (const Job& job : jobs) {
    const Scene& scene = job.variant->scene;
    put(bytes, job.window->run);
    put(bytes, job.window->start);
    put(bytes, job.window->end);
    put(bytes, job.wants_phases);
    put(bytes, scene.solver.time_step);
    put(bytes, scene.solver.integrator);
    for (const Effect& effect : scene.effects) {
      for (const std::string& text : {effect.name, effect.target}) bytes.insert(bytes.end(), text.begin(), text.end());
      for (const std::string& text : effect.formulas) bytes.insert(bytes.end(), text.begin(), text.end());
      for (const double p : effect.parameters) put(bytes, p);
    }
    for (const double q : job.initial.position) put(bytes, q);
    for (const double q : job.initial.rate) put(bytes, q);
    for (const Pose& pose : job.initial.pose)
      for (const double x : pose.matrix().reshaped()) put(bytes, x);
    for (const Vec3& v : job.initial.velocity)
      for (const double x : v) put(bytes, x);
  }
  return hash_of(bytes);
}

std::uint64_t journal_key(const Problem& problem, const std::string& settings) {
  std::uint64_t key = hash_of(settings);
  for (const fs::path& file : {problem.recording.file, problem.recording.scene}) key = hash_of(bytes_of(file), key);
  for (const Run& run : problem.runs)
    for (const std::vector<double>& values : run.values) {
      const char* first = reinterpret_cast<const char*>(values.data());
      key = hash_of({first, sizeof(double) * values.size()}, key);
    }
  std::error_code ignored;
  const auto built = fs::last_write_time("/proc/self/exe", ignored).time_since_epoch().count();
  std::vector<char> bytes;
  put(bytes, built);
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

std::optional<std::vector<Prediction>> Journal::answer_to(std::uint64_t question) {
  if (out_.is_open() || at_ >= content_.size()) return std::nullopt;
  const std::span<const char> rest = std::span<const char>(content_).subspan(at_);
  std::uint64_t asked = 0;
  std::optional<Unpacked> answer;
  if (rest.size() >= sizeof asked) std::memcpy(&asked, rest.data(), sizeof asked);
  if (asked == question) answer = unpacked(rest.subspan(sizeof asked));
  if (!answer) {
    content_.resize(at_);
    return std::nullopt;
  }
  at_ += sizeof asked + answer->n_bytes;
  ++n_read_;
  return std::move(answer->predictions);
}

void Journal::add(std::uint64_t question, const std::vector<Prediction>& answer) {
  if (file_.empty()) return;
  if (!out_.is_open()) {  // what follows the last answer that was read is void
    std::error_code ignored;
    fs::resize_file(file_, at_, ignored);
    out_.open(file_, std::ios::binary | std::ios::app);
  }
  std::vector<char> bytes;
  put(bytes, question);
  const std::vector<char> content = packed(answer);
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
