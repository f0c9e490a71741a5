// The hidden-effect suite: every case of a folder is diagnosed by a program of its own, which never sees the truth;
// then the scorer reads each case's report.json and truth.json, and nothing else.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace pvg {

struct HiddenSuite {
  std::filesystem::path cases, reports;  // folders
  std::vector<std::string> options;      // of `diagnose`, for every case
  int n_jobs = 1;                        // cases at once
  bool as_json = false;
};

// Diagnoses the cases that have no report yet, prints the table of scores and writes it into the folder of reports.
void run_hidden_suite(const HiddenSuite& suite);

}  // namespace pvg
