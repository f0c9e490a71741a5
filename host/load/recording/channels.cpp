// The entries of `channels`: one row of keys per kind.
#include "host/load/recording/channels.hpp"

#include <charconv>
#include <cmath>

#include "host/base/counted.hpp"
#include "host/load/read_sections.hpp"
#include "host/pictures/mask_metrics.hpp"
#include "host/pictures/picture_cells.hpp"

namespace pvg {
namespace {

constexpr double MOST_LATE = 10, MOST_APART = 1e10;  // of a channel's clock [s]; seconds since 1970 are 2e9

struct ChannelKeys {
  ChannelKind kind;
  const char* other_name;    // accepted beside the name of the list
  bool has_joint, has_body;  // what it may be measured of
  std::size_t n_columns;     // of a body without `axis`
  bool has_point;            // `point` or `vertex` may be given
  bool needs_point;          // and must
  void (*read)(YamlSection&, const ChannelKeys&, Recording&);
};

// one sigma, or unknown
double read_noise(YamlSection& section) {
  const std::string text = section.text("noise", "unknown");
  if (text == "unknown") return -1;
  double value = 0;
  const char* end = text.data() + text.size();
  if (std::from_chars(text.data(), end, value).ptr != end || !(value > 0) || !std::isfinite(value))
    section.fail("noise", "must be one sigma in the channel's unit, above 0, or `unknown`");
  return value;
}

// one channel for each moment of a mask
void read_masks(YamlSection& section, const ChannelKeys&, Recording& recording) {
  const int source = int(recording.mask_sources.size());
  recording.mask_sources.push_back({section.text("file"), section.text("camera"), section.text("part")});
  section.done();
  const MaskSource& masks = recording.mask_sources.back();
  for (std::size_t moment = 0; moment < N_MASK_MOMENTS; ++moment) {
    RecordedChannel channel;
    channel.kind = ChannelKind::mask;
    channel.source = source;
    channel.part = int(moment);
    channel.columns = {column_of(masks, moment)};
    recording.channels.push_back(std::move(channel));
  }
}

// one channel for each cell of the pictures
void read_video(YamlSection& section, const ChannelKeys&, Recording& recording) {
  VideoSource video{section.text("file"), section.text("camera")};
  for (const VideoSource& other : recording.video_sources)
    if (other.camera == video.camera) section.fail("camera", "has a video above; give one per camera");
  if (section.has("frames_per_second"))
    video.frames_per_second = section.number("frames_per_second", Unit::none, 1e-3, 1e6);
  if (section.has("first_frame")) {
    if (video.frames_per_second == 0) section.fail("first_frame", "needs `frames_per_second` beside it");
    video.first_frame = section.number("first_frame", Unit::time, -1e6, 1e6);
  }
  const double noise = read_noise(section);
  section.done();
  for (std::size_t cell = 0; cell < N_PICTURE_CELLS; ++cell) {
    RecordedChannel channel;
    channel.kind = ChannelKind::video;
    channel.source = int(recording.video_sources.size());
    channel.part = int(cell);
    channel.noise = noise;
    channel.columns = {column_of(video, cell)};
    recording.channels.push_back(std::move(channel));
  }
  recording.video_sources.push_back(std::move(video));
}

// where and when it was written, if not in the run's table
ChannelClock read_clock(YamlSection& section) {
  ChannelClock clock;
  clock.file = section.text("file", "");
  clock.time = section.text("time", "");
  clock.latency = section.number("latency", Unit::time, -MOST_LATE, MOST_LATE, 0);
  clock.jitter = section.number("jitter", Unit::time, 0, MOST_LATE, 0);
  if (!section.has("clock")) return clock;
  YamlSection shown = section.section("clock");
  clock.offset = shown.number("offset", Unit::time, -MOST_APART, MOST_APART, 0);
  clock.rate = shown.number("rate", Unit::none, 0.5, 2, 1) - 1;
  shown.done();
  return clock;
}

// The directions of several columns, such as [x, z].
std::vector<Vec3> read_axes(YamlSection& section) {
  std::vector<Vec3> axes;
  if (!section.has("axes")) return axes;
  if (section.has("axis")) section.fail("axes", "stands beside `axis`; leave one of them away");
  for (const std::string& name : section.texts("axes")) {
    const std::size_t k = std::string("xyz").find(name);
    if (name.size() != 1 || k == std::string::npos)
      section.fail("axes",
                   "must hold names of the world's axes, such as [x, z]; a single other direction is an `axis`");
    axes.push_back(Vec3::Unit(Eigen::Index(k)));
  }
  return axes;
}

Readout read_readout(YamlSection& section) {
  Readout readout;
  if (section.has("filter")) {
    YamlSection filter = section.section("filter");
    readout.low_pass = filter.number("low_pass", Unit::frequency, 1e-3, 1e6);
    filter.done();
  }
  readout.resolution = section.number("resolution", Unit::none, 0, 1e12, 0);
  if (!section.has("saturation")) return readout;
  const std::vector<double> ends = section.numbers("saturation", Unit::none, -1e12, 1e12);
  if (ends.size() != 2 || !(ends[0] < ends[1]))
    section.fail("saturation", "must be the lowest and the highest reading, such as [-10, 10]");
  readout.lowest = ends[0];
  readout.highest = ends[1];
  return readout;
}

void read_columns_of_table(YamlSection& section, const ChannelKeys& keys, Recording& recording);

// the other end of a distance; without `point` an end is its body's origin
void read_distance(YamlSection& section, const ChannelKeys& keys, Recording& recording) {
  YamlSection to = section.section("to");
  const std::string body = to.text("body");
  const Vec3 point = to.vector("point", Unit::length, -REACH, REACH, Vec3::Zero());
  to.done();
  read_columns_of_table(section, keys, recording);
  recording.channels.back().other_body = body;
  recording.channels.back().other_point = point;
}

void read_current(YamlSection& section, const ChannelKeys& keys, Recording& recording) {
  const std::string constant = section.text("constant");
  read_columns_of_table(section, keys, recording);
  recording.channels.back().constant = constant;
}

void read_contact(YamlSection& section, const ChannelKeys& keys, Recording& recording) {
  const std::string with = section.text("with", "");
  const double threshold = section.number("threshold", Unit::force, 1e-6, 1e6, 0.1);
  if (read_noise(section) < 0)
    section.fail("noise",
                 "of a contact cannot be measured; give it, such as 0.2 where a fifth of a reading is nothing");
  read_columns_of_table(section, keys, recording);
  recording.channels.back().other_body = with;
  recording.channels.back().threshold = threshold;
}

constexpr ChannelKeys KEYS[] = {
    // kind                     other name  joint  body   columns  point  needed
    {ChannelKind::position, nullptr, true, true, 3, false, false, read_columns_of_table},
    {ChannelKind::rate, "velocity", true, true, 3, false, false, read_columns_of_table},
    {ChannelKind::torque, "effort", true, true, 3, false, false, read_columns_of_table},
    {ChannelKind::orientation, nullptr, false, true, 4, false, false, read_columns_of_table},
    {ChannelKind::marker, nullptr, false, true, 3, true, true, read_columns_of_table},
    {ChannelKind::force, nullptr, true, true, 3, false, false, read_columns_of_table},
    {ChannelKind::mask, nullptr, false, false, 0, false, false, read_masks},
    {ChannelKind::video, nullptr, false, false, 0, false, false, read_video},
    {ChannelKind::angular_velocity, nullptr, false, true, 3, false, false, read_columns_of_table},
    {ChannelKind::gyroscope, nullptr, false, true, 3, false, false, read_columns_of_table},
    {ChannelKind::accelerometer, nullptr, false, true, 3, true, false, read_columns_of_table},
    {ChannelKind::distance, nullptr, false, true, 1, true, false, read_distance},
    {ChannelKind::current, nullptr, true, false, 1, false, false, read_current},
    {ChannelKind::contact, nullptr, false, true, 1, false, false, read_contact},
};

constexpr bool is_in_order() {
  for (std::size_t i = 0; i < std::size(KEYS); ++i)
    if (KEYS[i].kind != ChannelKind(i)) return false;
  return std::size(KEYS) == N_CHANNEL_KINDS;
}
static_assert(is_in_order(), "each kind of PVG_CHANNEL_KINDS has one row of keys, in its order");

// "position, rate or torque": the names of the kinds that have something
std::string names_of(bool ChannelKeys::*has) {
  std::vector<std::string> names;
  for (const ChannelKeys& keys : KEYS)
    if (keys.*has) names.push_back(kind_name(keys.kind));
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i)
    text += (i == 0 ? "" : i + 1 < names.size() ? ", " : " or ") + names[i];
  return text;
}

std::vector<std::string> all_names() {
  std::vector<std::string> names(std::begin(CHANNEL_KIND_NAMES), std::end(CHANNEL_KIND_NAMES));
  for (const ChannelKeys& keys : KEYS)
    if (keys.other_name != nullptr) names.push_back(keys.other_name);
  return names;
}

const ChannelKeys& keys_named(const std::string& name) {
  for (const ChannelKeys& keys : KEYS)
    if (name == kind_name(keys.kind) || (keys.other_name != nullptr && name == keys.other_name)) return keys;
  throw std::logic_error("no kind of channel is called " + name);
}

void read_columns_of_table(YamlSection& section, const ChannelKeys& keys, Recording& recording) {
  RecordedChannel channel;
  channel.kind = keys.kind;
  channel.columns = read_columns(section);
  channel.joint = section.text("joint", "");
  channel.body = section.text("body", "");
  if (channel.joint.empty() == channel.body.empty()) section.fail("", "must name either a `joint` or a `body`");
  channel.unit = section.text("unit", "");
  if (section.has("point")) channel.point = section.vector("point", Unit::length, -REACH, REACH);
  if (section.has("vertex")) channel.vertex = section.integer("vertex", 0, 100000000);
  const std::vector<Vec3> axes = read_axes(section);
  if (section.has("axis")) {
    channel.axis = section.vector("axis", Unit::none, -1e6, 1e6);
    if (!(channel.axis->norm() > 1e-9)) section.fail("axis", "must not have the length zero");
    channel.axis->normalize();
  }
  channel.noise = read_noise(section);
  if (keys.has_point && (channel.point && channel.vertex >= 0))
    section.fail("", "has both a `point` and a `vertex`; leave one of them away");
  if (keys.needs_point && !channel.point && channel.vertex < 0)
    section.fail("", std::string("is a ") + kind_name(keys.kind) +
                         " and needs either `point`, its rest position in the body's frame, or `vertex`");
  if (!keys.has_point && (channel.point || channel.vertex >= 0))
    section.fail("", "has a `point` or `vertex`, which only the kind `" + names_of(&ChannelKeys::has_point) + "` has");
  const bool is_of_joint = !channel.joint.empty();
  if (is_of_joint && !keys.has_joint) section.fail("kind", "of a joint must be " + names_of(&ChannelKeys::has_joint));
  if (!is_of_joint && !keys.has_body) section.fail("kind", "of a body must be " + names_of(&ChannelKeys::has_body));
  // what a joint transmits is a vector: its force, and its torque where more than the drive's effort is measured
  const bool is_wrench =
      keys.kind == ChannelKind::force || (keys.kind == ChannelKind::torque && channel.columns.size() > 1);
  const bool is_one = channel.axis || (is_of_joint && !is_wrench);
  const std::size_t n = is_one ? 1 : axes.empty() ? keys.n_columns : axes.size();
  if (channel.columns.size() != n)
    section.fail(section.has("column") ? "column" : "columns",
                 "must name " + counted(n, "column") +
                     (n == 3 ? "; fewer are enough where `axis` or `axes` give their directions" : ""));
  channel.clock = read_clock(section);
  if (channel.clock.jitter > 0 && channel.noise < 0)
    section.fail("jitter", "needs a number for `noise` beside it: noise that is measured has the jitter in it");
  channel.readout = read_readout(section);
  const bool is_readout_of_numbers = keys.n_columns != 4;
  if (!is_readout_of_numbers && (channel.readout.low_pass > 0 || std::isfinite(channel.readout.highest)))
    section.fail("", "is an orientation, whose numbers a filter or a saturation cannot be stated of");
  section.done();
  if (!channel.clock.is_that_of_run()) {
    channel.written = channel.columns;
    for (std::string& column : channel.columns) column = column_of(channel.clock, column);
  }
  for (std::size_t k = 0; k < axes.size(); ++k) {  // one channel for each direction
    RecordedChannel part = channel;
    part.columns = {channel.columns[k]};
    if (!channel.written.empty()) part.written = {channel.written[k]};
    part.axis = axes[k];
    recording.channels.push_back(std::move(part));
  }
  if (axes.empty()) recording.channels.push_back(std::move(channel));
}

}  // namespace

const char* kind_name(ChannelKind kind) { return CHANNEL_KIND_NAMES[std::size_t(kind)]; }

std::vector<std::string> read_columns(YamlSection& section) {
  if (section.has("column") == section.has("columns"))
    section.fail("", "must have either `column`, one name, or `columns`, a list of names");
  return section.has("column") ? std::vector<std::string>{section.text("column")} : section.texts("columns");
}

void read_channel(YamlSection& section, Recording& recording) {
  const std::vector<std::string> names = all_names();
  const ChannelKeys& keys = keys_named(names[section.choice("kind", names)]);
  keys.read(section, keys, recording);
}

}  // namespace pvg
