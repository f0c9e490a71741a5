#include "host/hdf5/file.hpp"

#include <algorithm>

#include "host/base/outputs.hpp"
#include "host/hdf5/library.hpp"

namespace pvg::hdf5 {
namespace {

Handle text_type(std::size_t bytes) {
  Handle type = own<H5Tclose>(H5Tcopy(H5T_C_S1));
  H5Tset_size(type.id(), std::max<std::size_t>(bytes, 1));
  H5Tset_strpad(type.id(), H5T_STR_NULLPAD);
  H5Tset_cset(type.id(), H5T_CSET_UTF8);
  return type;
}

}  // namespace

void File::fail(const std::string& what, const std::string& object) const {
  if (is_input_)
    throw UsageError(path_.string() + ": " +
                     (what.find("attribute") == std::string::npos ? "" : what.substr(what.find("the")) + " ") + object +
                     " could not be read: the file is damaged or was not made by this "
                     "program; make it again");
  throw Failure(path_.string() + ": HDF5 could not " + what + " " + object +
                (what == "write" ? "; is the disk full?" : ""));
}

File File::create(const std::filesystem::path& path) {
  prepare_library();
  File file;
  file.path_ = path;
  const Handle access = own<H5Pclose>(H5Pcreate(H5P_FILE_ACCESS));
  // attributes longer than 64 KiB need the layout of version 1.8 or later
  H5Pset_libver_bounds(access.id(), H5F_LIBVER_V18, H5F_LIBVER_LATEST);
  const Handle creation = own<H5Pclose>(H5Pcreate(H5P_FILE_CREATE));
  H5Pset_obj_track_times(creation.id(), false);  // of the root group
  file.handle_ = own<H5Fclose>(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, creation.id(), access.id()));
  if (file.handle_.id() < 0)
    throw Failure(path.string() + ": the HDF5 file could not be created; is the folder writable?");
  return file;
}

File File::open(const std::filesystem::path& path) {
  prepare_library();
  File file;
  file.path_ = path;
  remember_read(path);
  file.is_input_ = true;
  file.handle_ = own<H5Fclose>(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT));
  if (file.handle_.id() < 0) throw UsageError(path.string() + ": no HDF5 file that can be read");
  return file;
}

void File::close() {
  if (handle_.id() < 0) return;
  const bool is_flushed = H5Fflush(handle_.id(), H5F_SCOPE_LOCAL) >= 0;
  handle_ = Handle();
  if (!lost_.empty()) fail("write", lost_);
  if (!is_flushed) fail("write", "the end of the file");
}

void File::make_group(const std::string& object) {
  // level by level: groups that the library makes on its own would carry times
  const Handle properties = own<H5Pclose>(H5Pcreate(H5P_GROUP_CREATE));
  H5Pset_obj_track_times(properties.id(), false);
  for (std::size_t end = 1; end != std::string::npos;) {
    end = object.find('/', end + 1);
    const std::string level = object.substr(0, end);
    if (has(level)) continue;
    const Handle group =
        own<H5Gclose>(H5Gcreate2(handle_.id(), level.c_str(), H5P_DEFAULT, properties.id(), H5P_DEFAULT));
    if (group.id() < 0) fail("make the group", level);
  }
}

void File::make_parent(const std::string& object) {
  const std::size_t end = object.rfind('/');
  if (end != std::string::npos && end > 0) make_group(object.substr(0, end));
}

void File::write_raw(const std::string& object, const Shape& shape, Type type, const void* values, std::size_t n) {
  if (n != n_values(shape)) fail("write (its shape does not fit " + std::to_string(n) + " values)", object);
  const Handle space = dataspace(shape), properties = dataset_properties();
  make_parent(object);
  const Handle dataset = own<H5Dclose>(
      H5Dcreate2(handle_.id(), object.c_str(), on_disk(type), space.id(), H5P_DEFAULT, properties.id(), H5P_DEFAULT));
  if (dataset.id() < 0) fail("create", object);
  if (n && H5Dwrite(dataset.id(), in_memory(type), H5S_ALL, H5S_ALL, H5P_DEFAULT, values) < 0) fail("write", object);
}

Handle File::open_object(const std::string& object) const {
  Handle handle = own<H5Oclose>(H5Oopen(handle_.id(), object.c_str(), H5P_DEFAULT));
  if (handle.id() < 0) fail("find", object);
  return handle;
}

