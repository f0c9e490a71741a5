#include "host/identify/sensing/known_predictions.hpp"

namespace pvg::diagnose {

const Prediction* KnownPredictions::find(std::uint64_t question) const {
  const auto at = known_.find(question);
  return at == known_.end() ? nullptr : &at->second;
}

void KnownPredictions::add(std::span<const Question> questions, std::vector<Prediction> predictions) {
  for (std::size_t i = 0; i < questions.size(); ++i) {
    const auto [at, is_new] = known_.try_emplace(questions[i].all, std::move(predictions[i]));
    if (!is_new) continue;
    order_.push_back(questions[i].all);
    n_numbers_ += std::size_t(at->second.residual.size());
  }
  while (n_numbers_ > MOST_NUMBERS) {
    const auto oldest = known_.find(order_.front());
    n_numbers_ -= std::size_t(oldest->second.residual.size());
    known_.erase(oldest);
    order_.pop_front();
  }
}

}  // namespace pvg::diagnose
