#include "host/hdf5/series.hpp"

#include <algorithm>

#include "host/hdf5/deflated_chunks.hpp"
#include "host/hdf5/library.hpp"

namespace pvg::hdf5 {
namespace {

// Rows per chunk: about 64 KiB, but no more than a short episode fills.
std::uint64_t chunk_rows(std::uint64_t row_bytes) {
  return std::clamp<std::uint64_t>((64u << 10) / std::max<std::uint64_t>(row_bytes, 1), 1, 256);
}

Shape with_rows(std::uint64_t n, Shape row) {
  row.insert(row.begin(), n);
  return row;
}

}  // namespace

SeriesBase::SeriesBase(File& file, const std::string& object, const Shape& row, Type type, const Storage& storage)
    : file_(&file), object_(object), row_(row), type_(type) {
  const std::size_t bytes = bytes_of(type);
  Shape chunk = storage.chunk.empty() ? with_rows(chunk_rows(n_values(row) * bytes), row) : storage.chunk;
  for (std::uint64_t& length : chunk) length = std::max<std::uint64_t>(length, 1);  // a chunk must not be empty
  const Handle properties = dataset_properties(), space = dataspace(with_rows(0, row), with_rows(H5S_UNLIMITED, row));
  file.make_parent(object);
  H5Pset_chunk(properties.id(), int(chunk.size()), sizes(chunk));
  if (storage.shuffles) H5Pset_shuffle(properties.id());
  if (storage.deflate > 0) H5Pset_deflate(properties.id(), unsigned(storage.deflate));
  dataset_ = own<H5Dclose>(H5Dcreate2(file.handle_.id(), object.c_str(), on_disk(type), space.id(), H5P_DEFAULT,
                                      properties.id(), H5P_DEFAULT));
  if (dataset_.id() < 0) file.fail("create", object);
  if (storage.deflate > 0 && n_values(row) > 0)
    deflated_ = std::make_unique<DeflatedChunks>(dataset_, row, chunk, bytes, storage);
}

SeriesBase::SeriesBase(SeriesBase&&) noexcept = default;

SeriesBase::~SeriesBase() {
  if (deflated_ && !deflated_->finish()) file_->lost_ = object_;
}

void SeriesBase::append_raw(const void* values, std::size_t n) {
  const std::uint64_t per_row = n_values(row_);
  if (per_row == 0 ? n != 0 : n % per_row != 0) file_->fail("append a broken row to", object_);
  const std::uint64_t count = per_row == 0 ? 1 : n / per_row;
  if (count == 0) return;
  if (deflated_) {
    if (!deflated_->append(static_cast<const std::byte*>(values), count)) file_->fail("write", object_);
    return;
  }
  if (H5Dset_extent(dataset_.id(), sizes(with_rows(n_rows_ + count, row_))) < 0) file_->fail("extend", object_);
  if (n > 0) {
    Shape start(row_.size() + 1, 0);
    start[0] = n_rows_;
    const Shape added = with_rows(count, row_);
    const Handle in_file = own<H5Sclose>(H5Dget_space(dataset_.id())), given = dataspace(added);
    H5Sselect_hyperslab(in_file.id(), H5S_SELECT_SET, sizes(start), nullptr, sizes(added), nullptr);
    if (H5Dwrite(dataset_.id(), in_memory(type_), given.id(), in_file.id(), H5P_DEFAULT, values) < 0)
      file_->fail("write", object_);
  }
  n_rows_ += count;
}

}  // namespace pvg::hdf5
