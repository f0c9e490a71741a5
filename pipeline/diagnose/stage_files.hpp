// What each stage found, as JSON in the folder of the report.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/diagnose/decide.hpp"
#include "pipeline/diagnose/localise.hpp"
#include "pipeline/diagnose/screen.hpp"

namespace pvg::diagnose {

struct StageFiles {
  std::filesystem::path folder;  // empty: nothing is written
  void write_notes(const std::string& name, const std::vector<std::string>& notes) const;
  void write_where(const std::vector<Cell>& cells) const;
  void write_screen(const std::string& round, const std::vector<Screened>& screened) const;
  void write_fits(const std::string& of, const Decision& decision) const;
};

}  // namespace pvg::diagnose
