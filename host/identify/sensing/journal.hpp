// What a diagnosis has simulated, in the order in which it asked. The workflow does the same each time, so a diagnosis
// that was stopped goes on where it was: the same questions come again, and their results are read, not simulated.
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
  // Reads what is in the file if it was written under the same key; a last result that was cut short is forgotten.
  Journal(std::filesystem::path file, std::uint64_t key);

  // The next result, if there is one and it is to this question; else what follows in the file is void.
  std::optional<std::vector<Prediction>> result_for(std::uint64_t question);
  void add(std::uint64_t question, const std::vector<Prediction>& result);
  void set_read_only() { is_read_only_ = true; }  // a question that is not in the file ends the diagnosis
  bool is_read_only() const { return is_read_only_; }
  std::size_t n_read() const { return n_read_; }
  void remove();  // the diagnosis is complete

 private:
  std::filesystem::path file_;
  std::vector<char> content_;  // of the file as it was found
  std::size_t at_ = 0, n_read_ = 0;
  std::ofstream out_;
  bool is_read_only_ = false;
};

// Of the recording's files, the scene's and what was read of those that it names, the settings' text and this program:
// with another key nothing is read back.
std::uint64_t journal_key(const Problem& problem, const std::string& settings);

}  // namespace pvg::diagnose
