// Numbers of the scene file that a run has otherwise: sizes, centres of mass, frames of joints, whatever the file says
// of a body or joint. body/NAME/KEYS and joint/NAME/KEYS are keys of its entry, one within the other; those of `shape`
// need not name the shape: body/bar/size. contact/KEY are those of the contact.
#pragma once
#include <filesystem>
#include <string>

#include "host/identify/data/stated_numbers.hpp"

namespace pvg::diagnose {

// Whether the key is one of the scene file's.
bool is_of_scene_file(const std::filesystem::path& scene_file, const std::string& key);

// All of them at once. What the changed file has otherwise is changed in each variant of the scene: masses and moments
// of inertia by their ratio, so that a variant's own stay. list: where, for messages. Throws a UsageError.
SceneChange change_of_file(const std::filesystem::path& scene_file, const StatedNumbers& stated,
                           const std::string& list);

}  // namespace pvg::diagnose
