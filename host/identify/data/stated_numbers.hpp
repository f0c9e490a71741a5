// Numbers of the scene that a recording states: for one run, or with a standard deviation before any data. Their names:
//   body/NAME/mass, joint/NAME/damping, pair/FIRST/SECOND/friction, ..: the rows of scene_numbers.cpp without
//   `retune_`; gravity, contact_stiffness: those of the scene as a whole; gravity may be a vector. Of a run also
//   body/NAME/load, and what the scene file itself says: body/NAME/size, .. (changed_numbers.hpp).
#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "host/load/recording/recording.hpp"
#include "host/model/physical_scene.hpp"

namespace pvg::diagnose {

struct Problem;

// What a run changes in its scene, and in each variant of it.
using SceneChange = std::function<void(PhysicalScene&)>;

// What is known of a number before any data.
struct NumberPrior {
  std::string number, target;  // the row, such as retune_mass, and what has it
  double sigma = 0;            // [the row's unit]
  double value = 0, said = 0;  // stated, and what the scene file says; equal where the recording states none
};

// place: of the list in the file, for messages. Throws a UsageError that names the entry and what to do.
std::vector<SceneChange> scene_changes(const PhysicalScene& scene, const std::filesystem::path& scene_file,
                                       const StatedNumbers& stated, const std::string& place);

// A load that is fastened to a rigid body at its centre of mass [kg].
SceneChange load_on(const std::string& body, double mass);

// Also sets the values in the problem's scene.
void apply_priors(Problem& problem);

}  // namespace pvg::diagnose
