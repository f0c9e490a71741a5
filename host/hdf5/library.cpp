#include "host/hdf5/library.hpp"

#include <utility>

namespace pvg::hdf5 {

void be_quiet_in_this_thread() {
  thread_local bool is_quiet = false;
  if (!std::exchange(is_quiet, true)) H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

void prepare_library() {
  H5dont_atexit();
  be_quiet_in_this_thread();
}

// Calls of the library that can fail ask for an id, in whichever thread they are made.
std::int64_t Handle::id() const {
  be_quiet_in_this_thread();
  return id_;
}

hid_t in_memory(Type type) {
  switch (type) {
    case Type::f64:
      return H5T_NATIVE_DOUBLE;
    case Type::f32:
      return H5T_NATIVE_FLOAT;
    case Type::i64:
      return H5T_NATIVE_INT64;
    case Type::u64:
      return H5T_NATIVE_UINT64;
    case Type::i32:
      return H5T_NATIVE_INT32;
    case Type::u32:
      return H5T_NATIVE_UINT32;
    case Type::u16:
      return H5T_NATIVE_UINT16;
    case Type::u8:
      return H5T_NATIVE_UINT8;
  }
  return -1;
}

hid_t on_disk(Type type) {
  switch (type) {
    case Type::f64:
      return H5T_IEEE_F64LE;
    case Type::f32:
      return H5T_IEEE_F32LE;
    case Type::i64:
      return H5T_STD_I64LE;
    case Type::u64:
      return H5T_STD_U64LE;
    case Type::i32:
      return H5T_STD_I32LE;
    case Type::u32:
      return H5T_STD_U32LE;
    case Type::u16:
      return H5T_STD_U16LE;
    case Type::u8:
      return H5T_STD_U8LE;
  }
  return -1;
}

std::size_t bytes_of(Type type) { return H5Tget_size(in_memory(type)); }

Handle dataspace(const Shape& shape, const Shape& most) {
  if (shape.empty()) return own<H5Sclose>(H5Screate(H5S_SCALAR));
  return own<H5Sclose>(H5Screate_simple(int(shape.size()), sizes(shape), most.empty() ? sizes(shape) : sizes(most)));
}

Handle dataset_properties() {
  Handle properties = own<H5Pclose>(H5Pcreate(H5P_DATASET_CREATE));
  H5Pset_obj_track_times(properties.id(), false);
  return properties;
}

}  // namespace pvg::hdf5
