// HDF5 files: arrays with their shape, attributes. The same writes give the same bytes: objects carry no times. Errors
// name file and object.
#pragma once
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "host/base/error.hpp"
#include "host/hdf5/types.hpp"

namespace pvg::hdf5 {

template <class T>
struct Array {
  Shape shape;
  std::vector<T> values;  // row by row
};

class File {
 public:
  static File create(const std::filesystem::path& path);  // replaces what is there
  static File open(const std::filesystem::path& path);    // to read
  void close();                                           // throws if something could not be written

  // Objects are named by their path, "/mesh/beaker/rest"; groups above are made on the way.
  template <class T>
  void write(const std::string& object, const Shape& shape, std::span<const T> values) {
    write_raw(object, shape, type_of<T>(), values.data(), values.size());
  }
  template <class T>
  void write(const std::string& object, const Shape& shape, const std::vector<T>& values) {
    write(object, shape, std::span<const T>(values));
  }
  void write_texts(const std::string& object, const std::vector<std::string>& texts);
  void make_group(const std::string& object);
  // of an object that exists; "/" is the file itself
  void attribute(const std::string& object, const std::string& name, const std::string& text);
  void attribute(const std::string& object, const std::string& name, std::int64_t number);
  void attribute(const std::string& object, const std::string& name, std::uint64_t number);
  void attribute(const std::string& object, const std::string& name, double number);
  void attribute(const std::string& object, const std::string& name, const std::vector<std::string>& texts);

  bool has(const std::string& object) const;
  std::vector<std::string> children(const std::string& group) const;  // sorted by name
  template <class T>
  Array<T> read(const std::string& object) const {
    Array<T> array{shape(object), {}};
    demand_plausible(object, array.shape, sizeof(T));
    array.values.resize(n_values(array.shape));
    read_raw(object, type_of<T>(), array.values.data());
    return array;
  }
  // one row of [n, ...]
  template <class T>
  std::vector<T> read_row(const std::string& object, std::uint64_t row) const {
    Shape shape = this->shape(object);
    if (!shape.empty()) shape[0] = 1;
    demand_plausible(object, shape, sizeof(T));
    std::vector<T> values(n_values(shape));
    read_row_raw(object, row, type_of<T>(), values.data());
    return values;
  }
  Shape shape(const std::string& object) const;
  std::string text_attribute(const std::string& object, const std::string& name) const;
  double number_attribute(const std::string& object, const std::string& name) const;
  std::uint64_t unsigned_attribute(const std::string& object, const std::string& name) const;
  std::vector<std::string> texts_attribute(const std::string& object, const std::string& name) const;

 private:
  friend class SeriesBase;
  void make_parent(const std::string& object);
  void write_raw(const std::string& object, const Shape& shape, Type type, const void* values, std::size_t n);
  void read_raw(const std::string& object, Type type, void* values) const;
  void read_row_raw(const std::string& object, std::uint64_t row, Type type, void* values) const;
  // a damaged file may claim more values than memory holds
  void demand_plausible(const std::string& object, const Shape& shape, std::size_t bytes_per_value) const;
  Handle open_object(const std::string& object) const;
  [[noreturn]] void fail(const std::string& what, const std::string& object) const;
  std::filesystem::path path_;
  std::string lost_;       // a series whose last rows could not be written
  bool is_input_ = false;  // opened to read: what fails is the file's fault
  Handle handle_;
};

}  // namespace pvg::hdf5
