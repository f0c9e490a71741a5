// The compressed chunks of a data set that grows: what HDF5's filters "shuffle" and "deflate" would make of them, made
// by libdeflate, which takes less time and room than zlib, and outside of the lock that HDF5 holds. Any reader of HDF5
// takes them.
#pragma once
#include <cstddef>
#include <memory>
#include <vector>

#include "host/hdf5/types.hpp"

struct libdeflate_compressor;

namespace pvg::hdf5 {

struct Storage;

class DeflatedChunks {
 public:
  // dataset: HDF5's identifier of an empty data set [0, row...] in chunks [rows, ...] with these filters, which lives
  // longer than this. No size is 0.
  DeflatedChunks(const Handle& dataset, const Shape& row, const Shape& chunk, std::size_t bytes_per_value,
                 const Storage& storage);
  // [n, row...]; writes the chunks that the rows fill. false: something could not be written
  bool append(const std::byte* rows, std::uint64_t n);
  // writes the rows that wait; a chunk that they do not fill ends with zeros, as HDF5's would
  bool finish();

 private:
  std::uint64_t n_waiting() const { return waiting_.size() / strides_[0]; }
  bool write_waiting();
  bool write_chunk(const Shape& start);
  void gather(const std::byte* from, std::byte* to, const Shape& start, std::size_t dimension) const;

  std::int64_t dataset_;
  Shape shape_;                    // of what is written and of what waits, [rows, row...]
  Shape chunk_;                    // [rows, ...]
  Shape strides_, chunk_strides_;  // bytes from one index to the next, by dimension
  std::size_t bytes_per_value_;
  bool shuffles_;
  std::unique_ptr<libdeflate_compressor, void (*)(libdeflate_compressor*)> compressor_;
  std::vector<std::byte> waiting_;                         // [fewer than chunk_[0], row...]
  std::vector<std::byte> values_, shuffled_, compressed_;  // of one chunk
};

}  // namespace pvg::hdf5
