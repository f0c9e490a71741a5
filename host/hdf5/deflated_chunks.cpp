#include "host/hdf5/deflated_chunks.hpp"

#include <libdeflate.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <new>

#include "host/hdf5/library.hpp"
#include "host/hdf5/series.hpp"

namespace pvg::hdf5 {
namespace {

static_assert(std::endian::native == std::endian::little, "chunks are written as the processor holds them");

// Bytes from one index of an array to the next, by dimension.
Shape strides(const Shape& shape, std::size_t bytes_per_value) {
  Shape result(shape.size());
  std::uint64_t bytes = bytes_per_value;
  for (std::size_t i = shape.size(); i-- > 0; bytes *= shape[i]) result[i] = bytes;
  return result;
}

// First bytes of all values, then second bytes, and so on.
void shuffle(const std::vector<std::byte>& values, std::size_t bytes_per_value, std::vector<std::byte>& shuffled) {
  const std::size_t n = values.size() / bytes_per_value;
  shuffled.resize(values.size());
  for (std::size_t byte = 0; byte < bytes_per_value; ++byte)
    for (std::size_t i = 0; i < n; ++i) shuffled[byte * n + i] = values[i * bytes_per_value + byte];
}

}  // namespace

DeflatedChunks::DeflatedChunks(const Handle& dataset, const Shape& row, const Shape& chunk, std::size_t bytes_per_value,
                               const Storage& storage)
    : dataset_(dataset.id()),
      shape_(row),
      chunk_(chunk),
      chunk_strides_(strides(chunk, bytes_per_value)),
      bytes_per_value_(bytes_per_value),
      shuffles_(storage.shuffles && bytes_per_value > 1),
      compressor_(libdeflate_alloc_compressor(storage.deflate), libdeflate_free_compressor),
      values_(n_values(chunk) * bytes_per_value) {
  if (!compressor_) throw std::bad_alloc();
  shape_.insert(shape_.begin(), 0);
  strides_ = strides(shape_, bytes_per_value);
  compressed_.resize(libdeflate_zlib_compress_bound(compressor_.get(), values_.size()));
}

bool DeflatedChunks::append(const std::byte* rows, std::uint64_t n) {
  while (n > 0) {
    const std::uint64_t taken = std::min(n, chunk_[0] - n_waiting());
    waiting_.insert(waiting_.end(), rows, rows + taken * strides_[0]);
    rows += taken * strides_[0];
    n -= taken;
    if (n_waiting() == chunk_[0] && !write_waiting()) return false;
  }
  return true;
}

bool DeflatedChunks::finish() { return waiting_.empty() || write_waiting(); }

bool DeflatedChunks::write_waiting() {
  Shape start(shape_.size(), 0);
  start[0] = shape_[0];
  shape_[0] += n_waiting();
  bool is_written = H5Dset_extent(dataset_, sizes(shape_)) >= 0;
  while (is_written) {
    is_written = write_chunk(start);
    // the next one, last dimension first
    std::size_t i = start.size() - 1;
    for (; i > 0 && (start[i] += chunk_[i]) >= shape_[i]; --i) start[i] = 0;
    if (i == 0) break;
  }
  waiting_.clear();
  return is_written;
}

bool DeflatedChunks::write_chunk(const Shape& start) {
  std::fill(values_.begin(), values_.end(), std::byte(0));
  gather(waiting_.data(), values_.data(), start, 0);
  if (shuffles_) shuffle(values_, bytes_per_value_, shuffled_);
  const std::vector<std::byte>& given = shuffles_ ? shuffled_ : values_;
  const std::size_t bytes =
      libdeflate_zlib_compress(compressor_.get(), given.data(), given.size(), compressed_.data(), compressed_.size());
  return bytes > 0 && H5Dwrite_chunk(dataset_, H5P_DEFAULT, 0, sizes(start), bytes, compressed_.data()) >= 0;
}

// The part of the waiting rows that a chunk covers, from `dimension` on.
void DeflatedChunks::gather(const std::byte* from, std::byte* to, const Shape& start, std::size_t dimension) const {
  const std::uint64_t first = dimension == 0 ? 0 : start[dimension];  // rows that wait are those of this chunk
  const std::uint64_t n = std::min(chunk_[dimension], dimension == 0 ? n_waiting() : shape_[dimension] - first);
  from += first * strides_[dimension];
  if (dimension + 1 == shape_.size()) {
    std::memcpy(to, from, n * bytes_per_value_);
    return;
  }
  for (std::uint64_t i = 0; i < n; ++i)
    gather(from + i * strides_[dimension], to + i * chunk_strides_[dimension], start, dimension + 1);
}

}  // namespace pvg::hdf5
