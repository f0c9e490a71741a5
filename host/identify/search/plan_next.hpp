// The end of a diagnosis: which motion would separate the names that are still confused.
#pragma once
#include "host/identify/search/diagnosis.hpp"

namespace pvg::diagnose {

struct Workflow;

// Sets the next experiment of `d` if names are confused, or if it is asked for. Where none is found the notes say so.
void plan_next(Workflow& flow, Device& device, Diagnosis& d);

}  // namespace pvg::diagnose
