#include "pipeline/episode/frames_under_way.hpp"

#include <string>

namespace pvg {

void FramesUnderWay::begin(std::uint64_t episode, std::size_t n_frames) {
  const std::lock_guard lock(mutex_);
  frames_[episode] = {0, n_frames};
  show_anew();
}

void FramesUnderWay::advance(std::uint64_t episode, std::size_t done) {
  const std::lock_guard lock(mutex_);
  frames_[episode].done = done;
  progress_.advance_to(sum().done);
}

void FramesUnderWay::end(std::uint64_t episode) {
  const std::lock_guard lock(mutex_);
  frames_.erase(episode);
  if (!frames_.empty()) show_anew();
}

FramesUnderWay::Frames FramesUnderWay::sum() const {
  Frames all;
  for (const auto& [episode, frames] : frames_) {
    all.done += frames.done;
    all.total += frames.total;
  }
  return all;
}

void FramesUnderWay::show_anew() {
  std::string label = frames_.size() == 1 ? "episode" : "episodes";
  for (const auto& [episode, frames] : frames_)
    label += (label.back() == 's' || label.back() == 'e' ? " " : ", ") + std::to_string(episode);
  const Frames all = sum();
  progress_.begin(label, all.total, all.done);
}

}  // namespace pvg
