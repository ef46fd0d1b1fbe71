#include "sim/camera/daylight.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "fields/check.h"
#include "fields/constants.h"
#include "fields/visitor.h"
#include "sim/samples/wide_vectors.h"

namespace rigwire::sim {

using fields::plain;

namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr double kSolarConstant_lx = 133.3e3;
constexpr double kLowestShape_rad = 2.0 * kDegree;
constexpr double kLeastSkyShare = 0.15;
/// Wavelengths that represent the bands, um.
constexpr std::array<double, 3> kBands_um{0.610, 0.550, 0.465};
/// Weights of the bands in luminance, linear sRGB.
const Eigen::Vector3f kLuminance(0.2126F, 0.7152F, 0.0722F);

Eigen::Vector3f to_rgb(float luminance, float x, float y) {
  const float big_x = luminance * x / y;
  const float big_z = luminance * (1.0F - x - y) / y;
  // IEC 61966-2-1.
  Eigen::Vector3f rgb(3.2406F * big_x - 1.5372F * luminance - 0.4986F * big_z,
                      -0.9689F * big_x + 1.8758F * luminance + 0.0415F * big_z,
                      0.0557F * big_x - 0.2040F * luminance + 1.0570F * big_z);
  return rgb.cwiseMax(0.0F);
}

/// y of daylight with that x (CIE 15:2004, 3.1).
float daylight_locus(float x) {
  return -0.275F + x * (2.870F - 3.0F * x);
}

/// (1 + A exp(B / cos z)) (1 + C exp(D g) + E cos^2 g).
float perez(const std::array<float, 5>& p, float cosine_zenith, float cosine_sun) {
  const float angle = std::acos(std::clamp(cosine_sun, -1.0F, 1.0F));
  return (1.0F + p[0] * std::exp(p[1] / cosine_zenith)) *
         (1.0F + p[2] * std::exp(p[3] * angle) + p[4] * cosine_sun * cosine_sun);
}

/// Optical depth of the air at the zenith: molecules and haze.
double optical_depth(double turbidity, double wavelength_um) {
  const double beta = 0.04608 * turbidity - 0.04586;
  return 0.008735 * std::pow(wavelength_um, -4.08) + beta * std::pow(wavelength_um, -1.3);
}

double air_mass(double elevation_rad) {
  // Kasten and Young 1989.
  const double e = elevation_rad / kDegree;
  return 1.0 / (std::sin(elevation_rad) + 0.50572 * std::pow(e + 6.07995, -1.6364));
}

}  // namespace

void visit(fields::Visitor& v, DaylightParameters& p) {
  v.number("turbidity", p.turbidity, plain().between(2, 10),
           "Haze of the clear sky: 2 very clear, 3 clear, 6 hazy.");
  v.number("cloud_cover", p.cloud_cover, plain().between(0, 1), "0 clear, 1 overcast.");
  v.number("ground_albedo", p.ground_albedo, plain().between(0, 1),
           "Albedo of the ground around the scene, for the light that it sends back.");
}

void validate(const DaylightParameters& parameters) {
  fields::check(parameters);
}

double clear_sky_illuminance_lx(double sun_elevation_rad) {
  struct Piece {
    double from_deg;
    std::array<double, 4> terms;
  };
  // log10 E by x = elevation / 90 degrees.
  static constexpr std::array<Piece, 6> kPieces{{{20.0, {3.74, 3.97, -4.07, 1.47}},
                                                 {5.0, {3.05, 13.28, -45.98, 64.33}},
                                                 {-0.8, {2.88, 22.26, -207.64, 1034.30}},
                                                 {-5.0, {2.88, 21.81, -258.11, -858.36}},
                                                 {-12.0, {2.70, 12.17, -431.69, -1899.83}},
                                                 {-18.0, {13.84, 262.72, 1447.42, 2797.93}}}};
  const double elevation_deg = std::clamp(sun_elevation_rad / kDegree, -18.0, 90.0);
  const double x = elevation_deg / 90.0;
  for (const Piece& piece : kPieces) {
    if (elevation_deg >= piece.from_deg) {
      const auto& l = piece.terms;
      return std::pow(10.0, l[0] + x * (l[1] + x * (l[2] + x * l[3])));
    }
  }
  return 0.0;
}

