// phyvisgen calibrate pose: where a camera stands, from a photo of tags.
#include <fmt/format.h>

#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>

#include "host/base/atomic_files.hpp"
#include "host/base/error.hpp"
#include "host/base/outputs.hpp"
#include "host/calibration/calibration.hpp"
#include "host/formats/picture_files.hpp"
#include "host/load/camera_file.hpp"
#include "host/load/fields/fields.hpp"
#include "pipeline/command_line/command.hpp"

namespace pvg {
namespace {

struct CalibratePoseOptions {
  std::string photo, tags, camera, output;
  bool as_json = false;
};

// tags: a list of {id, size, position, rotation}
std::vector<PlacedTag> read_tags(const std::string& file) {
  YamlSection root = YamlSection::load(file, "list of tags");
  root.integer("schema", 1, 1, 1);
  std::vector<PlacedTag> tags;
  for (YamlSection& section : root.sections("tags")) {
    PlacedTag tag;
    tag.id = section.integer("id", 0, 586);
    tag.size = section.number("size", Unit::length, 1e-3, 10);
    tag.pose = read_pose(section);
    section.done();
    for (const PlacedTag& other : tags)
      if (other.id == tag.id) section.fail("id", std::to_string(tag.id) + " stands there twice");
    tags.push_back(tag);
  }
  root.done();
  if (tags.empty()) root.fail("tags", "holds no tag: {id, size, position, rotation}");
  return tags;
}

void run_calibrate_pose(const CalibratePoseOptions& o) {
  if (o.photo.empty() || o.tags.empty() || o.camera.empty())
    throw UsageError("calibrate pose needs PHOTO, --tags TAGS.yaml and --camera CAMERA.yaml");
  const std::vector<PlacedTag> tags = read_tags(o.tags);
  const Camera camera = read_camera_file(o.camera);
  const Picture8 photo = read_picture(o.photo);
  if (photo.width != camera.width || photo.height != camera.height)
    throw UsageError(fmt::format("{} has {} x {} pixels, the camera {} x {}; take the photo with the calibrated camera",
                                 o.photo, photo.width, photo.height, camera.width, camera.height));
  if (!o.output.empty()) check_output_file(o.output, {".yaml", ".yml"});
  const std::vector<FoundTag> found = find_tags_finely(photo);
  if (found.empty()) throw UsageError(o.photo + ": no tag of the family 36h11 is found");
  const CameraPlace place = place_camera(found, tags, camera);
  const Vec3 p = place.pose.translation(), s = place.position_sigma, r = place.rotation_sigma;
  const Eigen::Quaterniond q(place.pose.linear());
  const std::string yaml =
      fmt::format("position: [{:.6f}, {:.6f}, {:.6f}]\nquaternion: [{:.8f}, {:.8f}, {:.8f}, {:.8f}]\n", p.x(), p.y(),
                  p.z(), q.x(), q.y(), q.z(), q.w());
  if (!o.output.empty()) {
    write_text_atomically(o.output, "# camera (optical frame) to world, by `phyvisgen calibrate pose`\n" + yaml);
  }
  if (o.as_json) {
    const nlohmann::ordered_json out = {{"schema", 1},
                                        {"position", {p.x(), p.y(), p.z()}},
                                        {"quaternion", {q.x(), q.y(), q.z(), q.w()}},
                                        {"position_sigma", {s.x(), s.y(), s.z()}},
                                        {"rotation_sigma", {r.x(), r.y(), r.z()}},
                                        {"residual_px", place.residual},
                                        {"tags", place.used},
                                        {"tags_seen", found.size()}};
    std::printf("%s\n", out.dump(2).c_str());
    return;
  }
  std::printf("%sresidual %.3f pixels over %zu of %zu tags seen; known to %.2f mm, %.3f degrees\n", yaml.c_str(),
              place.residual, place.used.size(), found.size(), 1e3 * s.norm(), r.norm() * 180 / 3.14159265358979);
}

}  // namespace

void add_calibrate_pose(CLI::App& program) {
  CLI::App* command =
      command_group(program, "calibrate").add_subcommand("pose", "Where a camera stands, from a photo of tags");
  CalibratePoseOptions& o = options_of_command(*command, run_calibrate_pose);
  command->add_option("photo", o.photo, "Photo with tags of the family 36h11");
  command->add_option("--tags", o.tags, "YAML: tags: [{id, size, position, rotation}], in the world");
  command->add_option("--camera", o.camera, "Camera file of `calibrate camera`");
  command->add_option("-o,--output", o.output, "Pose to write (.yaml)");
  command->add_flag("--json", o.as_json, "Print JSON");
  command->footer("Example:\n  phyvisgen calibrate pose photo.png --tags tags.yaml --camera camera.yaml");
}

}  // namespace pvg
