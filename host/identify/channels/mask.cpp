// One moment of the mask of a part in a camera's picture (host/pictures/mask_metrics.hpp).
#include "host/base/error.hpp"
#include "host/identify/channels/prediction.hpp"
#include "host/identify/channels/resolve.hpp"

namespace pvg::diagnose {
namespace {

// the first body with that part's name represents it
Resolved resolve(const ChannelPlace& where, const RecordedChannel& recorded) {
  const MaskSource& source = where.recording.mask_sources[std::size_t(recorded.source)];
  const ChannelPlace place{where.recording, where.scene, where.seen, where.recording.file.string() + ": a mask"};
  check_camera(place, source.camera, "masks", [&](const RecordedRun& run) {
    const PartMasks& masks = run.masks[std::size_t(recorded.source)].masks;
    return std::pair(masks.width, masks.height);
  });
  Channel channel;
  channel.source = recorded.source;
  channel.part = recorded.part;
  channel.name = recorded.columns[0];
  channel.subject = source.part;
  channel.unit = "1";
  std::string known;
  for (const Visual& visual : where.seen.visuals) {
    if (visual.part == source.part) {
      channel.rigid = visual.rigid;
      channel.soft = visual.soft;
      channel.cloth = visual.cloth;
      return {channel, 1};
    }
    if (known.find(visual.part) == std::string::npos) known += (known.empty() ? "" : ", ") + visual.part;
  }
  throw UsageError(place.entry + " names the part `" + source.part + "`, which the scene does not have; " +
                   (known.empty() ? "none of its bodies is shown: give them `visuals`" : "it has: " + known));
}

std::vector<double> predict(const Channel& channel, const Look& look) {
  return {look.pictures.mask_moment(std::size_t(channel.source), std::size_t(channel.part))};
}

}  // namespace

constinit const SensorKind mask_sensor = {.kind = ChannelKind::mask,
                                          .resolve = resolve,
                                          .predict = predict,
                                          .interpolate = between_pictures,
                                          .difference = plain_difference,
                                          .is_of_pictures = true};

}  // namespace pvg::diagnose
