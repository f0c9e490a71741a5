// The hidden-effect suite: every case of a folder is diagnosed by a program of its own, which never sees the truth;
// then the scorer reads each case's report.json and truth.json, and nothing else.
#pragma once
#include "pipeline/commands/commands.hpp"

namespace pvg::diagnose {

// Diagnoses the cases that have no report yet, prints the table of scores and writes it into the output folder.
void run_suite(const DiagnoseOptions& options);

}  // namespace pvg::diagnose
