// Properties that every scattering material of kernels/materials/list.h must have: samples distributed as the density
// says (chi-square), weight = f cos / pdf, reciprocity, no more light out than in; and Fresnel's equations against
// numbers by hand.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "host/device/device.hpp"
#include "host/geometry/mesh.hpp"
#include "materials/list.h"
#include "materials/material.h"
#include "tests/render/test_scene.hpp"

namespace pvg {
namespace {

using ManySamples = test::ManyPaths;

const char* const material_kernels = R"(
#include "materials/list.cl"
kernel void sample_all(const uint n, const Material m, global const float* wo, global const float* u,
                       global const float* choice, global float* direction, global float* weight, global float* pdf) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  const MaterialSample s = material_sample(point_material(m, m.ior), vload3(0, wo), vload2(i, u), choice[i]);
  vstore3(s.direction, i, direction);
  vstore3(s.weight, i, weight);
  pdf[i] = s.pdf;
}
kernel void eval_all(const uint n, const Material m, global const float* wo, global const float* wi,
                     global float* value, global float* pdf) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  const PointMaterial p = point_material(m, m.ior);
  vstore3(material_eval(p, vload3(i, wo), vload3(i, wi)), i, value);
  pdf[i] = material_pdf(p, vload3(i, wo), vload3(i, wi));
}
kernel void fresnel(const uint n, const float eta, global const float* cosine, global float* R) {
  const uint i = get_global_id(0);
  if (i < n) R[i] = fresnel_dielectric(cosine[i], eta);
})";

// A kind with the numbers that a scene leaves open.
Material make(std::uint32_t kind, float alpha) {
  Material m{};
  m.kind = kind;
  m.texture = m.metallic_roughness_texture = m.normal_texture = m.emission_texture = -1;
  m.alpha = alpha;
  m.ior = 1.5f;
  for (float& c : m.color) c = 1;
#define SET_COLOR(name, member)                          \
  if (kind == std::uint32_t(VisualMaterial::Kind::name)) \
    for (int c = 0; c < 3; ++c) m.own_color[c] = VisualMaterial{}.member[c];
#define SET_NUMBER(name, member) \
  if (kind == std::uint32_t(VisualMaterial::Kind::name)) m.own_number = VisualMaterial{}.member;
  PVG_OWN_COLORS(SET_COLOR)
  PVG_OWN_NUMBERS(SET_NUMBER)
#undef SET_COLOR
#undef SET_NUMBER
  return m;
}

Material metallic_roughness(float alpha, float metallic, float transmission, bool is_thin = false, float ior = 1.5f) {
  Material m = make(MATERIAL_METALLIC_ROUGHNESS, alpha);
  m.metallic = metallic;
  m.transmission = transmission;
  m.ior = ior;
  m.flags = is_thin ? MATERIAL_THIN : transmission > 0 ? MATERIAL_HAS_INSIDE : 0u;
  return m;
}

Material cloth(float sheen, float roughness) {
  Material m = make(MATERIAL_CLOTH, 0);
  for (float& c : m.own_color) c = sheen;
  m.own_number = roughness;
  return m;
}

Material rough_glass(float alpha, float eta) {
  Material m = make(MATERIAL_ROUGH_DIELECTRIC, alpha);
  m.ior = eta;
  return m;
}

// of a measured metal
Material dipped_conductor(float alpha, float dip) {
  Material m = make(MATERIAL_CONDUCTOR, alpha);
  for (float& c : m.own_color) c = dip;
  return m;
}

