// What a diagnosis has simulated, in the order in which it asked. The workflow does the same each time, so a diagnosis
// that was stopped goes on where it was: the same questions come again, and their answers are read, not simulated.
#pragma once
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <vector>

#include "host/identify/sensing/rollout.hpp"

namespace pvg::diagnose {

class Journal {
 public:
  Journal() = default;  // keeps nothing
  // Reads what is in the file if it was written under the same key; a last answer that was cut short is forgotten.
  Journal(std::filesystem::path file, std::uint64_t key);

  // The next answer, if there is one and it is to this question; else what follows in the file is void.
  std::optional<std::vector<Prediction>> answer_to(std::uint64_t question);
  void add(std::uint64_t question, const std::vector<Prediction>& answer);
  std::size_t n_read() const { return n_read_; }
  void remove();  // the diagnosis is complete

 private:
  std::filesystem::path file_;
  std::vector<char> content_;  // of the file as it was found
  std::size_t at_ = 0, n_read_ = 0;
  std::ofstream out_;
};

// Numbers that differ where what is asked for differs (Fowler, Noll, Vo's hash).
std::uint64_t question_of(std::span<const Job> jobs);
std::uint64_t hash_of(std::span<const char> bytes, std::uint64_t so_far = 14695981039346656037u);

// Of the recording's files, the scene's, the settings' text and this program: with another key nothing is read back.
std::uint64_t journal_key(const Problem& problem, const std::string& settings);

}  // namespace pvg::diagnose
