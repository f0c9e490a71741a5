// The line of the terminal that tells of the episodes under way, their frames together.
#pragma once
#include <cstdint>
#include <map>
#include <mutex>

#include "host/base/progress.hpp"

namespace pvg {

// May be called by the threads of several episodes.
class FramesUnderWay {
 public:
  explicit FramesUnderWay(Progress& progress) : progress_(progress) {}
  void begin(std::uint64_t episode, std::size_t n_frames);  // 0: not known yet
  void advance(std::uint64_t episode, std::size_t done);
  void end(std::uint64_t episode);

 private:
  struct Frames {
    std::size_t done = 0, total = 0;
  };
  Frames sum() const;
  void show_anew();

  std::mutex mutex_;
  std::map<std::uint64_t, Frames> frames_;
  Progress& progress_;
};

}  // namespace pvg
