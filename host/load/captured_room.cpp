#include "host/load/captured_room.hpp"

#include <algorithm>
#include <cmath>

#include "host/base/error.hpp"
#include "host/base/outputs.hpp"
#include "host/load/fields/yaml_section.hpp"
#include "host/load/tables.hpp"

namespace pvg {
namespace {

constexpr double LARGEST_PLANE = 1e3;  // [m]

// about the fixed axes x, y, z in this order
Vec3 roll_pitch_yaw(const Eigen::Matrix3d& R) {
  return {std::atan2(R(2, 1), R(2, 2)), std::atan2(-R(2, 0), std::hypot(R(0, 0), R(1, 0))),
          std::atan2(R(1, 0), R(0, 0))};
}

void read_room(YamlSection& section, CapturedBackground& captured) {
  const std::filesystem::path given = (section.path().parent_path() / section.text("capture")).lexically_normal();
  captured.room = std::filesystem::is_directory(given) ? given / "room.yaml" : given;
  if (!is_file(captured.room)) section.fail("capture", "names " + captured.room.string() + ", which does not exist");
}

// what carries bodies: not seen, since the room shows it
ObjectSection carrier(const CapturedBackground& captured, const std::string& name, const std::filesystem::path& mesh) {
  const Vec3 at = captured.background.pose.translation(), turn = roll_pitch_yaw(captured.background.pose.linear());
  ObjectSection object;
  object.name = "room_" + name;
  object.mesh = mesh;
  object.is_fixed = true;
  object.is_visible = false;
  object.friction = captured.friction;
  object.pose.x = {at.x(), at.x()};
  object.pose.y = {at.y(), at.y()};
  object.pose.z = {at.z(), at.z()};
  object.pose.roll = {turn.x(), turn.x()};
  object.pose.pitch = {turn.y(), turn.y()};
  object.pose.yaw = {turn.z(), turn.z()};
  return object;
}

}  // namespace

const Fields<CapturedBackground>& captured_background_fields() {
  using C = CapturedBackground;
  static const Fields<C> FIELDS =
      Fields<C>()
          .custom({"capture", "", "none", "folder", "what `capture room` wrote"}, read_room, nullptr)
          .required()
          .choice("contact", &C::contact, {"planes", "surface"},
                  "what carries bodies: `planes`, or the surface itself as `capture room --contact` made it solid")
          .text("planes", &C::planes, "of the room, that carry bodies")
          .otherwise("its ground")
          .number("friction", &C::friction, Unit::none, 0, 10, "of what carries bodies")
          .own_pose(
              [](auto& c) -> auto& { return c.background.pose; }, "of the room in the world")
          .number(
              "shadow_strength", [](auto& c) -> auto& { return c.background.shadow_strength; }, Unit::none, 0, 1,
              "share of the light that shadows take")
          .number(
              "ambient", [](auto& c) -> auto& { return c.background.ambient; }, Unit::none, 0, 1,
              "share of the light that comes evenly from all around; the rest is that of the lamps")
          .flag(
              "relit", [](auto& c) -> auto& { return c.background.is_relit; }, RELIT_MEANING);
  return FIELDS;
}

BackgroundSection add_captured_room(const CapturedBackground& captured, std::vector<ObjectSection>& objects) {
  YamlSection room = YamlSection::load(captured.room, "captured room");
  BackgroundSection background = captured.background;
  room.integer("schema", 1, 1);
  background.mesh = room.file("mesh");
  for (const char* key : {"capture_to_room", "voxel"}) room.skip(key);
  const bool takes_surface = captured.contact == CapturedBackground::Contact::surface;
  if (takes_surface && !captured.planes.empty())
    throw UsageError(captured.room.string() +
                     ": the background names `planes` beside `contact: surface`; take one of "
                     "the two");
  if (room.has("surface")) {
    const std::filesystem::path solid = room.file("surface");
    if (takes_surface) objects.push_back(carrier(captured, "surface", solid));
  } else if (takes_surface) {
    room.fail("surface", "is missing, which `contact: surface` needs; run `capture room` again with --contact");
  }
  const std::string ground = room.text("ground", "none");
  std::vector<std::string> wanted = captured.planes;
  if (wanted.empty() && ground != "none") wanted = {ground};
  std::vector<std::string> known;
  for (YamlSection& plane : room.sections("planes")) {
    const std::string name = plane.name();
    for (const char* key : {"area", "roughness", "height_sigma", "tilt_sigma", "pose"}) plane.skip(key);
    plane.numbers("size", Unit::length, 0, LARGEST_PLANE);
    const std::filesystem::path mesh = plane.file("mesh");
    plane.done();
    known.push_back(name);
    if (std::find(wanted.begin(), wanted.end(), name) == wanted.end()) continue;
    if (!takes_surface) objects.push_back(carrier(captured, name, mesh));
  }
  room.done();
  for (const std::string& name : wanted)
    if (std::find(known.begin(), known.end(), name) == known.end())
      room.fail("planes", "do not hold `" + name + "`, which the task's background names");
  return background;
}

}  // namespace pvg
