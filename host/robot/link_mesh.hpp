// The shapes of a robot's links: mesh files read by assimp. Lengths in metres.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "host/model/scene.hpp"

namespace pvg {

struct MeshPart {
  VisualMesh mesh;
  Vec3f color = Vec3f::Constant(0.6f);  // the file's diffuse colour, as it stands there
};

// One part per mesh of the file. `owner` ("arm.urdf: link 'wrist'") begins the message of a UsageError.
std::vector<MeshPart> load_mesh_parts(const std::filesystem::path& file, const Vec3& scale, const std::string& owner);

VisualMesh moved(const VisualMesh& mesh, const Pose& pose);

// Appends a surface to another: equal points become one, triangles without area are left out.
void add_to_collision(TriangleMesh& collision, const VisualMesh& mesh);

}  // namespace pvg