Daylight::Daylight(const DaylightParameters& parameters, const Eigen::Vector3d& to_sun_W)
    : parameters_(parameters), to_sun_(to_sun_W.cast<float>()) {
  validate(parameters);
  if (!(std::abs(to_sun_W.norm() - 1.0) < 1e-6)) {
    throw std::invalid_argument(
        "daylight: the direction to the sun is no unit vector, its length " +
        std::to_string(to_sun_W.norm()));
  }
  const double elevation = std::asin(std::clamp(to_sun_W.z(), -1.0, 1.0));
  const double cover = parameters.cloud_cover;
  const double clear_lx = clear_sky_illuminance_lx(elevation);
  const double total_lx = clear_lx * (1.0 - 0.75 * std::pow(cover, 3.4));

  // Sun, band by band, as much as is left of the air's path.
  double sun_level_lx = 0.0;
  if (elevation > 0.0) {
    for (std::size_t band = 0; band < 3; ++band) {
      sun_lx_[static_cast<int>(band)] = static_cast<float>(
          kSolarConstant_lx *
          std::exp(-optical_depth(parameters.turbidity, kBands_um[band]) * air_mass(elevation)));
    }
    sun_level_lx = static_cast<double>(kLuminance.dot(sun_lx_)) * to_sun_W.z();
    // No more than the total leaves room for.
    const double most = clear_lx / (1.0 + kLeastSkyShare);
    const double keep = std::min(1.0, most / sun_level_lx) * (1.0 - cover);
    sun_lx_ *= static_cast<float>(keep);
    sun_level_lx *= keep;
  }
  const double sky_lx = std::max(total_lx - sun_level_lx, kLeastSkyShare * sun_level_lx);

  // Shape and colour after Preetham et al.
  const auto t = static_cast<float>(parameters.turbidity);
  perez_[0] = {0.1787F * t - 1.4630F, -0.3554F * t + 0.4275F, -0.0227F * t + 5.3251F,
               0.1206F * t - 2.5771F, -0.0670F * t + 0.3703F};
  perez_[1] = {-0.0193F * t - 0.2592F, -0.0665F * t + 0.0008F, -0.0004F * t + 0.2125F,
               -0.0641F * t - 0.8989F, -0.0033F * t + 0.0452F};
  perez_[2] = {-0.0167F * t - 0.2608F, -0.0950F * t + 0.0092F, -0.0079F * t + 0.2102F,
               -0.0441F * t - 1.6537F, -0.0109F * t + 0.0529F};
  const double shape_elevation = std::max(elevation, kLowestShape_rad);
  const double level = to_sun_W.head<2>().norm();
  const Eigen::Vector2d heading =
      level > 1e-9 ? Eigen::Vector2d(to_sun_W.head<2>() / level) : Eigen::Vector2d(1.0, 0.0);
  shape_sun_ << (std::cos(shape_elevation) * heading).cast<float>(),
      static_cast<float>(std::sin(shape_elevation));
  const auto s = static_cast<float>(0.5 * std::numbers::pi - shape_elevation);
  const Eigen::Vector4f powers(s * s * s, s * s, s, 1.0F);
  const float zenith_x = t * t * Eigen::Vector4f(0.00166F, -0.00375F, 0.00209F, 0.0F).dot(powers) +
                         t * Eigen::Vector4f(-0.02903F, 0.06377F, -0.03202F, 0.00394F).dot(powers) +
                         Eigen::Vector4f(0.11693F, -0.21196F, 0.06052F, 0.25886F).dot(powers);
  const float zenith_y = t * t * Eigen::Vector4f(0.00275F, -0.00610F, 0.00317F, 0.0F).dot(powers) +
                         t * Eigen::Vector4f(-0.04214F, 0.08970F, -0.04153F, 0.00516F).dot(powers) +
                         Eigen::Vector4f(0.15346F, -0.26756F, 0.06670F, 0.26688F).dot(powers);
  const float sun_height = shape_sun_.z();
  zenith_ << 1.0F / perez(perez_[0], 1.0F, sun_height),
      zenith_x / perez(perez_[1], 1.0F, sun_height), zenith_y / perez(perez_[2], 1.0F, sun_height);

  // The clear sky's level, so that it lights level ground as it should; the overcast one does so
  // with 7 pi / 9 of its zenith's luminance.
  clear_scale_ = 1.0F;
  constexpr int kRings = 24;
  constexpr int kSectors = 48;
  double shape_lx = 0.0;
  for (int ring = 0; ring < kRings; ++ring) {
    const double z = (ring + 0.5) / kRings;
    const double across = std::sqrt(1.0 - z * z);
    for (int sector = 0; sector < kSectors; ++sector) {
      const double angle = 2.0 * std::numbers::pi * (sector + 0.5) / kSectors;
      const Eigen::Vector3f direction =
          Eigen::Vector3d(across * std::cos(angle), across * std::sin(angle), z).cast<float>();
      shape_lx += z * static_cast<double>(kLuminance.dot(clear_luminance(direction)));
    }
  }
  shape_lx *= 2.0 * std::numbers::pi / (kRings * kSectors);
  clear_scale_ = static_cast<float>((1.0 - cover) * sky_lx / shape_lx);
  overcast_zenith_ = static_cast<float>(cover * sky_lx * 9.0 / (7.0 * std::numbers::pi));
  tabulate();
  project();
}