namespace {
bool write_attribute(const Handle& object, const std::string& name, hid_t stored, hid_t given, const Shape& shape,
                     const void* value) {
  const Handle space = dataspace(shape);
  const Handle attribute =
      own<H5Aclose>(H5Acreate2(object.id(), name.c_str(), stored, space.id(), H5P_DEFAULT, H5P_DEFAULT));
  return attribute.id() >= 0 && H5Awrite(attribute.id(), given, value) >= 0;
}
}  // namespace

void File::attribute(const std::string& object, const std::string& name, const std::string& text) {
  const Handle type = text_type(text.size());
  const std::string at_least_one = text.empty() ? std::string(1, '\0') : text;
  if (!write_attribute(open_object(object), name, type.id(), type.id(), {}, at_least_one.data()))
    fail("write the attribute " + name + " of", object);
}

namespace {
// texts of one length, side by side
struct PackedTexts {
  explicit PackedTexts(const std::vector<std::string>& texts) {
    for (const std::string& text : texts) longest = std::max(longest, text.size());
    bytes.assign(longest * std::max<std::size_t>(texts.size(), 1), '\0');
    for (std::size_t i = 0; i < texts.size(); ++i) texts[i].copy(bytes.data() + i * longest, longest);
  }
  std::size_t longest = 1;
  std::string bytes;
};
}  // namespace

void File::attribute(const std::string& object, const std::string& name, const std::vector<std::string>& texts) {
  const PackedTexts packed(texts);
  const Handle type = text_type(packed.longest);
  if (!write_attribute(open_object(object), name, type.id(), type.id(), {texts.size()}, packed.bytes.data()))
    fail("write the attribute " + name + " of", object);
}

void File::write_texts(const std::string& object, const std::vector<std::string>& texts) {
  const PackedTexts packed(texts);
  const Handle type = text_type(packed.longest), space = dataspace({texts.size()}), properties = dataset_properties();
  make_parent(object);
  const Handle dataset = own<H5Dclose>(
      H5Dcreate2(handle_.id(), object.c_str(), type.id(), space.id(), H5P_DEFAULT, properties.id(), H5P_DEFAULT));
  if (dataset.id() < 0) fail("create", object);
  if (!texts.empty() && H5Dwrite(dataset.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, packed.bytes.data()) < 0)
    fail("write", object);
}

void File::attribute(const std::string& object, const std::string& name, std::int64_t number) {
  if (!write_attribute(open_object(object), name, H5T_STD_I64LE, H5T_NATIVE_INT64, {}, &number))
    fail("write the attribute " + name + " of", object);
}

void File::attribute(const std::string& object, const std::string& name, std::uint64_t number) {
  if (!write_attribute(open_object(object), name, H5T_STD_U64LE, H5T_NATIVE_UINT64, {}, &number))
    fail("write the attribute " + name + " of", object);
}

void File::attribute(const std::string& object, const std::string& name, double number) {
  if (!write_attribute(open_object(object), name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, {}, &number))
    fail("write the attribute " + name + " of", object);
}

bool File::has(const std::string& object) const {
  // a link below a group that is missing is an error to the library: ask level by level
  for (std::size_t end = 1; end != std::string::npos;) {
    end = object.find('/', end + 1);
    const std::string level = object.substr(0, end);
    if (level != "/" && H5Lexists(handle_.id(), level.c_str(), H5P_DEFAULT) <= 0) return false;
  }
  return true;
}

std::vector<std::string> File::children(const std::string& group) const {
  std::vector<std::string> names;
  const auto add = [](hid_t, const char* name, const H5L_info_t*, void* to) -> herr_t {
    static_cast<std::vector<std::string>*>(to)->push_back(name);
    return 0;
  };
  const Handle handle = open_object(group);
  if (H5Literate(handle.id(), H5_INDEX_NAME, H5_ITER_INC, nullptr, add, &names) < 0) fail("list", group);
  return names;
}

Shape File::shape(const std::string& object) const {
  const Handle dataset = own<H5Dclose>(H5Dopen2(handle_.id(), object.c_str(), H5P_DEFAULT));
  if (dataset.id() < 0) fail("find", object);
  const Handle space = own<H5Sclose>(H5Dget_space(dataset.id()));
  Shape shape(std::size_t(std::max(0, H5Sget_simple_extent_ndims(space.id()))));
  H5Sget_simple_extent_dims(space.id(), reinterpret_cast<hsize_t*>(shape.data()), nullptr);
  return shape;
}

void File::demand_plausible(const std::string& object, const Shape& shape, std::size_t bytes_per_value) const {
  std::error_code ignored;
  // deflate shrinks by 1032 at most
  const double most = 1100.0 * double(std::filesystem::file_size(path_, ignored)) + (1 << 20);
  double bytes = double(bytes_per_value);
  for (const std::uint64_t n : shape) bytes *= double(n);
  if (bytes > most) fail("read (it claims more values than the file can hold)", object);
}

