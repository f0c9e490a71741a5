// What a prediction depends on, as numbers (Fowler, Noll, Vo's hash): by them a result is found again that is known
// already, in memory or in the journal.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "host/base/hash.hpp"
#include "host/identify/sensing/rollout.hpp"

namespace pvg::diagnose {

// Of one job. Both differ where anything differs on which they depend.
struct Question {
  std::uint64_t motion;  // scene, run, from when to when, start
  std::uint64_t all;     // besides, what is measured of it and with what noise: sensing, samples, phases
};
std::vector<Question> questions_of(const Problem& problem, std::span<const Job> jobs);

std::uint64_t hash_of(std::span<const Question> questions);
std::uint64_t hash_of(std::span<const char> bytes, std::uint64_t so_far = FNV_START);

}  // namespace pvg::diagnose
