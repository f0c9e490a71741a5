// The sections `bodies`, `joints` and `stitches` of a scene file. Internal to the loaders.
#pragma once
#include <optional>

#include "host/load/fields/fields.hpp"
#include "host/load/scene_file.hpp"

namespace pvg {

struct BodySection {
  enum class Kind { rigid, soft, fixed, moving, half_space };
  std::string name;
  Kind kind = Kind::rigid;
  TriangleMesh surface;  // of the shape of all but soft ones
  TetMesh solid;
  std::optional<double> density, mass;  // of a rigid body
  std::optional<Mat3> inertia;          // about the centre of mass; none: as the shape and the density have it
  std::optional<Vec3> center_of_mass;   // likewise
  SolidMaterial material;
  double friction = 0.5;
  double contact_offset = 0;
  double affine_modulus = RigidBody{}.affine_modulus;
  bool collides = true;
  Pose pose = Pose::Identity();
  Vec3 velocity = Vec3::Zero(), angular_velocity = Vec3::Zero();
  std::vector<PathPoint> path;
  Vec3 point = Vec3::Zero(), normal = Vec3::UnitZ();  // of a half space
  std::vector<VisualSection> visuals;
  Display display;  // width 0: none
};

struct DriveSection {
  bool is_there = false;
  Joint::Type type = Joint::Type::revolute;  // of its joint
  Drive drive;
  TargetTable target;  // empty: where the joint starts, or no velocity or torque
};

struct SceneJointSection : JointSection {
  std::optional<Pose> child_frame;
  DriveSection drive;
};

struct StitchSection {
  std::string soft, cloth, rigid;
  Vec3 low = Vec3::Zero(), high = Vec3::Zero();  // in the frame of the soft body or cloth
  Stitch stitch;                                 // without bodies and nodes
};

// Two bodies that pass through each other, by name.
struct NoncollidingPair {
  std::string first, second;
};

const Fields<BodySection>& body_fields();
const Fields<SceneJointSection>& scene_joint_fields();
const Fields<StitchSection>& stitch_fields();
const Fields<NoncollidingPair>& noncolliding_fields();

// Adds what `section` describes to file.added (and, of joints with a drive, to file.targets).
void read_body(YamlSection& section, SceneFile& file);
void read_joint(YamlSection& section, SceneFile& file);
void read_stitch(YamlSection& section, SceneFile& file);
void read_noncolliding(YamlSection& section, SceneFile& file);

}  // namespace pvg