void File::read_raw(const std::string& object, Type type, void* values) const {
  const Handle dataset = own<H5Dclose>(H5Dopen2(handle_.id(), object.c_str(), H5P_DEFAULT));
  if (dataset.id() < 0) fail("find", object);
  if (n_values(shape(object)) == 0) return;
  if (H5Dread(dataset.id(), in_memory(type), H5S_ALL, H5S_ALL, H5P_DEFAULT, values) < 0) fail("read", object);
}

void File::read_row_raw(const std::string& object, std::uint64_t row, Type type, void* values) const {
  Shape count = shape(object), start(count.size(), 0);
  if (count.empty() || row >= count[0]) fail("find row " + std::to_string(row) + " of", object);
  count[0] = 1;
  start[0] = row;
  if (n_values(count) == 0) return;
  const Handle dataset = own<H5Dclose>(H5Dopen2(handle_.id(), object.c_str(), H5P_DEFAULT));
  const Handle in_file = own<H5Sclose>(H5Dget_space(dataset.id()));
  const Handle in_memory_space = dataspace(count);
  if (H5Sselect_hyperslab(in_file.id(), H5S_SELECT_SET, reinterpret_cast<const hsize_t*>(start.data()), nullptr,
                          reinterpret_cast<const hsize_t*>(count.data()), nullptr) < 0 ||
      H5Dread(dataset.id(), in_memory(type), in_memory_space.id(), in_file.id(), H5P_DEFAULT, values) < 0)
    fail("read", object);
}

std::vector<std::string> File::texts_attribute(const std::string& object, const std::string& name) const {
  const Handle owner = open_object(object);
  const Handle attribute = own<H5Aclose>(H5Aopen(owner.id(), name.c_str(), H5P_DEFAULT));
  if (attribute.id() < 0) fail("find the attribute " + name + " of", object);
  const Handle type = own<H5Tclose>(H5Aget_type(attribute.id())), space = own<H5Sclose>(H5Aget_space(attribute.id()));
  demand_plausible(object, {H5Tget_size(type.id()), std::uint64_t(H5Sget_simple_extent_npoints(space.id()))}, 1);
  const std::size_t bytes = H5Tget_size(type.id()), n = std::size_t(H5Sget_simple_extent_npoints(space.id()));
  if (H5Tis_variable_str(type.id()) > 0) {
    std::vector<char*> read(n, nullptr);
    if (n && H5Aread(attribute.id(), type.id(), read.data()) < 0) fail("read the attribute " + name + " of", object);
    std::vector<std::string> texts;
    for (const char* text : read) texts.emplace_back(text ? text : "");
    if (n) H5Dvlen_reclaim(type.id(), space.id(), H5P_DEFAULT, read.data());
    return texts;
  }
  std::string packed(bytes * n, '\0');
  if (H5Tget_class(type.id()) != H5T_STRING || (n && H5Aread(attribute.id(), type.id(), packed.data()) < 0))
    fail("read the attribute " + name + " of", object);
  std::vector<std::string> texts(n);
  for (std::size_t i = 0; i < n; ++i) {
    texts[i] = packed.substr(i * bytes, bytes);
    texts[i].resize(texts[i].find_last_not_of('\0') + 1);  // npos + 1 is 0
  }
  return texts;
}

std::string File::text_attribute(const std::string& object, const std::string& name) const {
  const std::vector<std::string> texts = texts_attribute(object, name);
  if (texts.size() != 1) fail("read the attribute " + name + " of", object);
  return texts.front();
}

double File::number_attribute(const std::string& object, const std::string& name) const {
  const Handle owner = open_object(object);
  const Handle attribute = own<H5Aclose>(H5Aopen(owner.id(), name.c_str(), H5P_DEFAULT));
  double number = 0;
  if (attribute.id() < 0 || H5Aread(attribute.id(), H5T_NATIVE_DOUBLE, &number) < 0)
    fail("read the attribute " + name + " of", object);
  return number;
}

std::uint64_t File::unsigned_attribute(const std::string& object, const std::string& name) const {
  const Handle owner = open_object(object);
  const Handle attribute = own<H5Aclose>(H5Aopen(owner.id(), name.c_str(), H5P_DEFAULT));
  std::uint64_t number = 0;
  if (attribute.id() < 0 || H5Aread(attribute.id(), H5T_NATIVE_UINT64, &number) < 0)
    fail("read the attribute " + name + " of", object);
  return number;
}

}  // namespace pvg::hdf5
