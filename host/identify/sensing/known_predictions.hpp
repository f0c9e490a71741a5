// The last predictions, by the hash of their question: what is asked again is not simulated again. Steps of a fit ask
// again for windows whose start a correction leaves as it is, and for the model where they began.
#pragma once
#include <cstdint>
#include <deque>
#include <span>
#include <unordered_map>
#include <vector>

#include "host/identify/sensing/question.hpp"

namespace pvg::diagnose {

class KnownPredictions {
 public:
  const Prediction* find(std::uint64_t question) const;  // null: not known, or forgotten
  // Forgets the oldest ones beyond MOST_NUMBERS.
  void add(std::span<const Question> questions, std::vector<Prediction> predictions);
  std::size_t n_numbers() const { return n_numbers_; }

  static constexpr std::size_t MOST_NUMBERS = 8'000'000;  // residuals, 64 MB

 private:
  std::unordered_map<std::uint64_t, Prediction> known_;
  std::deque<std::uint64_t> order_;  // in which they came
  std::size_t n_numbers_ = 0;
};

}  // namespace pvg::diagnose
