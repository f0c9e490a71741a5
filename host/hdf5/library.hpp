// HDF5's own names and ours: seen inside this folder alone.
#pragma once
#include <hdf5.h>

#include <cstddef>

#include "host/hdf5/types.hpp"

namespace pvg::hdf5 {

// The library's own print of its error stack would stand beside our one sentence. It is a setting of each thread.
void be_quiet_in_this_thread();

// Before anything else of the library. What it does at the end of the program crashes where a file could not be written
// to its end. Files have owners that close them.
void prepare_library();

template <auto close>
Handle own(hid_t id) {
  return Handle(id, [](std::int64_t value) {
    be_quiet_in_this_thread();
    return int(close(value));
  });
}

hid_t in_memory(Type type);
hid_t on_disk(Type type);
std::size_t bytes_of(Type type);

static_assert(sizeof(hsize_t) == sizeof(std::uint64_t));
inline const hsize_t* sizes(const Shape& shape) { return reinterpret_cast<const hsize_t*>(shape.data()); }
// most: what the shape may grow to; empty: it does not grow
Handle dataspace(const Shape& shape, const Shape& most = {});

// creation properties of a data set: no times, so that equal contents are equal bytes
Handle dataset_properties();

}  // namespace pvg::hdf5
