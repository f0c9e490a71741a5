#include "host/formats/tet_file.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <map>
#include <sstream>

#include "host/base/error.hpp"
#include "host/base/files.hpp"
#include "host/base/notes.hpp"
#include "host/base/outputs.hpp"
#include "host/geometry/tet_mesh.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;

constexpr int TETRAHEDRON = 4;         // of Gmsh's kinds of elements: four nodes
constexpr double FARTHEST_NODE = 1e9;  // [m]
constexpr std::size_t MOST_ROWS = 10'000'000;

struct MshReader {
  fs::path file;
  std::istringstream in;

  [[noreturn]] void fail(const std::string& what) const {
    throw UsageError(file.string() + ": " + what + "; write it as MSH 2.2, as text");
  }
  // after the line `name`
  void find(const std::string& name) {
    in.clear();
    in.seekg(0);
    for (std::string line; std::getline(in, line);) {
      while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.pop_back();
      if (line == name) return;
    }
    fail("it has no " + name);
  }
  std::size_t count() {
    std::size_t n = 0;
    in >> n;
    if (!in || n > MOST_ROWS) fail("it begins a list without saying how long it is");
    return n;
  }
};

}  // namespace

std::string tetrahedra_text(const TetMesh& mesh) {
  std::string text = fmt::format("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{}\n", mesh.points.size());
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    const Vec3& p = mesh.points[i];
    text += fmt::format("{} {:.17g} {:.17g} {:.17g}\n", i + 1, p.x(), p.y(), p.z());
  }
  text += fmt::format("$EndNodes\n$Elements\n{}\n", mesh.n_elements());
  for (std::size_t e = 0; e < mesh.n_elements(); ++e) {
    const std::uint32_t* c = &mesh.elements[e * std::size_t(mesh.nodes_per_element)];
    text += fmt::format("{} 4 2 1 1 {} {} {} {}\n", e + 1, c[0] + 1, c[1] + 1, c[2] + 1, c[3] + 1);
  }
  return text + "$EndElements\n";
}

TetMesh read_tetrahedra(const fs::path& file) {
  if (!is_file(file)) throw UsageError(file.string() + ": there is no such file of tetrahedra.");
  remember_read(file);
  MshReader msh{file, std::istringstream(read_whole_file(file).value_or(""))};
  msh.find("$MeshFormat");
  double version = 0;
  int is_binary = 0;
  msh.in >> version >> is_binary;
  if (!msh.in || version < 2 || version >= 3 || is_binary != 0) msh.fail("it is of another version, or binary");
  msh.find("$Nodes");
  std::map<std::uint64_t, Vec3> nodes;
  for (std::size_t n = msh.count(); n-- > 0;) {
    std::uint64_t number = 0;
    Vec3 p;
    msh.in >> number >> p.x() >> p.y() >> p.z();
    if (!msh.in || !(p.cwiseAbs().maxCoeff() <= FARTHEST_NODE)) msh.fail("a node is no number and place");
    nodes[number] = p;
  }
  msh.find("$Elements");
  TetMesh mesh;
  mesh.nodes_per_element = 4;
  std::map<std::uint64_t, std::uint32_t> known;
  const std::size_t n_elements = msh.count();
  msh.in.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
  std::string line;
  for (std::size_t n = 0; n < n_elements; ++n) {
    if (!std::getline(msh.in, line)) msh.fail("it ends too early");
    std::istringstream row(line);
    std::uint64_t number = 0, n_tags = 0, corner = 0;
    int kind = 0;
    row >> number >> kind >> n_tags;
    if (!row || n_tags > 100) msh.fail("`" + line.substr(0, 60) + "` is no element");
    if (kind != TETRAHEDRON) continue;
    for (; n_tags > 0; --n_tags) row >> number;
    for (int k = 0; k < 4; ++k) {
      row >> corner;
      const auto node = nodes.find(corner);
      if (!row || node == nodes.end())
        msh.fail("the element `" + line.substr(0, 60) + "` names a node that is not there");
      const auto [at, is_new] = known.insert({corner, std::uint32_t(mesh.points.size())});
      if (is_new) mesh.points.push_back(node->second);
      mesh.elements.push_back(at->second);
    }
  }
  if (mesh.elements.empty()) msh.fail("it holds no tetrahedra of four nodes");
  const std::vector<double> volumes = element_volumes(mesh);
  for (std::size_t e = 0; e < volumes.size(); ++e) {
    if (!(std::abs(volumes[e]) > 0))
      throw UsageError(file.string() + ": tetrahedron " + std::to_string(e + 1) + " has no volume; mesh it anew");
    if (volumes[e] < 0) std::swap(mesh.elements[4 * e + 2], mesh.elements[4 * e + 3]);
  }
  mesh.surface = boundary_triangles(mesh);
  return mesh;
}

}  // namespace pvg
