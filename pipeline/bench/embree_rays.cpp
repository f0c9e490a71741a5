#include "pipeline/bench/embree_rays.hpp"

#include <stdexcept>

#ifdef PVG_EMBREE
#include <embree3/rtcore.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>

#include "host/base/workers.hpp"

namespace pvg {

constexpr std::size_t PIECE = 4096;  // rays that a thread takes at a time

struct EmbreeRays::Impl {
  explicit Impl(unsigned n_threads) : workers(n_threads) {
    device = rtcNewDevice(("set_affinity=0,threads=" + std::to_string(n_threads)).c_str());
    scene = rtcNewScene(device);
  }
  ~Impl() {
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
  }
  template <class TraceOne>
  void trace(std::size_t n, const TraceOne& trace_one) {
    workers.run((n + PIECE - 1) / PIECE, [&](std::size_t piece) {
      RTCIntersectContext context;
      rtcInitIntersectContext(&context);
      for (std::size_t i = piece * PIECE; i < std::min(n, (piece + 1) * PIECE); ++i) trace_one(i, context);
    });
  }

  RTCDevice device;
  RTCScene scene;
  Workers workers;
  double build_seconds = 0;
};

namespace {
RTCRay embree_ray(const BenchRays& rays, std::size_t i, float t_max) {
  const float *o = rays.origin[i].v, *d = rays.direction[i].v;
  return {o[0], o[1], o[2], 0, d[0], d[1], d[2], 0, t_max, ~0u, 0, 0};
}
}  // namespace

EmbreeRays::EmbreeRays(const VisualMesh& mesh, unsigned n_threads) : impl_(std::make_unique<Impl>(n_threads)) {
  RTCGeometry geometry = rtcNewGeometry(impl_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
  const std::size_t n_points = mesh.points.size(), n_triangles = mesh.triangles.size();
  std::memcpy(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, n_points),
              mesh.points.data(), 12 * n_points);
  std::memcpy(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, n_triangles),
              mesh.triangles.data(), 12 * n_triangles);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(impl_->scene, geometry);
  rtcReleaseGeometry(geometry);
  const auto start = std::chrono::steady_clock::now();
  rtcCommitScene(impl_->scene);
  impl_->build_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}
EmbreeRays::~EmbreeRays() = default;

void EmbreeRays::closest(const BenchRays& rays, std::vector<Hit>& hits) {
  hits.resize(rays.size());
  impl_->trace(rays.size(), [&](std::size_t i, RTCIntersectContext& context) {
    RTCRayHit ray;
    ray.ray = embree_ray(rays, i, INFINITY);
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(impl_->scene, &context, &ray);
    hits[i] = {ray.ray.tfar, ray.hit.geomID == RTC_INVALID_GEOMETRY_ID ? NO_TRIANGLE : ray.hit.primID};
  });
}

void EmbreeRays::any(const BenchRays& rays, float t_max, std::vector<std::uint8_t>& is_occluded) {
  is_occluded.resize(rays.size());
  impl_->trace(rays.size(), [&](std::size_t i, RTCIntersectContext& context) {
    RTCRay ray = embree_ray(rays, i, t_max);
    rtcOccluded1(impl_->scene, &context, &ray);
    is_occluded[i] = ray.tfar < 0;
  });
}

double EmbreeRays::build_seconds() const { return impl_->build_seconds; }
bool EmbreeRays::is_there() { return true; }

}  // namespace pvg

#else
namespace pvg {

struct EmbreeRays::Impl {};
EmbreeRays::EmbreeRays(const VisualMesh&, unsigned) { throw std::logic_error("built without Embree"); }
EmbreeRays::~EmbreeRays() = default;
void EmbreeRays::closest(const BenchRays&, std::vector<Hit>&) {}
void EmbreeRays::any(const BenchRays&, float, std::vector<std::uint8_t>&) {}
double EmbreeRays::build_seconds() const { return 0; }
bool EmbreeRays::is_there() { return false; }

}  // namespace pvg
#endif
