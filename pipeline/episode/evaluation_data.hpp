// What the page of an evaluation shows (data/view/evaluation.js).
#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>

namespace pvg {

// A file that `evaluate policy --json` printed, as "evaluation", its name as "file" and its videos as they are inside
// a page as "videos": [{name, source}]. A UsageError names file and key where it is none, or where a video is gone.
nlohmann::ordered_json evaluation_report(const std::filesystem::path& file);

}  // namespace pvg
