// The tables of all sections that scene, task and gripper files and resolved configurations share.
#pragma once
#include "host/load/fields/fields.hpp"

namespace pvg {

// A material with the files of its textures, whose numbers the task counts.
struct MaterialSection : VisualMaterial {
  std::filesystem::path texture_file, normal_file, metallic_roughness_file, emission_file;
};

// table_physics.cpp
const Fields<ContactSettings>& contact_fields();
const Fields<SolverSettings>& solver_fields();
const Fields<PairFriction>& pair_friction_fields();
const Fields<SolidMaterial>& solid_material_fields();
const Fields<ClothMaterial>& cloth_material_fields();
const Fields<ClothSection>& cloth_fields();
const Fields<Variation>& variation_fields();

// table_robot.cpp
const Fields<RobotSection>& robot_fields();
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
const Fields<RenderSection>& render_fields();

// table_effect.cpp
const Fields<Effect>& effect_fields();

const Fields<RecordSection>& record_fields();  // table_task.cpp

// table_task.cpp. robots: of the task. otherwise: the default of `when`
const Fields<JointSection>& task_joint_fields();
Fields<MotionElement> motion_fields(const std::vector<RobotCell>& robots);
Fields<Condition> condition_fields(const std::vector<std::string>& robots, Condition::When otherwise);

// task_file.cpp: keys of the file itself. largest_time_step [s]
constexpr double LARGEST_TASK_TIME_STEP = 0.02, LARGEST_SCENE_TIME_STEP = 1;  // scenes may only look for rest
Fields<Task> root_fields(double largest_time_step);

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
