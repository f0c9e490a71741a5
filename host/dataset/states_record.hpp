// The one reader of states.h5 (states_file.hpp): what it gives fits together, whatever the file holds. Shapes, ranges
// and indices are checked where they are read; a UsageError names the file and the data set.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "host/hdf5/series.hpp"

namespace pvg {

class StatesRecord {
 public:
  // Of a body: the data set and the row in it that hold where it was.
  struct Body {
    std::string name, data_set;
    std::size_t number = 0;  // in the list
    std::size_t row = 0;
    std::size_t n_nodes = 0;  // of a soft body or a cloth
    bool is_rigid = false, is_fixed = false;
  };
  struct Mesh {
    std::vector<double> rest;              // [V x 3, m]
    std::vector<std::uint32_t> triangles;  // [n x 3], each below V
  };
  // A number per step for each of several names, such as joints.
  struct Series {
    std::vector<std::string> names;
    std::vector<double> values;  // [T][names]
    double at(std::size_t step, std::size_t name) const { return values[step * names.size() + name]; }
  };
  struct PairForces {
    std::vector<std::size_t> offset;   // [T + 1] ascending, into the lists below
    std::vector<std::int64_t> bodies;  // [n x 2]
    std::vector<double> normal;        // [n x 3, N]
  };
  // Of a camera, each frame: 9 numbers of K, 16 of the pose.
  struct CameraRows {
    std::vector<double> K, T_world_camera;
  };

  explicit StatesRecord(const std::filesystem::path& file);

  const std::filesystem::path& path() const { return path_; }
  std::size_t n_steps() const { return times_.size(); }
  const std::vector<double>& times() const { return times_; }  // [s] ascending
  std::vector<std::size_t> filmed_steps() const;               // ascending; empty: there are no pictures
  // Those whose nodes of soft bodies and cloths are kept, ascending; all where there are none.
  std::vector<std::size_t> kept_steps() const;
  bool has(const std::string& object) const { return file_.has(object); }

  Series series(const std::string& object) const;                              // /q, /a, /torque
  std::vector<std::string> poses_names(const std::string& object) const;       // of the n bodies in [T, n, 3, 4]
  std::vector<double> poses(const std::string& object) const;                  // [T, n, 3, 4]
  std::vector<double> row(const std::string& object, std::size_t step) const;  // of a body's data set
  std::vector<double> rows(const std::string& object) const;  // all of them; NaN: of steps that are not kept
  // Before the first step, of a data set that has a row per step, such as /q: what its row would be.
  bool has_start() const { return file_.has("/start/q"); }
  std::vector<double> start(const std::string& object) const;
  std::vector<double> start_camera(const std::string& name) const;  // 16 numbers of its pose
  std::vector<Body> bodies() const;
  bool has_mesh(const Body& body) const { return file_.has("/mesh/" + body.name + "/triangles"); }
  Mesh mesh(const Body& body) const;
  std::vector<std::pair<std::size_t, std::size_t>> noncolliding(std::size_t n_bodies) const;
  PairForces pair_forces() const;
  CameraRows camera(const std::string& name, std::size_t n_frames) const;
  std::vector<std::pair<std::string, double>> sampled() const;  // what was drawn; empty: nothing

  std::string text(const std::string& attribute) const;  // of the file
  std::uint64_t whole(const std::string& attribute) const;
  double positive(const std::string& attribute) const;

 private:
  [[noreturn]] void fail(const std::string& object, const std::string& what) const;
  // values of a data set of this shape; ANY stands for any length
  static constexpr std::uint64_t ANY = ~std::uint64_t(0);
  hdf5::Shape demand_shape(const std::string& object, const hdf5::Shape& wanted) const;
  template <class T>
  std::vector<T> read(const std::string& object, const hdf5::Shape& wanted) const;
  void demand_finite(const std::string& object, const std::vector<double>& values) const;
  std::vector<std::size_t> steps_in(const std::string& object) const;  // ascending
  std::vector<std::string> names_of(const std::string& object, std::size_t n) const;

  std::filesystem::path path_;
  hdf5::File file_;
  std::vector<double> times_;
};

}  // namespace pvg
