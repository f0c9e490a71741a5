#include <cmath>

#include "host/load/read_sections.hpp"
#include "host/load/task_file.hpp"

namespace pvg {
namespace {

using Section = YamlSection;

FingerSection read_finger(Section& section) {
  FingerSection finger;
  finger.name = section.text("name");
  finger.mesh = section.file("mesh");
  Section material = section.section("material");
  finger.material.density = material.number("density", Unit::density, 1, 1e5);
  finger.material.youngs_modulus = material.number("youngs_modulus", Unit::pressure, 1, 1e12);
  finger.material.poisson_ratio = material.number("poisson_ratio", Unit::none, 0, 0.4999);
  material.done();
  finger.friction = section.number("friction", Unit::none, 0, 10, finger.friction);
  finger.carriage = section.text("carriage");
  finger.pose = read_pose(section, "pose");
  Section stitch = section.section("stitch");
  finger.stitch_low = stitch.vector("low", Unit::length, -REACH, REACH);
  finger.stitch_high = stitch.vector("high", Unit::length, -REACH, REACH);
  finger.stitch_stiffness = stitch.number("stiffness", Unit::stiffness, 1e-3, 1e12);
  stitch.done();
  if (section.has("tetgen")) {
    Section tetgen = section.section("tetgen");
    finger.max_tetrahedron_volume = tetgen.number("max_volume", Unit::volume, 0, INFINITY, 0);
    finger.radius_edge_ratio = tetgen.number("radius_edge_ratio", Unit::none, 1.1, 100, finger.radius_edge_ratio);
    finger.keeps_surface = tetgen.boolean("keeps_surface", true);
    finger.nodes_per_element = tetgen.integer("nodes_per_element", 4, 10, 10);
    if (finger.nodes_per_element != 4 && finger.nodes_per_element != 10)
      tetgen.fail("nodes_per_element", "must be 4 or 10");
    tetgen.done();
  }
  finger.visuals = read_visuals(section);
  section.done();
  return finger;
}

}  // namespace

GripperSection load_gripper(const std::filesystem::path& file) {
  Section root = Section::load(file, "gripper file");
  check_schema(root);
  GripperSection gripper;
  gripper.file = root.path();
  gripper.urdf = root.file("urdf");
  gripper.base_link = root.text("base_link");
  gripper.mount = read_pose(root, "mount");
  gripper.tool_center = read_pose(root, "tool_center");
  gripper.joints = root.texts("joints");
  gripper.open = root.number("open", Unit::length, 0, 10);
  gripper.closed = root.number("closed", Unit::length, 0, 10);
  if (gripper.open == gripper.closed) root.fail("open", "must differ from `closed`");
  if (root.has("width_at_zero")) gripper.width_at_zero = root.number("width_at_zero", Unit::length, -1, 1);
  if (root.has("drive")) {
    Section drive = root.section("drive");
    gripper.drive_stiffness = drive.number("stiffness", Unit::stiffness, 1e-3, 1e12);
    gripper.drive_damping = drive.number("damping", Unit::damping, 0, 1e9, 0);
    drive.done();
  }
  gripper.finger_material = root.text("finger_material");
  gripper.subdivision_levels = root.integer("subdivision_levels", 0, 4, gripper.subdivision_levels);
  add_materials(root, gripper.materials, nullptr);
  for (Section& section : root.sections("fingers")) gripper.fingers.push_back(read_finger(section));
  if (gripper.fingers.empty()) root.fail("", "must hold at least one finger under `fingers`");
  check_distinct(root, "fingers", gripper.fingers);
  root.done();
  return gripper;
}

}  // namespace pvg
