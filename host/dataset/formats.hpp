// The formats of data sets that `pack` writes: one list. A format is a row in formats.cpp and a file with its writer.
#pragma once
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <string>

#include "host/dataset/packed_episode.hpp"
#include "host/formats/parquet_tables.hpp"

namespace pvg {

// What a writer may need to begin.
struct PackRequest {
  std::filesystem::path folder;            // exists and is empty
  const PackedSet& set;                    // what all episodes have in common
  std::string instruction;                 // what the robot is told to do; empty: the task's name in words
  nlohmann::ordered_json origin;           // where the episodes come from
  bool has_environment = false;            // poses of the objects are written, too, by formats that hold them
  std::function<ParquetTables&()> tables;  // starts the program that writes Parquet files when it is first called
};

struct DataSetFormat {
  const char* name;     // of `pack --format`
  const char* meaning;  // for its help
  bool holds_states;    // poses of objects as observations; episodes without pictures
  std::unique_ptr<DataSetWriter> (*make_writer)(const PackRequest& request);
};

std::span<const DataSetFormat> data_set_formats();
// Throws a UsageError that lists the names where none is called so.
const DataSetFormat& data_set_format(const std::string& name);

}  // namespace pvg
