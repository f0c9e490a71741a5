// The tables of all sections that scene, task and gripper files and resolved configurations share.
#pragma once
#include "host/load/fields/fields.hpp"
#include "host/load/fields/target_bounds.hpp"
#include "host/load/task_file.hpp"

namespace pvg {

// A material with the files of its textures, whose numbers the task counts.
struct MaterialSection : VisualMaterial {
  std::filesystem::path texture_file, normal_file, metallic_roughness_file, emission_file;
};

// table_physics.cpp
const Fields<ContactSettings>& contact_fields();
const Fields<SolverSettings>& solver_fields();
const Fields<PairFriction>& pair_friction_fields();
const Fields<PairRestitution>& pair_restitution_fields();
const Fields<SolidMaterial>& solid_material_fields();
const Fields<ClothMaterial>& cloth_material_fields();
const Fields<ClothSection>& cloth_fields();
const Fields<Variation>& variation_fields();

// table_robot.cpp
const Fields<RobotSection>& robot_fields();
const Fields<RobotCell>& robot_cell_fields();
const Fields<int>& nodes_per_element_fields();  // of a tetrahedron
const Fields<FingerSection>& finger_fields();
const Fields<GripperSection>& gripper_fields();
const Fields<SampledPose>& sampled_pose_fields();
const Fields<VisualSection>& visual_fields();
const Fields<Display>& display_fields();
const Fields<ObjectSection>& object_fields();

// table_looks.cpp
const Fields<MaterialSection>& material_fields();
const Fields<RectangleLight>& rectangle_light_fields();
const Fields<SphereLight>& sphere_light_fields();
const Fields<Camera>& optics_fields();
const Fields<CameraSection>& camera_fields();
const Fields<BackgroundSection>& background_fields();
// of the key `relit` of both kinds of background
inline constexpr const char* RELIT_MEANING =
    "for comparison: a diffuse surface of the captured colours below the scene's lights, which holds the captured "
    "light "
    "twice";
const Fields<RenderSection>& render_fields();

// table_effect.cpp
const Fields<Effect>& effect_fields();

const Fields<RecordSection>& record_fields();  // table_task.cpp

// table_joint.cpp: what the joints of scenes and of tasks share, and those of tasks
inline bool has_coordinate(const JointSection& section) {
  return turns(section.joint.type) || section.joint.type == Joint::Type::prismatic;
}
inline Unit coordinate_unit(Joint::Type type) { return turns(type) ? Unit::angle : Unit::length; }

const Fields<JointSection>& joint_ends_fields();   // what it joins, and how
const Fields<JointSection>& joint_frame_fields();  // its limits, which hold Joint::initial, its damping and its frame
const Fields<JointSection>& task_joint_fields();

// table_task.cpp. robots: of the task. otherwise: the default of `when`
Fields<MotionElement> motion_fields(const std::vector<RobotCell>& robots);
Fields<Condition> condition_fields(const std::vector<std::string>& robots, Condition::When otherwise);

// task_file.cpp: keys of the file itself. largest_time_step [s]
constexpr double LARGEST_TASK_TIME_STEP = 0.02, LARGEST_SCENE_TIME_STEP = 1;  // scenes may only look for rest
Fields<Task> root_fields(double largest_time_step);
const Fields<Task>& environment_fields();

// The keys `robot` and `gripper` of a task, a scene or one of `robots`: an arm and what it carries. The gripper's file
// is read; a resolved configuration holds what it said.
template <class T>
Fields<T> carried_gripper_fields() {
  return Fields<T>()
      .section("robot", &T::robot, robot_fields(), "the arm")
      .written_when([](const T& t) { return !t.robot.urdf.empty(); })
      .custom(
          {"gripper", "", "none", "file", "the [gripper](gripper.md) that the arm carries"},
          [](YamlSection& s, T& t) {
            if (!s.is_resolved()) return void(t.gripper = load_gripper(s.file("gripper")));
            YamlSection inner = s.section("gripper");
            gripper_fields().read(inner, t.gripper.emplace());
            inner.done();
          },
          [](YamlWriter& w, const T& t) {
            w.begin("gripper");
            gripper_fields().write(w, *t.gripper);
            w.end();
          })
      .written_when([](const T& t) { return t.gripper.has_value(); })
      .check([](YamlSection& s, T& t) {
        if (t.gripper && t.robot.urdf.empty()) s.fail("gripper", "needs a `robot` that carries it");
      });
}

template <class T>
T read_all(const Fields<T>& fields, YamlSection section) {
  T value;
  fields.read(section, value);
  section.done();
  return value;
}

template <class T>
void read_list(YamlSection& root, const std::string& key, const Fields<T>& fields, std::vector<T>& list) {
  for (const YamlSection& section : root.sections(key)) list.push_back(read_all(fields, section));
}

}  // namespace pvg
