// A checkpoint as an HDF5 file: everything that the next step depends on beside the scene, bit for bit.
// One data set per field, named as in host/model/checkpoint.hpp; attributes: schema, scene (its file's text).
#pragma once
#include <filesystem>
#include <string>

#include "host/model/checkpoint.hpp"

namespace pvg {

struct SavedCheckpoint {
  Checkpoint checkpoint;
  std::string scene;  // text of the scene file that it came from
};

// Written beside its final name first, so that a file of this name is always whole.
void write_checkpoint(const std::filesystem::path& path, const SavedCheckpoint& saved);

// Throws a UsageError naming the file where it is not a checkpoint.
SavedCheckpoint read_checkpoint(const std::filesystem::path& path);

}  // namespace pvg
