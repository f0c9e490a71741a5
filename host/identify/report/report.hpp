// Stage 7: what was found, for people and for machines.
#pragma once
#include <filesystem>
#include <string>

#include "host/identify/search/diagnosis.hpp"

namespace YAML {
class Node;
}

namespace pvg::diagnose {

// "missing: joint_coulomb_friction at hinge, effort 0.18 +- 0.01 N m; the held-out error falls from 41 to 3.2 mrad,
// ..."
std::string sentence_of(const Diagnosis& diagnosis);

// report.json, report.html and scene_amended.yaml in `folder`. Sets the diagnosis' sentence.
void write_report(const Problem& problem, Diagnosis& diagnosis, const std::filesystem::path& folder);

// report_html.cpp
std::string html_of(const Problem& problem, const Diagnosis& diagnosis);

// amend.cpp: the scene file with the named effects, as text that `phyvisgen simulate` reads from `folder`.
std::string amended_scene(const Problem& problem, const Diagnosis& diagnosis, const std::filesystem::path& folder);

// next_scene.cpp: the scene file with the commands and starts of the next experiment, likewise. What the
// file does not say itself, such as the joints of a robot's own file, is left as it is.
std::string next_scene(const Problem& problem, const Diagnosis& diagnosis, const std::filesystem::path& folder);

// The same motion as JSON: seconds, initial (as a run states it), commands {joint/NAME: {time, value}}, set.
std::string next_run(const Problem& problem, const PlannedMotion& motion);

// The scene file with its paths relative to `folder`.
YAML::Node scene_file_in(const Problem& problem, const std::filesystem::path& folder);

// A number with three significant digits.
std::string shown(double value);

}  // namespace pvg::diagnose