Eigen::Vector3f Daylight::clear_luminance(const Eigen::Vector3f& direction_W) const {
  const float z = std::max(direction_W.z(), 0.01F);
  const float cosine_sun = direction_W.dot(shape_sun_);
  const float luminance = clear_scale_ * zenith_[0] * perez(perez_[0], z, cosine_sun);
  const float x = zenith_[1] * perez(perez_[1], z, cosine_sun);
  const float y = zenith_[2] * perez(perez_[2], z, cosine_sun);
  return to_rgb(luminance, x, std::max(y, daylight_locus(x)));
}

void Daylight::tabulate() {
  table_.resize(static_cast<std::size_t>(kTable) * kTable);
  for (int row = 0; row < kTable; ++row) {
    for (int column = 0; column < kTable; ++column) {
      // Back from the stereographic plane; its corners are below the horizon.
      const Eigen::Vector2f q =
          Eigen::Vector2f(static_cast<float>(column), static_cast<float>(row)) *
              (2.0F / (kTable - 1)) -
          Eigen::Vector2f::Ones();
      const float s = q.squaredNorm();
      Eigen::Vector3f direction(2.0F * q.x(), 2.0F * q.y(), std::max(1.0F - s, 0.0F));
      const Eigen::Vector3f seen = sky_luminance(direction.normalized());
      const int at = row * kTable + column;
      table_[static_cast<std::size_t>(at)] = {seen.x(), seen.y(), seen.z(), 0.0F};
    }
  }
}

Eigen::Vector3f Daylight::luminance(const Eigen::Vector3f& direction_W) const {
  LaneArray x, y, z;
  x.fill(direction_W.x());
  y.fill(direction_W.y());
  z.fill(direction_W.z());
  std::array<LaneArray, 3> bands;
  luminance(x, y, z, bands);
  return {bands[0][0], bands[1][0], bands[2][0]};
}

RIGWIRE_WIDE_VECTORS void Daylight::luminance(EightNumbers dx, EightNumbers dy, EightNumbers dz,
                                              std::array<LaneArray, 3>& bands) const {
  constexpr float kHalf = 0.5F * (kTable - 1);
  LaneArray a, b;
  alignas(32) std::array<int, kLanes> first;
  float lowest = 0.0F;
#pragma GCC ivdep
  for (std::size_t i = 0; i < kLanes; ++i) {
    const float z = dz[i] > 0.0F ? dz[i] : 0.0F;
    const float scale = kHalf / (1.0F + z);
    float x = dx[i] * scale + kHalf;
    float y = dy[i] * scale + kHalf;
    x = x > 0.0F ? x : 0.0F;
    y = y > 0.0F ? y : 0.0F;
    int column = static_cast<int>(x);
    int row = static_cast<int>(y);
    column = column < kTable - 2 ? column : kTable - 2;
    row = row < kTable - 2 ? row : kTable - 2;
    a[i] = x - static_cast<float>(column);
    b[i] = y - static_cast<float>(row);
    first[i] = row * kTable + column;
    lowest = dz[i] < lowest ? dz[i] : lowest;
  }
  for (std::size_t i = 0; i < kLanes; ++i) {
    const std::array<float, 4>* const node = table_.data() + first[i];
    std::array<float, 4> seen;
    for (std::size_t k = 0; k < 4; ++k) {
      const float south = node[0][k] + a[i] * (node[1][k] - node[0][k]);
      const float north = node[kTable][k] + a[i] * (node[kTable + 1][k] - node[kTable][k]);
      seen[k] = south + b[i] * (north - south);
    }
    bands[0][i] = seen[0];
    bands[1][i] = seen[1];
    bands[2][i] = seen[2];
  }
  if (lowest == 0.0F) {
    return;
  }
  for (std::size_t i = 0; i < kLanes; ++i) {
    if (dz[i] < 0.0F) {
      // Ground some 20 m below, in air of a visibility of 40 km.
      const float share = std::exp(0.002F / std::min(dz[i], -1e-4F));
      for (std::size_t band = 0; band < 3; ++band) {
        const int k = static_cast<int>(band);
        bands[band][i] = horizon_[k] + (ground_[k] - horizon_[k]) * share;
      }
    }
  }
}

