// What the machine gives to OpenCL drivers: memory, and a folder for what they compile.
#pragma once
#include <cstdint>

namespace pvg {

// Memory of the machine, or of the container where that has less [bytes].
std::uint64_t memory_of_machine();

// PoCL finds no device where it cannot write compiled kernels, as in containers without a HOME that can be written to:
// it is given a folder for temporary files then, and a note says so. Does nothing after the first call.
void find_cache_folder();

}  // namespace pvg
