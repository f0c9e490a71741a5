// What HDF5 files hold: arrays of numbers, with a shape; and the owner of what the library gives out.
#pragma once
#include <cstdint>
#include <functional>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

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

}  // namespace pvg::hdf5
