#include "host/model/metals.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>

// Optical constants n, k:
// - gold, silver, copper: Johnson and Christy 1972, "Optical constants of the noble metals", Phys. Rev. B 6, 4370
// - nickel, chromium, titanium, iron: Johnson and Christy 1974, "Optical constants of transition metals: Ti, V, Cr, Mn,
//   Fe, Co, Ni, and Pd", Phys. Rev. B 9, 5056
// - aluminium: Rakic 1995, "Algorithm for the determination of intrinsic optical constants of metal films: application
//   to aluminum", Appl. Opt. 34, 4755
// Reflectance (Born and Wolf, "Principles of Optics", 14.2), with c = cos theta and r = sqrt((n + i k)^2 - 1 + c^2):
//   R = 1/2 |(c - r) / (c + r)|^2 + 1/2 |((n + i k)^2 c - r) / ((n + i k)^2 c + r)|^2
// Colour: the spectrum in daylight D65 (CIE 15) by the colour matching functions of CIE 1931 as fitted by Wyman, Sloan
// and Shirley 2013, "Simple Analytic Approximations to the CIE XYZ Color Matching Functions", then to Rec. 709 by the
// matrix of IEC 61966-2-1; a perfect mirror is (1, 1, 1).

namespace pvg {
namespace {

struct Constants {
  double wavelength, n, k;  // [nm]
};

struct Metal {
  const char* name;
  std::vector<Constants> constants;  // ascending
};

const std::vector<Metal>& metals() {
  static const std::vector<Metal> list = {
      {"gold",
       {{381.5, 1.46, 1.933},
        {397.4, 1.47, 1.952},
        {413.3, 1.46, 1.958},
        {430.5, 1.45, 1.948},
        {450.9, 1.38, 1.914},
        {471.4, 1.31, 1.849},
        {495.9, 1.04, 1.833},
        {520.9, 0.62, 2.081},
        {548.6, 0.43, 2.455},
        {582.1, 0.29, 2.863},
        {616.8, 0.21, 3.272},
        {659.5, 0.14, 3.697},
        {704.5, 0.13, 4.103},
        {756, 0.14, 4.542},
        {821.1, 0.16, 5.083}}},
      {"silver",
       {{381.5, 0.05, 1.864},
        {397.4, 0.05, 2.07},
        {413.3, 0.05, 2.275},
        {430.5, 0.04, 2.462},
        {450.9, 0.04, 2.657},
        {471.4, 0.05, 2.869},
        {495.9, 0.05, 3.093},
        {520.9, 0.05, 3.324},
        {548.6, 0.06, 3.586},
        {582.1, 0.05, 3.858},
        {616.8, 0.06, 4.152},
        {659.5, 0.05, 4.483},
        {704.5, 0.04, 4.838},
        {756, 0.03, 5.242},
        {821.1, 0.04, 5.727}}},
      {"copper",
       {{381.5, 1.33, 2.045},
        {397.4, 1.32, 2.116},
        {413.3, 1.28, 2.207},
        {430.5, 1.25, 2.305},
        {450.9, 1.24, 2.397},
        {471.4, 1.25, 2.483},
        {495.9, 1.22, 2.564},
        {520.9, 1.18, 2.608},
        {548.6, 1.02, 2.577},
        {582.1, 0.7, 2.704},
        {616.8, 0.3, 3.205},
        {659.5, 0.22, 3.747},
        {704.5, 0.21, 4.205},
        {756, 0.24, 4.665},
        {821.1, 0.26, 5.18}}},
      {"aluminium",
       {{364.66, 0.39877, 4.3957},
        {413.28, 0.52135, 5.0008},
        {442.8, 0.6079, 5.3676},
        {476.87, 0.7278, 5.7781},
        {516.6, 0.8734, 6.2418},
        {563.57, 1.0728, 6.7839},
        {619.93, 1.366, 7.4052},
        {652.25, 1.5724, 7.7354},
        {688.81, 1.8301, 8.0601},
        {729.32, 2.1606, 8.3565},
        {774.91, 2.6154, 8.4914},
        {794.78, 2.7675, 8.3866}}},
      {"nickel",
       {{381, 1.72, 2.48},
        {397, 1.72, 2.57},
        {413, 1.7, 2.69},
        {431, 1.71, 2.82},
        {451, 1.73, 2.95},
        {471, 1.78, 3.09},
        {496, 1.82, 3.25},
        {521, 1.85, 3.42},
        {549, 1.92, 3.61},
        {582, 1.96, 3.8},
        {617, 1.99, 4.02},
        {659, 1.99, 4.26},
        {704, 2.06, 4.5},
        {756, 2.13, 4.73},
        {821, 2.26, 4.97}}},
      {"chromium",
       {{381, 1.92, 2.74},
        {397, 2, 2.83},
        {413, 2.08, 2.93},
        {431, 2.19, 3.04},
        {451, 2.33, 3.14},
        {471, 2.51, 3.24},
        {496, 2.75, 3.3},
        {521, 2.94, 3.33},
        {549, 3.18, 3.33},
        {582, 3.22, 3.3},
        {617, 3.17, 3.3},
        {659, 3.09, 3.34},
        {704, 3.05, 3.39},
        {756, 3.08, 3.42},
        {821, 3.2, 3.48}}},
      {"titanium",
       {{381, 1.99, 2.93},
        {397, 2.08, 2.95},
        {413, 2.14, 2.98},
        {431, 2.21, 3.01},
        {451, 2.27, 3.04},
        {471, 2.32, 3.1},
        {496, 2.36, 3.19},
        {521, 2.44, 3.3},
        {549, 2.54, 3.43},
        {582, 2.6, 3.58},
        {617, 2.67, 3.72},
        {659, 2.76, 3.84},
        {704, 2.86, 3.96},
        {756, 3, 4.01},
        {821, 3.21, 4.01}}},
      {"iron",
       {{381, 2.12, 2.5},
        {397, 2.24, 2.58},
        {413, 2.35, 2.65},
        {431, 2.48, 2.71},
        {451, 2.59, 2.77},
        {471, 2.67, 2.82},
        {496, 2.74, 2.88},
        {521, 2.86, 2.91},
        {549, 2.95, 2.93},
        {582, 2.94, 2.99},
        {617, 2.88, 3.05},
        {659, 2.92, 3.1},
        {704, 2.86, 3.19},
        {756, 2.87, 3.28},
        {821, 2.94, 3.39}}},
  };
  return list;
}

constexpr double FIRST = 380, LAST = 780, STEP = 5;  // [nm]

// relative power of D65, every 10 nm from 380 to 780 nm
constexpr std::array<double, 41> DAYLIGHT = {
    49.9755, 54.6482, 82.7549, 91.486,  93.4318, 86.6823, 104.865, 117.008, 117.812, 114.861, 115.923,
    108.811, 109.354, 107.802, 104.79,  107.689, 104.405, 104.046, 100,     96.3342, 95.788,  88.6856,
    90.0062, 89.5991, 87.6987, 83.2886, 83.6992, 80.0268, 80.2146, 82.2778, 78.2842, 69.7213, 71.6091,
    74.349,  61.604,  69.8856, 75.087,  63.5927, 46.4182, 66.8054, 63.3828};

double daylight(double wavelength) {
  const double at = (wavelength - FIRST) / 10;
  const std::size_t i = std::min(std::size_t(at), DAYLIGHT.size() - 2);
  return DAYLIGHT[i] + (at - double(i)) * (DAYLIGHT[i + 1] - DAYLIGHT[i]);
}

double lobe(double x, double mean, double below, double above) {
  const double t = (x - mean) / (x < mean ? below : above);
  return std::exp(-0.5 * t * t);
}

// X, Y, Z of one wavelength [nm]
Vec3 color_matching(double w) {
  return {1.056 * lobe(w, 599.8, 37.9, 31.0) + 0.362 * lobe(w, 442.0, 16.0, 26.7) - 0.065 * lobe(w, 501.1, 20.4, 26.2),
          0.821 * lobe(w, 568.8, 46.9, 40.5) + 0.286 * lobe(w, 530.9, 16.3, 31.1),
          1.217 * lobe(w, 437.0, 11.8, 36.0) + 0.681 * lobe(w, 459.0, 26.0, 13.8)};
}

// n and k between the measured wavelengths
Constants constants_at(const std::vector<Constants>& list, double wavelength) {
  std::size_t i = 0;
  while (i + 2 < list.size() && list[i + 1].wavelength < wavelength) ++i;
  const Constants &a = list[i], &b = list[i + 1];
  const double t = (wavelength - a.wavelength) / (b.wavelength - a.wavelength);
  return {wavelength, a.n + t * (b.n - a.n), a.k + t * (b.k - a.k)};
}

template <class Spectrum>
Vec3 rec709(const Spectrum& spectrum) {
  Eigen::Matrix3d from_xyz;
  from_xyz << 3.2404542, -1.5371385, -0.4985314,  //
      -0.9692660, 1.8760108, 0.0415560,           //
      0.0556434, -0.2040259, 1.0572252;
  Vec3 xyz = Vec3::Zero();
  for (double w = FIRST; w <= LAST; w += STEP) xyz += spectrum(w) * daylight(w) * color_matching(w);
  return from_xyz * xyz;
}

}  // namespace

const std::vector<std::string>& metal_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> list;
    for (const Metal& metal : metals()) list.push_back(metal.name);
    return list;
  }();
  return names;
}

double fresnel_conductor(double n, double k, double cosine) {
  using Complex = std::complex<double>;
  const Complex index(n, k), epsilon = index * index, r = std::sqrt(epsilon - (1 - cosine * cosine));
  return 0.5 * std::norm((cosine - r) / (cosine + r)) +
         0.5 * std::norm((epsilon * cosine - r) / (epsilon * cosine + r));
}

Vec3 metal_reflectance(std::size_t i, double cosine) {
  const std::vector<Constants>& constants = metals().at(i).constants;
  const Vec3 reflected = rec709([&](double wavelength) {
    const Constants c = constants_at(constants, wavelength);
    return fresnel_conductor(c.n, c.k, cosine);
  });
  const Vec3 white = rec709([](double) { return 1.0; });
  return reflected.cwiseQuotient(white).cwiseMax(0).cwiseMin(1);
}

Vec3 metal_edge_dip(std::size_t i) {
  constexpr double c = 1.0 / 7;
  const Vec3 normal = metal_reflectance(i, 1), edge = metal_reflectance(i, c);
  const Vec3 schlick = normal + std::pow(1 - c, 5) * (Vec3::Ones() - normal);
  return (schlick - edge) / (c * std::pow(1 - c, 6));
}

}  // namespace pvg
