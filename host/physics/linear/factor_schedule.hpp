// How a forest of supernodes is divided over launches of the device: a stage is a launch, a task one work-group of it,
// which takes a connected part of the forest from its leaves up.
#pragma once
#include <span>
#include <vector>

#include "shared/types.h"

namespace pvg {

struct FactorSchedule {
  std::vector<u32> stage_first;  // [n_stages + 1] into the tasks; each stage needs the ones before alone
  std::vector<u32> task_first;   // [n_tasks + 1] into `front`
  std::vector<u32> front;        // of each task, children before parents
  double seconds = 0;            // as estimated
  u32 n_stages() const { return u32(stage_first.size() - 1); }
};

// parent: of each front, children before parents; NO_PARENT: a root.  seconds: of one work-group, for each front
// launch: of one launch [s];  n_units: work-groups that run at a time.  The division with the least estimated time
FactorSchedule make_schedule(std::span<const u32> parent, std::span<const double> seconds, double launch,
                             unsigned n_units);

}  // namespace pvg