Eigen::Vector3f Daylight::sky_luminance(const Eigen::Vector3f& direction_W) const {
  Eigen::Vector3f sum =
      Eigen::Vector3f::Constant(overcast_zenith_ * (1.0F + 2.0F * direction_W.z()) * (1.0F / 3.0F));
  if (clear_scale_ > 0.0F) {
    sum += clear_luminance(direction_W);
  }
  return sum;
}

Eigen::Vector3f Daylight::sun_luminance() const {
  return sun_lx_ / (kPi * kSunRadius_rad * kSunRadius_rad);
}

void Daylight::project() {
  // Sky over the upper half of the sphere, then the ground that it and the sun light, over the
  // lower one, onto nine spherical harmonics; A_l = pi, 2 pi / 3, pi / 4 turns each into
  // irradiance.
  constexpr int kRings = 32;
  constexpr int kSectors = 64;
  constexpr float kWeight = 2.0F * kPi / (kRings * kSectors);
  constexpr std::array<float, 9> kNorms{0.282095F, 0.488603F, 0.488603F, 0.488603F, 1.092548F,
                                        1.092548F, 0.315392F, 1.092548F, 0.546274F};
  std::array<Eigen::Vector3f, 9> sums;
  sums.fill(Eigen::Vector3f::Zero());
  const auto shapes = [](const Eigen::Vector3f& d) {
    return std::array<float, 9>{1.0F,
                                d.y(),
                                d.z(),
                                d.x(),
                                d.x() * d.y(),
                                d.y() * d.z(),
                                3.0F * d.z() * d.z() - 1.0F,
                                d.x() * d.z(),
                                d.x() * d.x() - d.y() * d.y()};
  };
  Eigen::Vector3f low = Eigen::Vector3f::Zero();
  int low_count = 0;
  for (const float side : {1.0F, -1.0F}) {
    if (side < 0.0F) {
      horizon_ = low / (kWeight * static_cast<float>(low_count));
      total_lx_ = sky_lx_ + sun_lx_ * std::max(to_sun_.z(), 0.0F);
      ground_ = static_cast<float>(parameters_.ground_albedo) / kPi * total_lx_;
    }
    for (int ring = 0; ring < kRings; ++ring) {
      const float z = side * (static_cast<float>(ring) + 0.5F) / kRings;
      const float across = std::sqrt(1.0F - z * z);
      for (int sector = 0; sector < kSectors; ++sector) {
        const float angle = 2.0F * kPi * (static_cast<float>(sector) + 0.5F) / kSectors;
        const Eigen::Vector3f direction(across * std::cos(angle), across * std::sin(angle), z);
        const Eigen::Vector3f seen = luminance(direction) * kWeight;
        const std::array<float, 9> shape = shapes(direction);
        for (std::size_t i = 0; i < 9; ++i) {
          sums[i] += kNorms[i] * shape[i] * seen;
        }
        if (side > 0.0F) {
          sky_lx_ += z * seen;
          if (z < 0.087F) {
            low += seen;
            ++low_count;
          }
        }
      }
    }
  }
  for (std::size_t i = 0; i < 9; ++i) {
    const float lobe = i == 0 ? kPi : (i < 4 ? 2.0F * kPi / 3.0F : 0.25F * kPi);
    terms_[i] = lobe * kNorms[i] * sums[i];
  }
}

Eigen::Vector3f Daylight::diffuse_lx(const Eigen::Vector3f& n) const {
  const Eigen::Vector3f sum =
      terms_[0] + n.y() * terms_[1] + n.z() * terms_[2] + n.x() * terms_[3] +
      n.x() * n.y() * terms_[4] + n.y() * n.z() * terms_[5] +
      (3.0F * n.z() * n.z() - 1.0F) * terms_[6] + n.x() * n.z() * terms_[7] +
      (n.x() * n.x() - n.y() * n.y()) * terms_[8];
  return sum.cwiseMax(0.0F);
}

}  // namespace rigwire::sim
