// A task as its file says it: what is simulated, how its start is drawn by chance, how the robot moves, what counts as
// success, how it is filmed. Plain structs in SI units and radians; files are absolute paths. Read by load_task
// (task_file.hpp), turned into a Scene by build_scene (build_scene.hpp).
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "host/model/condition.hpp"
#include "host/model/motion.hpp"
#include "host/model/scene.hpp"

namespace pvg {

// A number drawn evenly from [low, high]; low == high: that number.
struct Range {
  double low = 0, high = 0;
};

// Where a body starts: position and roll, pitch, yaw (about the fixed axes x, y, z in this order).
struct SampledPose {
  std::string object;      // whose frame it is in, an object further up in the list; empty: the world's
  Range x, y, z;           // [m]
  Range roll, pitch, yaw;  // [rad]
};

// A quantity that is drawn anew for each episode (variation.hpp).
struct Variation {
  enum class Quantity {
    size,
    mass,
    friction,
    stiffness,
    color,
    light,
    exposure,
    camera_position,
    camera_rotation,
    focal_length,
    texture,
    presence,
    disturbance
  };
  Quantity quantity = Quantity::size;
  std::string of;  // name of the object, cloth, finger, material, light or camera; `background`, `environment`; of a
                   // disturbance `gripper_base`, of robot left `left/gripper_base`
  Range range;     // a factor; of the camera's pose a shift [m] or turn [rad], drawn for each of its axes, of a
                   // disturbance a shift [m] for each axis of the tool
  std::vector<std::filesystem::path> files = {};  // of `texture`: one of them is drawn
  double probability = 0.5;                       // of `presence`: how often the object is there
  int times = 1;                                  // of `disturbance`: how many in an episode
  Range turn = {};                                // likewise, for each axis of the tool [rad]
  Range duration = {0.4, 0.4};                    // likewise [s]
  // likewise: names of motion elements in which it may happen
  std::vector<std::string> during = {"approach", "carry", "move", "retreat"};
};

// A push of a hand off its way, as drawn: when is a share of the time in which it may begin.
struct Disturbance {
  std::string of;  // as Variation::of
  double when = 0, duration = 0;
  Vec3 by = Vec3::Zero(), turn = Vec3::Zero();  // in the tool's frame [m, rad]
  std::vector<std::string> during;
};

struct RobotSection {
  std::filesystem::path urdf;           // empty: no robot (scene files only)
  Pose base = Pose::Identity();         // base link to world
  std::vector<double> home;             // [n_joints, rad or m] start configuration
  std::vector<double> posture;          // [n_joints, rad or m] that planned motions stay near; empty: none
  std::string flange;                   // link that carries the gripper
  double drive_stiffness = 1e5;         // of every joint's drive [N m/rad]
  double drive_damping = 0;             // [N m s/rad]
  std::vector<double> armature;         // [n_joints, kg m^2 or kg] of each joint of `home`; empty: none
  bool feeds_friction_forward = false;  // targets of planned motions lead by what the joints' friction holds back
  double friction = 0.5;
  std::optional<std::vector<std::string>> collision_links;  // links that collide; absent: all that have a shape for it
};

// What is seen of an object.
struct VisualSection {
  std::filesystem::path mesh;
  std::string material;       // a name of Task::materials
  double crease_angle = 0.7;  // edges sharper than this stay sharp [rad]
};

// A thing on the scene: the beaker, the scale, the table.
struct ObjectSection {
  std::string name;
  std::filesystem::path mesh;          // closed surface for the simulation; empty: seen only
  std::vector<VisualSection> visuals;  // empty: not seen
  bool is_fixed = false;
  bool is_visible = true;  // without visuals: whether the collision surface is shown
  double density = 0;      // [kg/m^3]; either this or mass, neither if fixed
  double mass = 0;         // [kg]
  double friction = 0.5;
  double affine_modulus = 1e9;  // [Pa]
  double size = 1;              // factor on its meshes
  Display display;              // of what it weighs; its name, body and texture come with the scene
  SampledPose pose;             // to world
};

// Two objects that a joint holds together, such as a cabinet and its door.
struct JointSection {
  std::string parent, child;  // objects
  Joint joint;                // its parent_frame holds; bodies and child_frame come with the scene
};

// What the gripper's own file says (gripper.yaml): rigid parts from a URDF, soft fingers stitched to its carriages.
struct FingerSection {
  std::string name;
  std::filesystem::path mesh;  // closed surface, in the finger's frame
  SolidMaterial material;
  double friction = 0.7;
  std::string carriage;                // link of the URDF that carries it
  Pose pose = Pose::Identity();        // finger to carriage
  Vec3 stitch_low, stitch_high;        // box in the finger's frame; nodes inside are stitched [m]
  double stitch_stiffness = 1e5;       // of each spring [N/m]
  double max_tetrahedron_volume = 0;   // bound for TetGen [m^3]; 0: none
  double radius_edge_ratio = 1.6;      // TetGen's -q
  bool keeps_surface = true;           // TetGen's -Y: no vertices added on the surface
  int nodes_per_element = 10;          // 4 or 10
  std::vector<VisualSection> visuals;  // carried by its tetrahedra; empty: its own surface is seen
};

struct GripperSection {
  std::filesystem::path file, urdf;
  std::string base_link;                // fixed to the robot's flange
  Pose mount = Pose::Identity();        // gripper base to flange
  Pose tool_center = Pose::Identity();  // tool frame in the gripper base: z along the fingers, y from finger to finger
  std::vector<std::string> joints;      // the prismatic ones, one per finger
  double open = 0, closed = 0;          // their position [m]
  std::optional<double> width_at_zero;  // between the fingertips at position 0, unbent; each joint adds its own [m]
  double drive_stiffness = 2e4;         // [N/m]
  double drive_damping = 0;             // [N s/m]
  std::vector<FingerSection> fingers;
  std::string finger_material;            // visual, names of Task::materials
  std::vector<VisualMaterial> materials;  // colour only, no textures
  int subdivision_levels = 1;             // of the fingers' visual surface
  bool is_rigid = false;                  // its fingers do not bend: for comparison
};

// A camera; where it is mounted: "world" or "gripper_base" (the gripper's base link), "left/gripper_base" of robot
// left.
struct CameraSection {
  std::string name;
  std::string mount = "world";
  int width = 320, height = 180;        // [pixels]
  double vertical_field_of_view = 0.8;  // [rad]
  // instead of the field of view: fx / height, fy / height, (cx + 1/2) / width, (cy + 1/2) / height; empty: not
  std::vector<double> intrinsics;
  Camera optics;                 // model, distortion and what a real camera adds; its other fields do not count
  Pose pose = Pose::Identity();  // camera (optical frame) to mount
  float exposure = 1;
  bool records_gripper_mask = false;  // write which pixels see the gripper
};

struct BackgroundSection {
  std::filesystem::path mesh, texture;  // mesh empty: no background
  Pose pose = Pose::Identity();         // to world
  float shadow_strength = 0.6f;         // lambda_s in [0, 1]
  float ambient = 0;                    // share of its light that comes evenly from all around, in [0, 1]
  bool is_relit = false;                // a diffuse surface below the scene's lights: the captured light is in it twice
};

// A cloth: as simulated, its pose still to be drawn, and how it is seen.
struct ClothSection {
  Cloth cloth;
  std::filesystem::path mesh;  // empty: a plain shape
  SampledPose pose;            // to world
  std::string look;            // a name of Task::materials; empty: not seen
  int subdivision_levels = 1;  // of its visual surface
};

struct RenderSection {
  double frames_per_second = 10;
  int samples = 16;       // paths per pixel
  bool adaptive = false;  // more of them where the noise is
  int max_depth = 8;
  std::filesystem::path lut;  // applied to the pictures; empty: none
  bool denoise = false;       // the noise of few samples is filtered
};

// What the record of an episode keeps of the nodes of soft bodies and cloths; docs/reference/states.md
enum class RecordedStates {
  full,     // every bit of every step
  float32,  // every step, rounded to less than a micrometre
  frames    // likewise, of the steps that pictures show
};
inline const std::vector<std::string> RECORDED_STATES = {"full", "float32", "frames"};

struct RecordSection {
  RecordedStates states = RecordedStates::float32;
};

// One of several robots, each with a gripper. Its name stands before those of its parts.
struct RobotCell {
  std::string name;  // such as "left"; bodies and joints are then left/fr3_link1 ...
  RobotSection robot;
  std::optional<GripperSection> gripper;
};

struct Task {
  std::filesystem::path file;
  std::string name;
  RobotSection robot;
  std::optional<GripperSection> gripper;
  std::vector<RobotCell> more_robots;  // those of the section `robots`, which stands instead of `robot` and `gripper`
  std::vector<ObjectSection> objects;
  std::vector<JointSection> joints;
  std::vector<ClothSection> cloths;
  std::vector<PairFriction> pair_friction;
  std::vector<PairRestitution> pair_restitution;
  std::vector<Effect> effects;
  ContactSettings contact;
  SolverSettings solver;  // its time_step is the task's key `time_step`
  BackgroundSection background;
  std::vector<RectangleLight> lights;
  std::vector<SphereLight> sphere_lights;
  Vec3f environment = Vec3f::Zero();      // radiance where nothing is, or scale of its picture [W/(sr m^2)]
  std::filesystem::path environment_map;  // equirectangular picture; empty: the same everywhere
  double environment_turn = 0;            // [rad]
  std::vector<VisualMaterial> materials;
  std::vector<std::filesystem::path> textures;  // VisualMaterial::texture refers to these
  std::vector<CameraSection> cameras;
  std::vector<MotionElement> motion;
  std::vector<Condition> success;  // the episode succeeded if all of these hold
  std::vector<Condition> failure;  // it has failed as soon as one of these holds
  std::vector<Variation> variations;
  std::vector<Disturbance> disturbances;  // of one episode; a file names none, they are drawn by `vary`
  RenderSection render;
  RecordSection record;
};

// `robot`, with an empty name, and those of `robots`.
inline std::vector<RobotCell> robots_of(const Task& task) {
  std::vector<RobotCell> robots;
  if (!task.robot.urdf.empty()) robots.push_back({"", task.robot, task.gripper});
  robots.insert(robots.end(), task.more_robots.begin(), task.more_robots.end());
  return robots;
}

// What stands for the hand of the robot of this name.
inline std::string hand_name(const std::string& robot) { return (robot.empty() ? "" : robot + "/") + "gripper_base"; }

}  // namespace pvg
