// HDF5 files: one owner per handle, arrays with their shape, attributes, series that grow row by row. The same writes
// give the same bytes: objects carry no times. Errors name file and object.
#pragma once
#include <cstdint>
#include <filesystem>
#include <numeric>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "host/base/error.hpp"

namespace pvg::hdf5 {

using Shape = std::vector<std::uint64_t>;

inline std::uint64_t n_values(std::span<const std::uint64_t> shape) {
  return std::accumulate(shape.begin(), shape.end(), std::uint64_t(1), std::multiplies<>());
}

// A number type that files may hold: double, float, 8- to 64-bit integers. Little-endian on disk.
enum class Type { f64, f32, i64, u64, i32, u32, u16, u8 };
template <class T>
constexpr Type type_of();
template <>
constexpr Type type_of<double>() {
  return Type::f64;
}
template <>
constexpr Type type_of<float>() {
  return Type::f32;
}
template <>
constexpr Type type_of<std::int64_t>() {
  return Type::i64;
}
template <>
constexpr Type type_of<std::uint64_t>() {
  return Type::u64;
}
template <>
constexpr Type type_of<std::int32_t>() {
  return Type::i32;
}
template <>
constexpr Type type_of<std::uint32_t>() {
  return Type::u32;
}
template <>
constexpr Type type_of<std::uint16_t>() {
  return Type::u16;
}
template <>
constexpr Type type_of<std::uint8_t>() {
  return Type::u8;
}

// An HDF5 identifier and the function that closes it.
class Handle {
 public:
  using Close = int (*)(std::int64_t);
  Handle() = default;
  Handle(std::int64_t id, Close close) : id_(id), close_(close) {}
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(close_, other.close_);
    return *this;
  }
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  std::int64_t id() const;

 private:
  std::int64_t id_ = -1;
  Close close_ = nullptr;
};

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
  bool is_input_ = false;  // opened to read: what fails is the file's fault
  Handle handle_;
};

// How a series lies on disk; what is read is the same.
struct Storage {
  int deflate = 0;        // level of compression, 0: none
  bool shuffles = false;  // before it: bytes of the same significance go side by side
  Shape chunk;            // what is compressed together, [rows, ...]; empty: rows of about 64 KiB
};

class SeriesBase {
 protected:
  SeriesBase(File& file, const std::string& object, const Shape& row, Type type, const Storage& storage);
  void append_raw(const void* values, std::size_t n);

 private:
  const File* file_;
  std::string object_;
  Shape row_;
  Type type_;
  std::uint64_t n_rows_ = 0;
  Handle dataset_;
};

// A data set [n, row...] that grows: append() takes whole rows, any number of them. Must not outlive its file's close.
template <class T>
class Series : SeriesBase {
 public:
  Series(File& file, const std::string& object, const Shape& row, bool is_compressed = false)
      : Series(file, object, row, Storage{is_compressed ? 4 : 0, false, {}}) {}
  Series(File& file, const std::string& object, const Shape& row, const Storage& storage)
      : SeriesBase(file, object, row, type_of<T>(), storage) {}
  void append(std::span<const T> values) { append_raw(values.data(), values.size()); }
};

}  // namespace pvg::hdf5
