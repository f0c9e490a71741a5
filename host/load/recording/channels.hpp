// The parts of reading a recording that depend on the kind of a channel.
#pragma once
#include "host/load/fields/yaml_section.hpp"
#include "host/load/recording/recording.hpp"

namespace pvg {

// The names of one column, or of several.
std::vector<std::string> read_columns(YamlSection& section);

// Adds the channels of one entry of `channels`: one of a table's columns, or one per number of a picture.
void read_channel(YamlSection& section, Recording& recording);

// Reads the pictures of a run and adds their numbers to its table, as columns.
void add_pictures(const Recording& recording, RecordedRun& run);

// The column that holds a number of the pictures.
std::string column_of(const MaskSource& masks, std::size_t moment);
std::string column_of(const VideoSource& video, std::size_t cell);

}  // namespace pvg
