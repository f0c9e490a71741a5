// Channels with a clock of their own: other files, other rates, other columns of times, and what is known of their
// delay.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "host/base/error.hpp"
#include "host/load/recording/channels.hpp"

namespace pvg {
namespace {

constexpr double SAME_INSTANT = 1e-9;  // rounding of times [s]

struct Series {
  std::string column;               // of the run's table
  std::vector<double> time, value;  // [n] each, times of the run's clock [s]
};

MeasuredTable table_of(const std::filesystem::path& file, const std::vector<std::string>& columns) {
  MeasuredTable table = read_columns_of(file, columns);
  for (const std::string& column : columns) table[column];  // a UsageError where it is missing
  return table;
}

// The times that a channel's samples are stamped with, in the run's clock.
std::vector<double> times_in(const MeasuredTable& table, const ChannelClock& clock) {
  const std::string name = clock.time.empty() ? "t" : clock.time;
  std::vector<double> times;
  for (const double stamped : table[name]) {
    const double time = (1 + clock.rate) * stamped + clock.offset - clock.latency;
    const std::string row =
        table.file.string() + ": the time `" + name + "` of row " + std::to_string(times.size() + 1);
    if (!std::isfinite(time)) throw UsageError(row + " is missing");
    if (!times.empty() && !(time > times.back())) throw UsageError(row + " does not come after the one before");
    times.push_back(time);
  }
  return times;
}

// As its file and its clock say, without what the run does not reach: before its first row nothing was commanded.
void read_series(const RecordedChannel& channel, const RecordedRun& run, std::vector<Series>& series) {
  const ChannelClock& clock = channel.clock;
  const double begin = run.table["t"].front(), end = run.table["t"].back();
  std::vector<std::string> asked = channel.written;
  asked.push_back(clock.time.empty() ? "t" : clock.time);
  const MeasuredTable table = table_of(clock.file.empty() ? run.table.file : beside_table(run, clock.file), asked);
  const std::vector<double> times = times_in(table, clock);
  if (times.empty()) throw UsageError(table.file.string() + " holds no rows; a channel needs at least 2");
  for (std::size_t k = 0; k < channel.written.size(); ++k) {
    Series one{channel.columns[k], {}, {}};
    const std::vector<double>& values = table[channel.written[k]];
    for (std::size_t i = 0; i < times.size(); ++i) {
      if (times[i] < begin - SAME_INSTANT || times[i] > end + SAME_INSTANT) continue;
      one.time.push_back(std::clamp(times[i], begin, end));
      one.value.push_back(values[i]);
    }
    if (one.time.size() < 2)
      throw UsageError(table.file.string() + ": its times go from " + std::to_string(times.front()) + " to " +
                       std::to_string(times.back()) + " s, those of " + run.table.file.string() + " from " +
                       std::to_string(begin) + " to " + std::to_string(end) +
                       " s; both must show the same clock, or `clock: {offset: ..}` its difference");
    series.push_back(std::move(one));
  }
}

// All times, those of one instant once.
std::vector<double> union_of(std::vector<double> times, const std::vector<Series>& series) {
  for (const Series& one : series) times.insert(times.end(), one.time.begin(), one.time.end());
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end(), [](double a, double b) { return b - a < SAME_INSTANT; }),
              times.end());
  return times;
}

// Which of `all` each time is.
std::vector<std::size_t> rows_of(const std::vector<double>& times, const std::vector<double>& all) {
  std::vector<std::size_t> rows;
  for (const double time : times)
    rows.push_back(std::size_t(std::lower_bound(all.begin(), all.end(), time - SAME_INSTANT) - all.begin()));
  return rows;
}

template <class T>
std::vector<T> spread(const std::vector<T>& values, const std::vector<std::size_t>& rows, std::size_t n, T gap) {
  std::vector<T> out(n, gap);
  for (std::size_t i = 0; i < rows.size(); ++i) out[rows[i]] = values[i];
  return out;
}

}  // namespace

std::filesystem::path beside_table(const RecordedRun& run, std::string name) {
  const std::string token = "{run}";
  if (const std::size_t at = name.find(token); at != std::string::npos)
    name.replace(at, token.size(), run.table.file.stem().string());
  return run.table.file.parent_path() / name;
}

std::string column_of(const ChannelClock& clock, const std::string& written) {
  if (clock.is_that_of_run()) return written;
  std::string name = (clock.file.empty() ? "" : clock.file + ": ") + written;
  if (!clock.time.empty()) name += " over " + clock.time;
  for (const auto& [what, value] : {std::pair("latency", clock.latency), {"offset", clock.offset}}) {
    if (value == 0) continue;
    char text[60];
    std::snprintf(text, sizeof text, ", %s %.6g s", what, value);
    name += text;
  }
  if (clock.rate != 0) name += ", rate " + std::to_string(clock.rate);
  return name;
}

void add_channels_with_clocks(const Recording& recording, RecordedRun& run) {
  std::vector<Series> series;
  for (const RecordedChannel& channel : recording.channels)
    if (!channel.clock.is_that_of_run()) read_series(channel, run, series);
  if (series.empty()) return;
  const std::vector<double> before = run.table["t"], all = union_of(before, series);
  const std::vector<std::size_t> rows = rows_of(before, all);
  for (auto& [name, values] : run.table.columns) values = spread(values, rows, all.size(), std::nan(""));
  for (RecordedMasks& masks : run.masks) masks.frame_of_row = spread(masks.frame_of_row, rows, all.size(), -1);
  for (RecordedVideo& video : run.videos) video.frame_of_row = spread(video.frame_of_row, rows, all.size(), -1);
  for (const Series& one : series)
    run.table.columns[one.column] = spread(one.value, rows_of(one.time, all), all.size(), std::nan(""));
  run.table.columns["t"] = all;
  run.table.n_rows = all.size();
}

}  // namespace pvg
