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

// Reads what the channels with a clock of their own measured in a run. Its table then has a row for each time of any
// clock within its span; what was not measured then is a gap.
void add_channels_with_clocks(const Recording& recording, RecordedRun& run);

// The column of a run's table that holds what a channel with a clock of its own measured.
std::string column_of(const ChannelClock& clock, const std::string& written);

// The file of a run beside its table: {run} is replaced by the table's name without its ending.
std::filesystem::path beside_table(const RecordedRun& run, std::string name);

// The column that holds a number of the pictures.
std::string column_of(const MaskSource& masks, std::size_t moment);
std::string column_of(const VideoSource& video, std::size_t cell);

}  // namespace pvg
