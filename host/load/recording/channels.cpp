// The entries of `channels`: one row of keys per kind.
#include "host/load/recording/channels.hpp"

#include <charconv>
#include <cmath>

#include "host/load/read_sections.hpp"
#include "host/pictures/mask_metrics.hpp"
#include "host/pictures/picture_cells.hpp"

namespace pvg {
namespace {

struct ChannelKeys {
  ChannelKind kind;
  const char* other_name;    // accepted beside the name of the list
  bool has_joint, has_body;  // what it may be measured of
  std::size_t n_columns;     // of a body without `axis`
  bool has_point;            // `point` or `vertex`
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

void read_columns_of_table(YamlSection& section, const ChannelKeys& keys, Recording& recording);

constexpr ChannelKeys KEYS[] = {
    // kind                     other name  joint  body   columns  point
    {ChannelKind::position, nullptr, true, true, 3, false, read_columns_of_table},
    {ChannelKind::rate, "velocity", true, false, 1, false, read_columns_of_table},
    {ChannelKind::torque, "effort", true, false, 1, false, read_columns_of_table},
    {ChannelKind::orientation, nullptr, false, true, 4, false, read_columns_of_table},
    {ChannelKind::marker, nullptr, false, true, 3, true, read_columns_of_table},
    {ChannelKind::force, nullptr, false, true, 3, false, read_columns_of_table},
    {ChannelKind::mask, nullptr, false, false, 0, false, read_masks},
    {ChannelKind::video, nullptr, false, false, 0, false, read_video},
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
  if (section.has("axis")) {
    channel.axis = section.vector("axis", Unit::none, -1e6, 1e6);
    if (!(channel.axis->norm() > 1e-9)) section.fail("axis", "must not have the length zero");
    channel.axis->normalize();
  }
  channel.noise = read_noise(section);
  if (keys.has_point && channel.point.has_value() == (channel.vertex >= 0))
    section.fail("", std::string("is a ") + kind_name(keys.kind) +
                         " and needs either `point`, its rest position in the body's frame, or `vertex`");
  if (!keys.has_point && (channel.point || channel.vertex >= 0))
    section.fail("", "has a `point` or `vertex`, which only the kind `" + names_of(&ChannelKeys::has_point) + "` has");
  const bool is_of_joint = !channel.joint.empty();
  if (is_of_joint && !keys.has_joint) section.fail("kind", "of a joint must be " + names_of(&ChannelKeys::has_joint));
  if (!is_of_joint && !keys.has_body) section.fail("kind", "of a body must be " + names_of(&ChannelKeys::has_body));
  const std::size_t n = is_of_joint || channel.axis ? 1 : keys.n_columns;
  if (channel.columns.size() != n)
    section.fail(section.has("column") ? "column" : "columns",
                 "must name " + std::to_string(n) + (n == 1 ? " column" : " columns") +
                     (n == 3 ? "; one is enough where `axis` gives its direction" : ""));
  section.done();
  recording.channels.push_back(std::move(channel));
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
