// Data sets of an HDF5 file that grow row by row.
#pragma once
#include <memory>
#include <span>
#include <string>

#include "host/hdf5/file.hpp"

namespace pvg::hdf5 {

class DeflatedChunks;

// How a series lies on disk; what is read is the same.
struct Storage {
  int deflate = 0;        // level of compression, 1 to 9; 0: none
  bool shuffles = false;  // before it: bytes of the same significance go side by side
  Shape chunk;            // what is compressed together, [rows, ...]; empty: rows of about 64 KiB
};

class SeriesBase {
 public:
  ~SeriesBase();
  SeriesBase(SeriesBase&&) noexcept;

 protected:
  SeriesBase(File& file, const std::string& object, const Shape& row, Type type, const Storage& storage);
  void append_raw(const void* values, std::size_t n);

 private:
  File* file_;
  std::string object_;
  Shape row_;
  Type type_;
  std::uint64_t n_rows_ = 0;
  Handle dataset_;
  std::unique_ptr<DeflatedChunks> deflated_;  // where it is compressed
};

// A data set [n, row...] that grows: append() takes whole rows, any number of them. Rows that are compressed wait until
// they fill a chunk. Must not outlive its file's close, which throws if the last rows could not be written.
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
