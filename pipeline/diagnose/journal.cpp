#include "pipeline/diagnose/journal.hpp"

#include <cstring>

#include "host/base/error.hpp"

namespace pvg::diagnose {
namespace {

namespace fs = std::filesystem;
constexpr std::uint64_t MAGIC = 0x3167616964677670;  // "pvgdiag1"

std::vector<char> bytes_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

template <class T>
void put(std::vector<char>& bytes, const T& value) {
  const char* first = reinterpret_cast<const char*>(&value);
  bytes.insert(bytes.end(), first, first + sizeof value);
}

// Takes values one after the other; once the bytes end, nothing more is taken.
struct Reader {
  std::span<const char> bytes;
  std::size_t at = 0;
  bool is_short = false;

  void take(void* to, std::size_t n) {
    is_short = is_short || n > bytes.size() - at;
    if (is_short) return;
    std::memcpy(to, bytes.data() + at, n);
    at += n;
  }
  template <class T>
  T take() {
    T value{};
    take(&value, sizeof value);
    return value;
  }
  std::size_t take_count(std::size_t size_of_one) {
    const std::uint64_t n = take<std::uint64_t>();
    is_short = is_short || n > (bytes.size() - at) / size_of_one;
    return is_short ? 0 : std::size_t(n);
  }
};

std::vector<char> packed(const std::vector<Prediction>& answer) {
  std::vector<char> bytes;
  put(bytes, std::uint64_t(answer.size()));
  for (const Prediction& p : answer) {
    put(bytes, p.is_well);
    put(bytes, p.mask_overlap);
    put(bytes, std::uint64_t(p.residual.size()));
    for (const double r : p.residual) put(bytes, r);
    put(bytes, std::uint64_t(p.phase.size()));
    for (const Phase phase : p.phase) put(bytes, phase);
    put(bytes, std::uint64_t(p.touching.size()));
    for (const std::string& pair : p.touching) {
      put(bytes, std::uint64_t(pair.size()));
      bytes.insert(bytes.end(), pair.begin(), pair.end());
    }
  }
  return bytes;
}

std::vector<Prediction> unpacked(Reader& reader) {
  std::vector<Prediction> answer(reader.take_count(1));
  for (Prediction& p : answer) {
    p.is_well = reader.take<bool>();
    p.mask_overlap = reader.take<double>();
    p.residual.resize(Eigen::Index(reader.take_count(sizeof(double))));
    for (double& r : p.residual) r = reader.take<double>();
    p.phase.resize(reader.take_count(sizeof(Phase)));
    for (Phase& phase : p.phase) phase = reader.take<Phase>();
    p.touching.resize(reader.take_count(sizeof(std::uint64_t)));
    for (std::string& pair : p.touching) {
      pair.resize(reader.take_count(1));
      reader.take(pair.data(), pair.size());
    }
  }
  return answer;
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
  Reader reader{std::span<const char>(content_).subspan(at_)};
  const bool is_it = reader.take<std::uint64_t>() == question;
  std::vector<Prediction> answer;
  if (is_it) answer = unpacked(reader);
  if (!is_it || reader.is_short) {
    content_.resize(at_);
    return std::nullopt;
  }
  at_ += reader.at;
  ++n_read_;
  return answer;
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
