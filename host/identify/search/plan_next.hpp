// The end of a diagnosis, after its report: which motion would separate the names that are still confused.
#pragma once
#include "host/identify/search/diagnosis.hpp"

namespace pvg::diagnose {

// Whether names are confused, or it is asked for, so that plan_next has something to do.
bool wants_next(const Settings& settings, const Diagnosis& d);

// Sets the next experiment of `d`, in the share time_next of the minutes, and before they are over. Where none is found
// the notes, or what was left out, say so.
void plan_next(Device& device, const Problem& problem, const Settings& settings, Diagnosis& d);

}  // namespace pvg::diagnose
