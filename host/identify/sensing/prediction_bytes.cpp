#include "host/identify/sensing/prediction_bytes.hpp"

#include <cstdint>
#include <cstring>

namespace pvg::diagnose {
namespace {

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

}  // namespace

std::vector<char> packed(std::span<const Prediction> predictions) {
  std::vector<char> bytes;
  put(bytes, std::uint64_t(predictions.size()));
  for (const Prediction& p : predictions) {
    put(bytes, p.succeeded);
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

std::optional<Unpacked> unpacked(std::span<const char> bytes) {
  Reader reader{bytes};
  Unpacked out;
  out.predictions.resize(reader.take_count(1));
  for (Prediction& p : out.predictions) {
    p.succeeded = reader.take<bool>();
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
  if (reader.is_short) return std::nullopt;
  out.n_bytes = reader.at;
  return out;
}

}  // namespace pvg::diagnose
