// The words that mean the same in OpenCL C and in C++. A struct shared by host and device is made of these and of
// arrays of them, and of nothing else; f64 stands at offsets divisible by 8. The size is asserted in both compilers.
#ifndef PVG_SHARED_TYPES_H
#define PVG_SHARED_TYPES_H
#ifdef __OPENCL_C_VERSION__  // not __OPENCL_VERSION__: clang's offline front end does not define that one
typedef uint u32;
typedef int i32;
typedef float f32;
// rendering needs no double, so a device without it reads everything but the structs of physics
#ifdef cl_khr_fp64
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
typedef double f64;
#endif
#define SHARED_BEGIN
#define SHARED_END
#define SHARED_SIZE(T, bytes) typedef char T##_size_check[sizeof(T) == (bytes) && (bytes) % 16 == 0 ? 1 : -1]
#else
#include <cstdint>
#include <type_traits>
namespace pvg {
using u32 = std::uint32_t;
using i32 = std::int32_t;
using f32 = float;
using f64 = double;
}  // namespace pvg
#define SHARED_BEGIN namespace pvg {
#define SHARED_END }
#define SHARED_SIZE(T, bytes)                                                                             \
  static_assert(sizeof(T) == (bytes) && (bytes) % 16 == 0, #T ": pad to 16 bytes and state the true size"); \
  static_assert(alignof(T) <= 8, #T ": only u32, i32, f32, f64 and arrays of them");                      \
  static_assert(std::is_trivially_copyable_v<T> && std::is_standard_layout_v<T>)
#endif
// The struct of one element of an energy term, its kernels' prefix and its number of sites. CMake makes the list of all
// terms from these lines (CMakeLists.txt); `place` is the term's place in every sum, so that the
// same scene gives the same bits however files are called.
#define ENERGY_TERM(place, name, Struct, stencil) \
  typedef char name##_stencil_check[sizeof(((Struct*)0)->site) == 4 * (stencil) ? 1 : -1]
#endif
