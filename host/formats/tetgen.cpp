#include "host/formats/tetgen.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <optional>
#include <sstream>

#include "host/base/child_process.hpp"
#include "host/base/child_program.hpp"
#include "host/base/error.hpp"
#include "host/base/kept_results.hpp"
#include "host/geometry/mesh_checks.hpp"
#include "host/geometry/tet_mesh.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t MOST_KEPT_MESHES = 50;  // meshes

// A folder of its own under the system's temporary folder, gone at the end.
struct TemporaryFolder {
  fs::path path;
  TemporaryFolder() {
    std::string pattern = (fs::temp_directory_path() / "phyvisgen_tetgen_XXXXXX").string();
    if (!mkdtemp(pattern.data()))
      throw Failure(pattern + ": no temporary folder can be made: " + std::strerror(errno) + ".");
    path = pattern;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
};

void write_smesh(const fs::path& file, const TriangleMesh& surface) {
  std::ofstream out(file);
  out << std::setprecision(17) << surface.points.size() << " 3 0 0\n";
  for (std::size_t i = 0; i < surface.points.size(); ++i) {
    const Vec3& p = surface.points[i];
    out << i << " " << p.x() << " " << p.y() << " " << p.z() << "\n";
  }
  out << surface.triangles.size() << " 0\n";
  for (const Triangle& t : surface.triangles) out << "3 " << t[0] << " " << t[1] << " " << t[2] << "\n";
  out << "0\n0\n";
  if (!out.flush()) throw Failure(file.string() + ": cannot be written.");
}

// p: a surface is given, z: numbers from 0, Y: nothing is added on the surface, q: quality, a: largest volume, O: all
// ways of optimisation, o/: largest dihedral angle
std::string switches(const TetgenOptions& options) {
  std::ostringstream s;
  s << std::setprecision(9) << "-pz";
  if (options.keeps_surface) s << "Y";
  if (options.radius_edge_ratio > 0) s << "q" << options.radius_edge_ratio;
  if (options.radius_edge_ratio > 0 && options.least_dihedral > 0) s << "/" << options.least_dihedral;
  if (options.max_volume > 0) s << "a" << std::fixed << std::setprecision(18) << options.max_volume;
  if (options.largest_dihedral > 0) s << "O9/7o/" << options.largest_dihedral;
  return s.str();
}

// Runs the program with its words in `log`; its exit code, or -1 where a signal ended it.
int run_tetgen(const std::string& options, const fs::path& input, const fs::path& log) {
  const int file = open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
  std::optional<ChildProgram> program;
  try {
    program.emplace("tetgen", std::vector<std::string>{options, input.string()}, ChildProgram::Files{-1, file, file},
                    ChildProgram::Signals::shared);
  } catch (const Failure& failure) {
    close(file);
    throw Failure(std::string("The program `tetgen`, which fills soft bodies with tetrahedra, cannot be run (") +
                  failure.what() + "): install it with `apt-get install tetgen` and see that it is on the PATH.");
  }
  close(file);
  return program->wait();
}

std::string last_line(const fs::path& log) {
  std::ifstream in(log);
  std::string line, last;
  while (std::getline(in, line)) {
    if (!line.empty()) last = line;
  }
  return last;
}

// The numbers of a .node or .ele file, row by row: `width` after the row's own number.
template <typename T>
std::vector<T> read_rows(const fs::path& file, int width, const std::string& name) {
  std::ifstream in(file);
  std::size_t n = 0;
  std::string rest;
  if (!(in >> n) || !std::getline(in, rest))
    throw Failure(name + ": tetgen left no readable " + file.extension().string() + ".");
  std::vector<T> values(n * width);
  for (std::size_t i = 0; i < n; ++i) {
    std::size_t number;
    in >> number;
    for (int k = 0; k < width; ++k) in >> values[i * width + k];
    std::getline(in, rest);
  }
  if (!in || n == 0) throw Failure(name + ": tetgen's " + file.extension().string() + " file is cut off.");
  return values;
}

TetMesh read_result(const fs::path& base, const TriangleMesh& surface, const std::string& name) {
  const auto nodes = read_rows<double>(base.string() + ".node", 3, name);
  TetMesh mesh;
  mesh.nodes_per_element = 4;
  mesh.elements = read_rows<std::uint32_t>(base.string() + ".ele", 4, name);
  for (std::size_t i = 0; i < nodes.size() / 3; ++i)
    mesh.points.emplace_back(nodes[3 * i], nodes[3 * i + 1], nodes[3 * i + 2]);
  // the file rounds the last digits: the surface's own points are put back
  for (std::size_t i = 0; i < surface.points.size(); ++i) mesh.points.at(i) = surface.points[i];
  const std::vector<double> volumes = element_volumes(mesh);
  for (std::size_t e = 0; e < volumes.size(); ++e) {
    if (volumes[e] < 0) std::swap(mesh.elements[4 * e + 2], mesh.elements[4 * e + 3]);
    if (!(std::abs(volumes[e]) > 0))
      throw Failure(name + ": tetgen made a tetrahedron without volume; try a finer surface.");
  }
  mesh.surface = boundary_triangles(mesh);
  return mesh;
}

}  // namespace

namespace {

TetMesh run(const TriangleMesh& surface, const TetgenOptions& options, const std::string& name) {
  const TemporaryFolder folder;
  const fs::path input = folder.path / "surface.smesh", log = folder.path / "log.txt";
  write_smesh(input, surface);
  const int code = run_tetgen(switches(options), input, log);
  if (code != 0 || !fs::exists(folder.path / "surface.1.ele")) {
    throw Failure(name + ": tetgen cannot fill this surface (exit code " + std::to_string(code) + ", last words: \"" +
                  last_line(log) + "\"): look for triangles that intersect each other.");
  }
  const TetMesh linear = read_result(folder.path / "surface.1", surface, name);
  return options.nodes_per_element == 10 ? make_quadratic(linear) : linear;
}

}  // namespace

TetMesh tetrahedralize(const TriangleMesh& surface, const TetgenOptions& options, const std::string& name) {
  check_closed_surface(surface, name);
  static KeptResults<TetMesh> kept(MOST_KEPT_MESHES);
  std::string key = switches(options) + " " + std::to_string(options.nodes_per_element) + "\n";
  pack(key, surface.points);
  pack(key, surface.triangles);
  return kept.of(key, [&] { return run(surface, options, name); });
}

}  // namespace pvg
