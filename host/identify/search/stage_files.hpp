// What each stage found, as JSON in the folder of the report.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "host/identify/search/decide.hpp"
#include "host/identify/search/identifiability.hpp"
#include "host/identify/search/localise.hpp"
#include "host/identify/search/screen.hpp"

namespace pvg::diagnose {

struct StageFiles {
  std::filesystem::path folder;  // empty: nothing is written
  void write_notes(const std::string& name, const std::vector<std::string>& notes) const;
  void write_where(const std::vector<Cell>& cells) const;
  void write_showable(const std::vector<Showable>& rows) const;
  void write_screen(const std::string& round, const std::vector<Screened>& screened) const;
  void write_fits(const std::string& of, const Decision& decision) const;
};

}  // namespace pvg::diagnose
