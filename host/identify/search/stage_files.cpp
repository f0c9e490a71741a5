#include "host/identify/search/stage_files.hpp"

#include <fstream>
#include <nlohmann/json.hpp>

#include "host/base/error.hpp"

namespace pvg::diagnose {
namespace {

using json = nlohmann::ordered_json;

void write(const std::filesystem::path& folder, const std::string& name, const json& content) {
  if (folder.empty()) return;
  std::ofstream out(folder / name);
  out << content.dump(2) << "\n";
  if (!out) throw Failure((folder / name).string() + " could not be written");
}

json values_of(const Model& model) {
  json list = json::array();
  Eigen::Index at = 0;
  for (const Candidate* part : model.parts) {
    json one = {{"name", part->name}, {"target", part->target}};
    for (const Parameter& p : part->parameters) one["parameters"][p.name] = model.x[at++];
    list.push_back(one);
  }
  return list;
}

}  // namespace

void StageFiles::write_notes(const std::string& name, const std::vector<std::string>& notes) const {
  write(folder, name, {{"schema", 1}, {"notes", notes}});
}

void StageFiles::write_where(const std::vector<Cell>& cells) const {
  json list = json::array();
  for (const Cell& c : cells)
    list.push_back({{"body", c.body},
                    {"phase", c.phase},
                    {"share", c.share},
                    {"rms", c.rms},
                    {"p_value", c.p_value},
                    {"onset_s", c.onset}});
  write(folder, "3_where.json", {{"schema", 1}, {"where", list}});
}

void StageFiles::write_showable(const std::vector<Showable>& rows) const {
  json list = json::array();
  for (const Showable& row : rows) list.push_back(text_of(row));
  write(folder, "4_identifiability.json", {{"schema", 1}, {"showable", list}});
}

void StageFiles::write_screen(const std::string& round, const std::vector<Screened>& screened) const {
  json list = json::array();
  for (const Screened& s : screened)
    list.push_back({{"candidate", s.candidate->label()},
                    {"gain", s.gain},
                    {"sensitivity", s.sensitivity},
                    {"start", values_of(s.model)}});
  write(folder, "4_screen_" + round + ".json", {{"schema", 1}, {"screened", list}});
}

void StageFiles::write_fits(const std::string& of, const Decision& decision) const {
  json list = json::array();
  for (const Judged& j : decision.ranking)
    list.push_back({{"model", values_of(j.fit->model)},
                    {"left_out_error", j.error},
                    {"better_by", j.better_by},
                    {"better_by_sigma", j.better_sigma},
                    {"excludes_off", j.excludes_off},
                    {"passes", j.passes},
                    {"evidence", j.evidence},
                    {"probability", j.probability}});
  write(folder, "5_fits_" + of + ".json",
        {{"schema", 1}, {"base_error", decision.base_error}, {"chosen", decision.chosen}, {"fits", list}});
}

}  // namespace pvg::diagnose