// Every kind of the list that scatters, from smooth to rough, but clear glass, whose two directions have no density;
// and what has further numbers, with other ones. ior is the index behind / in front.
std::vector<Material> scattering() {
  std::vector<Material> materials;
#define ADD(ID, ...)                        \
  if (MATERIAL_##ID != MATERIAL_DIELECTRIC) \
    for (const float alpha : {0.1f, 0.2f, 0.5f, 1.0f}) materials.push_back(make(MATERIAL_##ID, alpha));
#define SKIP(...)
  PVG_MATERIALS(ADD, SKIP)
  PVG_DERIVED_MATERIALS(ADD)
#undef ADD
#undef SKIP
  for (const Material& more : {dipped_conductor(0.5f, 3), rough_glass(0.3f, 1 / 1.5f),
                               metallic_roughness(0.5f, 0.5f, 0), metallic_roughness(0.3f, 1, 0),
                               metallic_roughness(0.3f, 0.2f, 0.6f), metallic_roughness(0.3f, 0, 1, false, 1 / 1.5f),
                               metallic_roughness(0.3f, 0, 0.8f, true), cloth(0.5f, 0.5f), cloth(1, 1)})
    materials.push_back(more);
  return materials;
}

// several lobes share the samples: a single weight may be above 1, their mean not
bool is_mixture(const Material& m) { return m.kind == MATERIAL_METALLIC_ROUGHNESS || m.kind == MATERIAL_CLOTH; }

Vec3f direction(double cosine, double phi) {
  const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
  return {float(sine * std::cos(phi)), float(sine * std::sin(phi)), float(cosine)};
}

struct Samples {
  std::vector<float> direction, weight, pdf;
};

Samples draw(Device& device, Program& program, const Material& m, const Vec3f& wo, unsigned n) {
  std::mt19937 random(11);
  std::uniform_real_distribution<float> uniform(0, 1);
  std::vector<float> u(2 * n);
  for (float& x : u) x = std::min(uniform(random), 0.9999999f);
  std::vector<float> choice(n);
  for (float& x : choice) x = std::min(uniform(random), 0.9999999f);
  Buffer<float> d(device, 3 * n, "direction"), w(device, 3 * n, "weight"), p(device, n, "pdf");
  program.kernel("sample_all")(n, n, m, Buffer<float>(device, {wo.data(), 3}, "wo"), Buffer<float>(device, u, "u"),
                               Buffer<float>(device, choice, "choice"), d, w, p);
  return {d.read(), w.read(), p.read()};
}

struct Values {
  std::vector<float> value, pdf;  // value: f cos, [n x 3]
};

Values evaluate(Device& device, Program& program, const Material& m, const std::vector<float>& wo,
                const std::vector<float>& wi) {
  const unsigned n = unsigned(wo.size() / 3);
  Buffer<float> v(device, 3 * n, "value"), p(device, n, "pdf");
  program.kernel("eval_all")(n, n, m, Buffer<float>(device, wo, "wo"), Buffer<float>(device, wi, "wi"), v, p);
  return {v.read(), p.read()};
}

constexpr int N_COSINE = 24, N_PHI = 24, N_SUB = 24;  // bins of the sphere, and points per side of a bin

// how many of n samples each bin should hold, by the midpoint rule over the density
std::vector<double> expected_counts(Device& device, Program& program, const Material& m, const Vec3f& wo, unsigned n) {
  std::vector<float> wos, wis;
  for (int bin = 0; bin < N_COSINE * N_PHI; ++bin)
    for (int k = 0; k < N_SUB * N_SUB; ++k) {
      const double cosine = 2 * (bin / N_PHI + (k / N_SUB + 0.5) / N_SUB) / N_COSINE - 1;
      const double phi = (bin % N_PHI + (k % N_SUB + 0.5) / N_SUB) / N_PHI * 2 * M_PI;
      const Vec3f wi = direction(cosine, phi);
      wis.insert(wis.end(), wi.data(), wi.data() + 3);
      wos.insert(wos.end(), wo.data(), wo.data() + 3);
    }
  const std::vector<float> pdf = evaluate(device, program, m, wos, wis).pdf;
  std::vector<double> counts(N_COSINE * N_PHI, 0);
  const double cell = 4 * M_PI / (N_COSINE * N_PHI * N_SUB * N_SUB);  // solid angle [sr]
  for (std::size_t i = 0; i < pdf.size(); ++i) counts[i / (N_SUB * N_SUB)] += pdf[i] * cell * n;
  return counts;
}

TEST_F(ManySamples, SamplesAreDistributedAsTheDensitySays) {
  Device device;
  Program program = Program::from_text(device, "materials", material_kernels);
  const unsigned n = 200000;
  for (const Material& m : scattering())
    for (const double cosine : {0.95, 0.6, 0.25}) {
      const Vec3f wo = direction(cosine, 0.7);
      const Samples drawn = draw(device, program, m, wo, n);
      std::vector<double> counts(N_COSINE * N_PHI, 0);
      for (unsigned i = 0; i < n; ++i) {
        const float* d = &drawn.direction[3 * i];
        if (drawn.weight[3 * i] == 0) continue;  // lost between facets
        const double phi = std::atan2(d[1], d[0]) + (d[1] < 0 ? 2 * M_PI : 0);
        ++counts[std::min(int((d[2] + 1) / 2 * N_COSINE), N_COSINE - 1) * N_PHI +
                 std::min(int(phi / (2 * M_PI) * N_PHI), N_PHI - 1)];
      }
      const std::vector<double> expected = expected_counts(device, program, m, wo, n);
      double chi2 = 0, rest_expected = 0, rest = 0;
      int n_bins = 0;
      for (std::size_t i = 0; i < counts.size(); ++i) {
        if (expected[i] < 10) {
          rest_expected += expected[i];
          rest += counts[i];
          continue;
        }
        chi2 += (counts[i] - expected[i]) * (counts[i] - expected[i]) / expected[i];
        ++n_bins;
      }
      ASSERT_GE(n_bins, 8);
      EXPECT_LE(chi2, n_bins + 5 * std::sqrt(2.0 * n_bins))
          << "kind " << m.kind << " alpha " << m.alpha << " cosine " << cosine;
      EXPECT_NEAR(rest, rest_expected, 5 * std::sqrt(rest_expected) + 5);
    }
}

TEST(Materials, WeightIsValueOverDensity) {
  Device device;
  Program program = Program::from_text(device, "materials", material_kernels);
  const unsigned n = 1000;
  for (const Material& m : scattering()) {
    const Vec3f wo = direction(0.6, 2);
    const Samples s = draw(device, program, m, wo, n);
    std::vector<float> wos;
    for (unsigned i = 0; i < n; ++i) wos.insert(wos.end(), wo.data(), wo.data() + 3);
    const Values v = evaluate(device, program, m, wos, s.direction);
    unsigned n_compared = 0;
    for (unsigned i = 0; i < n; ++i) {
      if (std::abs(s.direction[3 * i + 2]) <= 1e-3f || s.weight[3 * i] == 0) continue;
      EXPECT_NEAR(s.pdf[i], v.pdf[i], 2e-3 * v.pdf[i]) << "kind " << m.kind;
      EXPECT_NEAR(s.weight[3 * i] * s.pdf[i], v.value[3 * i], 2e-3 * v.value[3 * i]) << "kind " << m.kind;
      ++n_compared;
    }
    EXPECT_GT(n_compared, n / 2);
  }
}

TEST(Materials, LightMayGoEitherWay) {
  Device device;
  Program program = Program::from_text(device, "materials", material_kernels);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> u(0.05, 1);
  std::vector<float> a, b;
  for (int i = 0; i < 1000; ++i) {
    const Vec3f p = direction(u(random), 6 * u(random)), q = direction(u(random), 6 * u(random));
    a.insert(a.end(), p.data(), p.data() + 3);
    b.insert(b.end(), q.data(), q.data() + 3);
  }
  for (const Material& m : scattering()) {
    const std::vector<float> ab = evaluate(device, program, m, a, b).value,
                             ba = evaluate(device, program, m, b, a).value;
    for (std::size_t i = 0; i < ab.size(); i += 3) {
      const double f = ab[i] / b[i + 2], g = ba[i] / a[i + 2];  // without the cosine
      ASSERT_NEAR(f, g, 1e-4 * f + 1e-7);
    }
  }
}

// what passes from one side to the other is, for radiance / n^2 and without the cosine, eta^2 times what passes back
TEST(Materials, LightMayGoEitherWayThroughASolid) {
  Device device;
  Program program = Program::from_text(device, "materials", material_kernels);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> u(0.05, 1);
  std::vector<float> above, below, above_turned, below_turned;
  for (int i = 0; i < 1000; ++i) {
    const Vec3f p = direction(u(random), 6 * u(random)), q = -direction(u(random), 6 * u(random));
    above.insert(above.end(), p.data(), p.data() + 3);
    below.insert(below.end(), q.data(), q.data() + 3);
    // seen from behind the surface its normal looks the other way
    for (int c = 0; c < 3; ++c) {
      above_turned.push_back(c == 2 ? -p[c] : p[c]);
      below_turned.push_back(c == 2 ? -q[c] : q[c]);
    }
  }
  for (const bool is_thin : {false, true})
    for (const bool is_mixed : {false, true}) {
      if (is_thin && !is_mixed) continue;  // thin rough glass is of the other kind
      const double eta = 1.5;
      Material in = is_mixed ? metallic_roughness(0.4f, 0, 0.7f, is_thin) : rough_glass(0.4f, 1.5f), out = in;
      if (!is_thin) out.ior = float(1 / eta);
      const std::vector<float> there = evaluate(device, program, in, above, below).value,
                               back = evaluate(device, program, out, below_turned, above_turned).value;
      const double factor = is_thin ? 1 : eta * eta;
      int n_passing = 0;
      for (std::size_t i = 0; i < there.size(); i += 3) {
        const double f = there[i] / std::abs(below[i + 2]), g = back[i] / above[i + 2];
        ASSERT_NEAR(f, factor * g, 1e-3 * f + 1e-6);
        n_passing += f > 1e-4;
      }
      EXPECT_GT(n_passing, 100);
    }
}

TEST_F(ManySamples, NoMoreLightLeavesThanArrives) {
  Device device;
  Program program = Program::from_text(device, "materials", material_kernels);
  for (const Material& m : scattering())
    for (const double cosine : {1.0, 0.7, 0.1}) {
      const std::vector<float> weight = draw(device, program, m, direction(cosine, 1), 20000).weight;
      double sum = 0, squares = 0;
      for (std::size_t i = 0; i < weight.size(); i += 3) {
        if (!is_mixture(m)) {
          ASSERT_LE(weight[i], 1.0f + 1e-5f);
        }
        sum += weight[i];
        squares += double(weight[i]) * weight[i];
      }
      const double n = double(weight.size()) / 3, albedo = sum / n;
      EXPECT_LE(albedo, 1 + 1e-5 + 4 * std::sqrt(std::max(0.0, squares / n - albedo * albedo) / n))
          << "kind " << m.kind << " cosine " << cosine;
      if (m.kind == MATERIAL_DIFFUSE) {
        EXPECT_NEAR(albedo, 1, 1e-6);
      }
      // what a second bounce between facets would carry is missing
      if (m.kind == MATERIAL_CONDUCTOR && m.alpha == 0.1f && cosine > 0.5) {
        EXPECT_GT(albedo, 0.98);
      }
      EXPECT_GT(albedo, 0.25);
    }
}

TEST(Materials, ConductorBecomesAMirror) {
  Device device;
  Program program = Program::from_text(device, "materials", material_kernels);
  const Vec3f wo = direction(0.5, 1);
  Material m = make(MATERIAL_CONDUCTOR, 0.0011f);
  m.color[0] = 0.4f;
  const Samples rough = draw(device, program, m, wo, 100);
  m.alpha = 0.0f;
  const Samples mirror = draw(device, program, m, wo, 100);
  for (unsigned i = 0; i < 100; ++i) {
    const Vec3f d(mirror.direction[3 * i], mirror.direction[3 * i + 1], mirror.direction[3 * i + 2]);
    EXPECT_EQ(d, Vec3f(-wo.x(), -wo.y(), wo.z()));
    EXPECT_EQ(mirror.pdf[i], 0);
    // Schlick: 0.4 + 0.6 (1 - 0.5)^5
    EXPECT_NEAR(mirror.weight[3 * i], 0.41875, 1e-6);
    EXPECT_LT((Vec3f(rough.direction[3 * i], rough.direction[3 * i + 1], rough.direction[3 * i + 2]) - d).norm(), 0.1f);
  }
}

TEST(Materials, FresnelAgreesWithNumbersByHand) {
  Device device;
  Program program = Program::from_text(device, "materials", material_kernels);
  const auto R = [&](double cosine, float eta) {
    Buffer<float> out(device, 1, "R");
    program.kernel("fresnel")(1, 1u, eta, Buffer<float>(device, std::vector<float>{float(cosine)}, "cosine"), out);
    return double(out.read().front());
  };
  EXPECT_NEAR(R(1, 1.5f), 0.04, 1e-6);      // ((n - 1) / (n + 1))^2
  EXPECT_NEAR(R(1, 1 / 1.5f), 0.04, 1e-6);  // the same from inside
  EXPECT_NEAR(R(0, 1.5f), 1, 1e-6);         // grazing
  EXPECT_NEAR(R(0.7, 1 / 1.5f), 1, 1e-6);   // beyond the critical angle, cosine 0.745
  // at Brewster's angle, tan = n, only the perpendicular half is left: ((1 - n^2) / (1 + n^2))^2 / 2
  EXPECT_NEAR(R(1 / std::sqrt(1 + 2.25), 1.5f), 0.5 * (1.25 / 3.25) * (1.25 / 3.25), 1e-6);
}

TEST_F(ManySamples, GlassReflectsTheFresnelShareAndBendsBySnell) {
  Device device;
  Program program = Program::from_text(device, "materials", material_kernels);
  const unsigned n = 40000;
  const Vec3f wo = direction(0.5, 0);  // 60 degrees: R = 0.0892 for n = 1.5
  const Samples s = draw(device, program, make(MATERIAL_DIELECTRIC, 0), wo, n);
  unsigned n_reflected = 0;
  for (unsigned i = 0; i < n; ++i) {
    EXPECT_EQ(s.weight[3 * i], 1);
    if (s.direction[3 * i + 2] > 0)
      ++n_reflected;
    else
      ASSERT_NEAR(s.direction[3 * i], -std::sqrt(0.75) / 1.5, 1e-6);
  }
  EXPECT_NEAR(n_reflected / double(n), 0.0892, 4 * std::sqrt(0.0892 * 0.91 / n));
}

}  // namespace
}  // namespace pvg
