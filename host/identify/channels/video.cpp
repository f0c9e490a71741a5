// The luminance of one cell of a camera's picture (host/pictures/picture_cells.hpp).
#include "host/identify/channels/prediction.hpp"
#include "host/identify/channels/resolve.hpp"
#include "host/pictures/picture_cells.hpp"

namespace pvg::diagnose {
namespace {

Resolved resolve(const ChannelPlace& where, const RecordedChannel& recorded) {
  const VideoSource& source = where.recording.video_sources[std::size_t(recorded.source)];
  check_camera({where.recording, where.scene, where.seen, where.recording.file.string() + ": a video"}, source.camera,
               "pictures", [&](const RecordedRun& run) {
                 const RecordedVideo& video = run.videos[std::size_t(recorded.source)];
                 return std::pair(video.width, video.height);
               });
  Channel channel;
  channel.source = recorded.source;
  channel.part = recorded.part;
  channel.name = recorded.columns[0];
  channel.subject = "what " + source.camera + " sees";
  channel.unit = "1";
  channel.is_noise_known = recorded.noise > 0;
  channel.sigma = channel.is_noise_known ? recorded.noise : 0;
  return {channel, 1};
}

std::vector<double> predict(const Channel& channel, const Look& look) {
  return {look.pictures.luminance(std::size_t(channel.source), std::size_t(channel.part))};
}

}  // namespace

// an even surface has the same rounding error in all its pixels
constinit const SensorKind video_sensor = {.kind = ChannelKind::video,
                                           .resolve = resolve,
                                           .predict = predict,
                                           .interpolate = between_pictures,
                                           .difference = plain_difference,
                                           .noise = {.rounding = srgb8_step_sigma},
                                           .is_of_pictures = true};

}  // namespace pvg::diagnose
