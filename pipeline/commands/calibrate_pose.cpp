// phyvisgen calibrate pose: where a camera stands, from a photo of tags; or where it is mounted on a robot's hand, from
// photos and the hand's pose at each of them.
#include "pipeline/commands/calibrate_pose.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>

#include "host/base/atomic_files.hpp"
#include "host/base/counted.hpp"
#include "host/base/error.hpp"
#include "host/base/outputs.hpp"
#include "host/calibration/hand_eye.hpp"
#include "host/formats/picture_files.hpp"
#include "host/formats/table.hpp"
#include "host/load/camera_file.hpp"
#include "host/load/fields/fields.hpp"
#include "host/robot/kinematics.hpp"
#include "pipeline/command_line/command.hpp"

namespace pvg {

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

namespace {

struct CalibratePoseOptions {
  std::vector<std::string> photos;
  std::string tags, camera, output;
  std::string hand, robot, link;  // log of the hand
  bool as_json = false;
};

Picture8 read_photo(const std::string& file, const Camera& camera) {
  Picture8 photo = read_picture(file);
  if (photo.width != camera.width || photo.height != camera.height)
    throw UsageError(fmt::format("{} has {} x {} pixels, the camera {} x {}; take the photo with the calibrated camera",
                                 file, photo.width, photo.height, camera.width, camera.height));
  return photo;
}

// The numbers of a table's column, all finite.
const std::vector<double>& column_of(const MeasuredTable& table, const std::string& name, const std::string& kind) {
  if (!table.has(name)) throw UsageError(table.file.string() + ": the column `" + name + "` is missing, " + kind);
  for (std::size_t i = 0; i < table.n_rows; ++i)
    if (!std::isfinite(table[name][i]))
      throw UsageError(fmt::format("{}: row {} of `{}` holds no number", table.file.string(), i + 1, name));
  return table[name];
}

std::vector<Pose> logged_poses(const MeasuredTable& table) {
  std::vector<Pose> poses(table.n_rows, Pose::Identity());
  const auto at = [&](const char* name, std::size_t i) {
    return column_of(table, name, "of the hand's pose in the base; or give --robot, and joints as columns")[i];
  };
  for (std::size_t i = 0; i < table.n_rows; ++i) {
    const Eigen::Quaterniond q(at("qw", i), at("qx", i), at("qy", i), at("qz", i));
    if (!(std::abs(q.norm() - 1) < 1e-2))
      throw UsageError(
          fmt::format("{}: the quaternion of row {} has length {:.3g}, not 1", table.file.string(), i + 1, q.norm()));
    poses[i].linear() = q.normalized().toRotationMatrix();
    poses[i].translation() = Vec3(at("x", i), at("y", i), at("z", i));
  }
  return poses;
}

// Joints that do not move the link need no column.
std::vector<Pose> link_poses_of(const MeasuredTable& table, const std::string& robot, const std::string& link_name) {
  const RobotModel model = load_urdf(robot);
  const int link = model.link(link_name);
  std::vector<Pose> poses;
  std::vector<bool> moves_link(model.joints.size(), false);
  for (int at = link; at > 0; at = model.joints[std::size_t(at - 1)].parent) moves_link[std::size_t(at - 1)] = true;
  for (std::size_t row = 0; row < table.n_rows; ++row) {
    VectorXd q = VectorXd::Zero(Eigen::Index(model.actuated.size()));
    for (std::size_t k = 0; k < model.actuated.size(); ++k) {
      const std::size_t joint = std::size_t(model.actuated[k]);
      if (moves_link[joint])
        q[Eigen::Index(k)] = column_of(table, model.joints[joint].name, "a joint between base and --link")[row];
    }
    poses.push_back(link_poses(model, q)[std::size_t(link)]);
  }
  return poses;
}

std::string yaml_of(const Pose& pose) {
  const Vec3 p = pose.translation();
  const Eigen::Quaterniond q(pose.linear());
  return fmt::format("position: [{:.6f}, {:.6f}, {:.6f}]\nquaternion: [{:.8f}, {:.8f}, {:.8f}, {:.8f}]\n", p.x(), p.y(),
                     p.z(), q.x(), q.y(), q.z(), q.w());
}

// roll, pitch, yaw about fixed axes, as scene and task files have them
Vec3 roll_pitch_yaw(const Pose& pose) {
  const Vec3 a = pose.linear().eulerAngles(2, 1, 0);
  return {a[2], a[1], a[0]};
}

nlohmann::ordered_json json_of(const Pose& pose) {
  const Vec3 p = pose.translation(), r = roll_pitch_yaw(pose);
  const Eigen::Quaterniond q(pose.linear());
  return {{"position", {p.x(), p.y(), p.z()}},
          {"quaternion", {q.x(), q.y(), q.z(), q.w()}},
          {"rotation", {r.x(), r.y(), r.z()}}};
}

void run_hand_eye(const CalibratePoseOptions& o, const std::vector<PlacedTag>& tags, const Camera& camera) {
  if (o.robot.empty() != o.link.empty())
    throw UsageError("--robot ARM.urdf and --link NAME, which carries the camera, belong together");
  const MeasuredTable table = read_table(o.hand);
  if (table.n_rows != o.photos.size())
    throw UsageError(fmt::format("{} has {} for {}; it needs one for each, in the photos' order", o.hand,
                                 counted(table.n_rows, "row"), counted(o.photos.size(), "photo")));
  const std::vector<Pose> hand = o.robot.empty() ? logged_poses(table) : link_poses_of(table, o.robot, o.link);
  std::vector<HandPhoto> photos;
  for (std::size_t i = 0; i < o.photos.size(); ++i) {
    HandPhoto photo;
    photo.file = o.photos[i];
    photo.hand = hand[i];
    photo.found = find_tags_finely(read_photo(o.photos[i], camera));
    photos.push_back(std::move(photo));
  }
  const HandEye found = calibrate_hand_eye(std::move(photos), tags, camera);
  const Vec3 s = found.position_sigma, r = found.rotation_sigma, turn = roll_pitch_yaw(found.mount);
  const std::string yaml =
      yaml_of(found.mount) + fmt::format("rotation: [{:.8f}, {:.8f}, {:.8f}]\n", turn.x(), turn.y(), turn.z());
  if (!o.output.empty())
    write_text_atomically(o.output,
                          "# camera (optical frame) on the hand, by `phyvisgen calibrate pose`; position and "
                          "rotation as of a task's camera\n" +
                              yaml);
  std::size_t n_used = 0;
  for (const HandPhoto& photo : found.photos) n_used += photo.is_used;
  if (o.as_json) {
    nlohmann::ordered_json out = json_of(found.mount);
    out["schema"] = 1;
    out["position_sigma"] = {s.x(), s.y(), s.z()};
    out["rotation_sigma"] = {r.x(), r.y(), r.z()};
    out["residual_px"] = found.residual;
    out["tags_in_base"] = json_of(found.tags);
    out["photos"] = nlohmann::ordered_json::array();
    for (const HandPhoto& photo : found.photos)
      out["photos"].push_back(
          {{"file", photo.file}, {"used", photo.is_used}, {"residual_px", photo.residual}, {"reason", photo.reason}});
    std::printf("%s\n", out.dump(2).c_str());
    return;
  }
  for (const HandPhoto& photo : found.photos)
    if (!photo.is_used)
      std::printf("%s is left out (%.2f pixels): %s\n", photo.file.c_str(), photo.residual, photo.reason.c_str());
  std::printf("%sresidual %.3f pixels over %zu of %s; known to %.2f mm, %.3f degrees\n", yaml.c_str(), found.residual,
              n_used, counted(found.photos.size(), "photo").c_str(), 1e3 * s.norm(), r.norm() * 180 / 3.14159265358979);
}

void run_calibrate_pose(const CalibratePoseOptions& o) {
  if (o.photos.empty() || o.tags.empty() || o.camera.empty())
    throw UsageError("calibrate pose needs PHOTO, --tags TAGS.yaml and --camera CAMERA.yaml");
  if (o.hand.empty() && (o.photos.size() > 1 || !o.robot.empty() || !o.link.empty()))
    throw UsageError(
        "a camera that stands still needs one photo; for the mount of a camera on a hand give --hand LOG.csv with a "
        "row "
        "for each photo");
  const std::vector<PlacedTag> tags = read_tags(o.tags);
  const Camera camera = read_camera_file(o.camera);
  if (!o.output.empty()) check_output_file(o.output, {".yaml", ".yml"});
  if (!o.hand.empty()) return run_hand_eye(o, tags, camera);
  const std::vector<FoundTag> found = find_tags_finely(read_photo(o.photos[0], camera));
  if (found.empty()) throw UsageError(o.photos[0] + ": no tag of the family 36h11 is found");
  const CameraPlace place = place_camera(found, tags, camera);
  const Vec3 p = place.pose.translation(), s = place.position_sigma, r = place.rotation_sigma;
  const Eigen::Quaterniond q(place.pose.linear());
  const std::string yaml = yaml_of(place.pose);
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
  std::printf("%sresidual %.3f pixels over %zu of %s seen; known to %.2f mm, %.3f degrees\n", yaml.c_str(),
              place.residual, place.used.size(), counted(found.size(), "tag").c_str(), 1e3 * s.norm(),
              r.norm() * 180 / 3.14159265358979);
}

}  // namespace

void add_calibrate_pose(CLI::App& program) {
  CLI::App* command =
      command_group(program, "calibrate")
          .add_subcommand("pose", "Where a camera stands, or is mounted on a robot's hand, from photos of tags");
  CalibratePoseOptions& o = options_of_command(*command, run_calibrate_pose);
  command->add_option("photos", o.photos, "Photo with tags of the family 36h11; with --hand several");
  command->add_option("--tags", o.tags, "YAML: tags: [{id, size, position, rotation}], in the world");
  command->add_option("--camera", o.camera, "Camera file of `calibrate camera`");
  command->add_option("--hand", o.hand,
                      "CSV with a row for each photo, in their order: joints by their names [rad, m], with --robot and "
                      "--link; or the hand's pose in the base: x y z [m] qx qy qz qw");
  command->add_option("--robot", o.robot, "URDF of the arm");
  command->add_option("--link", o.link, "Link that carries the camera");
  command->add_option("-o,--output", o.output, "Pose to write (.yaml)");
  command->add_flag("--json", o.as_json, "Print JSON");
  command->footer(
      "Examples:\n  phyvisgen calibrate pose photo.png --tags tags.yaml --camera camera.yaml\n  phyvisgen calibrate "
      "pose wrist/*.png --hand joints.csv --robot arm.urdf --link flange --tags tags.yaml --camera camera.yaml");
}

}  // namespace pvg
