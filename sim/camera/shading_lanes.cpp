#include "sim/camera/shading_lanes.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "sim/lidar/beam_hits.h"
#include "sim/lidar/hit_surface.h"

namespace rigwire::sim {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
/// Grain never takes more than this of a surface's brightness.
constexpr float kDarkestGrain = 0.2F;
/// Ratio of a wet surface's albedo to the dry one's (J. Lekner, M. C. Dorf, "Why some things are
/// darker when wet", Applied Optics 27, 1988, for albedos of 0.2 to 0.4).
constexpr float kWetAlbedo = 0.55F;
constexpr float kWater = 0.02F;  ///< Reflectance of water, head on.
constexpr float kWaterSharpness = 120.0F;

inline float fifth(float x) {
  return x * x * x * x * x;
}

}  // namespace

LightTerms light_terms(const Daylight& light, double wetness) {
  LightTerms terms;
  for (int i = 0; i < 3; ++i) {
    const auto at = static_cast<std::size_t>(i);
    terms.to_sun[at] = light.to_sun_W()[i];
    terms.sun_lx[at] = light.sun_lx()[i];
    for (std::size_t k = 0; k < 9; ++k) {
      terms.diffuse[at][k] = light.diffuse_terms()[k][i];
    }
  }
  terms.albedo_around = static_cast<float>(light.parameters().ground_albedo);
  terms.wetness = static_cast<float>(wetness);
  return terms;
}

RIGWIRE_WIDE_VECTORS bool meet_points(const Scene::Internals::Shading* shading,
                                      const RTCRayHit8& packet, MetSurfaces& met) {
  const RTCRay8& ray = packet.ray;
  const RTCHit8& hit = packet.hit;
  constexpr unsigned kNothing = RTC_INVALID_GEOMETRY_ID;
  unsigned least = kNothing;
  unsigned most = 0;
  for (std::size_t i = 0; i < kLanes; ++i) {
    const unsigned number = surface_number(hit.instID[0][i], hit.geomID[i]);
    const unsigned there = number == kNothing ? 0U : number;
    met.number[i] = number;
    least = number < least ? number : least;
    most = there > most ? there : most;
  }
  if (least == kNothing) {
    return false;
  }
  met.one = least == most ? least : ~0U;
  const auto turn = [&](const float* R, unsigned which, bool all) {
#pragma GCC ivdep
    for (std::size_t i = 0; i < kLanes; ++i) {
      const bool mine = all || met.number[i] == which;
      const float x = R[0] * hit.Ng_x[i] + R[3] * hit.Ng_y[i] + R[6] * hit.Ng_z[i];
      const float y = R[1] * hit.Ng_x[i] + R[4] * hit.Ng_y[i] + R[7] * hit.Ng_z[i];
      const float z = R[2] * hit.Ng_x[i] + R[5] * hit.Ng_y[i] + R[8] * hit.Ng_z[i];
      met.gx[i] = mine ? x : met.gx[i];
      met.gy[i] = mine ? y : met.gy[i];
      met.gz[i] = mine ? z : met.gz[i];
    }
  };
  // Neighbouring rays mostly hit the same surfaces: each surface is computed for all lanes, and
  // each lane keeps its own.
  std::size_t first = kLanes;
  unsigned done = kNothing;
  for (std::size_t lane = 0; lane < kLanes && (first == kLanes || met.one == ~0U); ++lane) {
    if (met.number[lane] == done || met.number[lane] == kNothing) {
      continue;
    }
    done = met.number[lane];
    turn(shading[done].R_WM.data(), done, first == kLanes);
    first = first == kLanes ? lane : first;
  }
  const float first_x = ray.org_x[first] + ray.tfar[first] * ray.dir_x[first];
  const float first_y = ray.org_y[first] + ray.tfar[first] * ray.dir_y[first];
  const float first_z = ray.org_z[first] + ray.tfar[first] * ray.dir_z[first];
  const float first_m = ray.tfar[first];
#pragma GCC ivdep
  for (std::size_t i = 0; i < kLanes; ++i) {
    const bool there = met.number[i] != kNothing;
    const float x = ray.org_x[i] + ray.tfar[i] * ray.dir_x[i];
    const float y = ray.org_y[i] + ray.tfar[i] * ray.dir_y[i];
    const float z = ray.org_z[i] + ray.tfar[i] * ray.dir_z[i];
    met.x[i] = there ? x : first_x;
    met.y[i] = there ? y : first_y;
    met.z[i] = there ? z : first_z;
    met.range_m[i] = there ? ray.tfar[i] : first_m;
    met.points.x[i] = met.x[i];
    met.points.y[i] = met.y[i];
    met.points.z[i] = met.z[i];
    const float square = met.gx[i] * met.gx[i] + met.gy[i] * met.gy[i] + met.gz[i] * met.gz[i];
    const float along =
        met.gx[i] * ray.dir_x[i] + met.gy[i] * ray.dir_y[i] + met.gz[i] * ray.dir_z[i];
    const float size = there && square > 0.0F ? 1.0F / std::sqrt(square) : 0.0F;
    const float scale = along > 0.0F ? -size : size;
    met.gx[i] *= scale;
    met.gy[i] *= scale;
    met.gz[i] *= scale;
    met.nx[i] = met.gx[i];
    met.ny[i] = met.gy[i];
    met.nz[i] = met.gz[i];
    std::uint32_t mixed = met.number[i] * 0x9E3779B1U ^ hit.primID[i] * 0x85EBCA77U;
    mixed ^= mixed >> 15U;
    mixed *= 0x2C1B3C6DU;
    met.draw[i] = static_cast<float>(static_cast<std::int32_t>(mixed)) * 0x1.0p-31F;
  }
  return true;
}

RIGWIRE_WIDE_VECTORS void take_looks(const PreparedLook* looks, const LookLanes& look,
                                     MetSurfaces& met) {
  std::uint32_t first = ~0U;
  bool alike = true;
  for (const std::uint32_t which : look) {
    first = first == ~0U ? which : first;
    alike = alike && (which == first || which == ~0U);
  }
  if (alike && first == met.look) {
    return;
  }
  // A lane without a hit keeps the first look.
  const auto take = [&](std::uint32_t which, bool all) {
    const PreparedLook& from = looks[which];
    const Shade& s = from.shade;
    const auto set = [&](LaneArray& lanes, float value) {
#pragma GCC ivdep
      for (std::size_t i = 0; i < kLanes; ++i) {
        lanes[i] = all || look[i] == which ? value : lanes[i];
      }
    };
    set(met.red, s.one.red), set(met.green, s.one.green), set(met.blue, s.one.blue);
    set(met.red2, s.two.red), set(met.green2, s.two.green), set(met.blue2, s.two.blue);
    set(met.grain, s.grain), set(met.relief, s.relief), set(met.gloss, s.gloss);
    set(met.sharpness, s.sharpness), set(met.transmission, s.transmission);
    set(met.variation, s.variation), set(met.soaks, s.soaks), set(met.film, s.film);
    set(met.points.frequency_pm, s.frequency_pm), set(met.points.persistence, s.persistence);
    set(met.points.upright, s.upright), set(met.stones, s.stones);
    set(met.stone_red, s.stone.red), set(met.stone_green, s.stone.green);
    set(met.stone_blue, s.stone.blue);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      set(met.anchor.share[axis], from.share[axis]);
      for (std::size_t i = 0; i < kLanes; ++i) {
        met.anchor.cell[axis][i] =
            all || look[i] == which ? from.cell[axis] : met.anchor.cell[axis][i];
      }
    }
  };
  take(first, true);
  std::uint32_t taken = first;
  for (std::size_t lane = 0; lane < kLanes && !alike; ++lane) {
    if (look[lane] != taken && look[lane] != ~0U) {
      taken = look[lane];
      take(taken, false);
    }
  }
  met.look = alike ? first : ~0U;
}

RIGWIRE_WIDE_VECTORS void find_footprints(const RTCRayHit8& packet, const LaneArray& pixel_rad,
                                          MetSurfaces& met) {
  const RTCRay8& ray = packet.ray;
#pragma GCC ivdep
  for (std::size_t i = 0; i < kLanes; ++i) {
    const float along =
        met.nx[i] * ray.dir_x[i] + met.ny[i] * ray.dir_y[i] + met.nz[i] * ray.dir_z[i];
    const float cosine = along < 0.0F ? -along : along;
    met.points.footprint_m[i] =
        met.range_m[i] * pixel_rad[i] / std::sqrt(cosine > 0.05F ? cosine : 0.05F) + 1e-6F;
  }
}

RIGWIRE_WIDE_VECTORS void texture(const MetSurfaces& met, const Grain& grain, const Stones& stones,
                                  const LightTerms& light, LitLanes& lit) {
  const float sx = light.to_sun[0];
  const float sy = light.to_sun[1];
  const float sz = light.to_sun[2];
#pragma GCC ivdep
  for (std::size_t i = 0; i < kLanes; ++i) {
    // Relief bends the normal against its slope along the surface.
    const float slope_x = met.relief[i] * grain.slope_x[i] + stones.slope_x[i];
    const float slope_y = met.relief[i] * grain.slope_y[i] + stones.slope_y[i];
    const float slope_z = met.relief[i] * grain.slope_z[i] + stones.slope_z[i];
    const float along = slope_x * met.nx[i] + slope_y * met.ny[i] + slope_z * met.nz[i];
    float x = met.nx[i] - (slope_x - along * met.nx[i]);
    float y = met.ny[i] - (slope_y - along * met.ny[i]);
    float z = met.nz[i] - (slope_z - along * met.nz[i]);
    const float square = x * x + y * y + z * z;
    const float size = square > 0.0F ? 1.0F / std::sqrt(square) : 0.0F;
    x *= size;
    y *= size;
    z *= size;
    lit.nx[i] = x;
    lit.ny[i] = y;
    lit.nz[i] = z;
    float blend = 0.5F + 0.7F * grain.patch[i];
    blend = blend < 0.0F ? 0.0F : (blend > 1.0F ? 1.0F : blend);
    float bright = (1.0F + met.grain[i] * grain.brightness[i] * 2.5F) *
                   (1.0F + 1.7F * met.variation[i] * met.draw[i]);
    bright = bright < kDarkestGrain ? kDarkestGrain : bright;
    const float wet = light.wetness * met.soaks[i];
    bright *= (1.0F - (1.0F - kWetAlbedo) * wet) * stones.gap[i];
    float red = met.red[i] + blend * (met.red2[i] - met.red[i]);
    float green = met.green[i] + blend * (met.green2[i] - met.green[i]);
    float blue = met.blue[i] + blend * (met.blue2[i] - met.blue[i]);
    const float tone = stones.tone[i];
    red = bright * (red + stones.share[i] * (tone * met.stone_red[i] - red));
    green = bright * (green + stones.share[i] * (tone * met.stone_green[i] - green));
    blue = bright * (blue + stones.share[i] * (tone * met.stone_blue[i] - blue));
    lit.red[i] = red < 0.9F ? red : 0.9F;
    lit.green[i] = green < 0.9F ? green : 0.9F;
    lit.blue[i] = blue < 0.9F ? blue : 0.9F;
    const float film = kWater * wet * met.film[i];
    lit.gloss[i] = met.gloss[i] > film ? met.gloss[i] : film;
    lit.sharpness[i] = met.gloss[i] > film ? met.sharpness[i] : kWaterSharpness;
    const float facing = x * sx + y * sy + z * sz;
    const float front = facing > 0.0F ? facing : 0.0F;
    const float back = facing < 0.0F ? -facing : 0.0F;
    lit.sun[i] = (1.0F - met.transmission[i]) * front + met.transmission[i] * back;
  }
  float most = 0.0F;
  for (std::size_t i = 0; i < kLanes; ++i) {
    most = lit.gloss[i] > most ? lit.gloss[i] : most;
  }
  lit.glossy = most > 0.0F;
}

RIGWIRE_WIDE_VECTORS bool aim_at_sun(const MetSurfaces& met, const LitLanes& lit,
                                     const RTCRayHit8& packet, const Eigen::Vector3f& to_sun,
                                     RTCRay8& rays, std::array<int, kLanes>& active) {
  const float sx = to_sun.x();
  const float sy = to_sun.y();
  const float sz = to_sun.z();
  int any = 0;
#pragma GCC ivdep
  for (std::size_t i = 0; i < kLanes; ++i) {
    // Off the surface by what its point may be wrong: 2 mm and 1e-4 of the range. Where light comes
    // through a leaf, off its other side.
    const float facing = met.gx[i] * sx + met.gy[i] * sy + met.gz[i] * sz;
    float off = 2e-3F + 1e-4F * met.range_m[i];
    off = facing < 0.0F && met.transmission[i] > 0.0F ? -off : off;
    rays.org_x[i] = met.x[i] + off * met.gx[i];
    rays.org_y[i] = met.y[i] + off * met.gy[i];
    rays.org_z[i] = met.z[i] + off * met.gz[i];
    rays.dir_x[i] = sx;
    rays.dir_y[i] = sy;
    rays.dir_z[i] = sz;
    rays.tnear[i] = 0.0F;
    rays.tfar[i] = std::numeric_limits<float>::infinity();
    rays.time[i] = packet.ray.time[i];
    rays.mask[i] = Scene::kSeeEverything;
    rays.id[i] = 0;
    rays.flags[i] = 0;
    const int lights = lit.sun[i] > 0.0F ? -1 : 0;
    active[i] = lights;
    any |= lights;
  }
  return any != 0;
}

namespace {

/// What the coats of eight points send back: shares of the sun's illuminance and of the sky's
/// light, and where the mirror's direction points.
struct Coat {
  LaneArray glint, fresnel;
  LaneArray x, y, z;
};

inline void find_coat(const LitLanes& lit, const RTCRay8& ray, const LightTerms& light,
                      const LaneArray& seen, Coat& coat) {
#pragma GCC ivdep
  for (std::size_t i = 0; i < kLanes; ++i) {
    const float along =
        lit.nx[i] * ray.dir_x[i] + lit.ny[i] * ray.dir_y[i] + lit.nz[i] * ray.dir_z[i];
    coat.x[i] = ray.dir_x[i] - 2.0F * along * lit.nx[i];
    coat.y[i] = ray.dir_y[i] - 2.0F * along * lit.ny[i];
    coat.z[i] = ray.dir_z[i] - 2.0F * along * lit.nz[i];
    float cosine = along < 0.0F ? -along : 0.0F;
    cosine = cosine < 1.0F ? cosine : 1.0F;
    // Rough coats do not mirror at grazing incidence as smooth ones do: half the rise, less where
    // there is less of them than water would reflect.
    const float rise = lit.gloss[i] < kWater ? lit.gloss[i] * (0.5F / kWater) : 0.5F;
    coat.fresnel[i] = lit.gloss[i] + rise * (1.0F - lit.gloss[i]) * fifth(1.0F - cosine);
    // Half way between sun and eye.
    const float hx = light.to_sun[0] - ray.dir_x[i];
    const float hy = light.to_sun[1] - ray.dir_y[i];
    const float hz = light.to_sun[2] - ray.dir_z[i];
    const float square = hx * hx + hy * hy + hz * hz;
    float half = (lit.nx[i] * hx + lit.ny[i] * hy + lit.nz[i] * hz) /
                 std::sqrt(square > 1e-12F ? square : 1e-12F);
    half = half > 0.0F ? half : 0.0F;
    const float n = lit.sharpness[i];
    float lobe = 1.0F - (1.0F - half) * n * (1.0F / 16.0F);
    lobe = lobe > 0.0F ? lobe : 0.0F;
    lobe *= lobe;
    lobe *= lobe;
    lobe *= lobe;
    lobe *= lobe * (n + 8.0F) * (1.0F / (8.0F * kPi));
    const float facing =
        lit.nx[i] * light.to_sun[0] + lit.ny[i] * light.to_sun[1] + lit.nz[i] * light.to_sun[2];
    coat.glint[i] = facing > 0.0F ? coat.fresnel[i] * lobe * facing * seen[i] : 0.0F;
  }
}

}  // namespace

RIGWIRE_WIDE_VECTORS void light_up(const MetSurfaces& met, const LitLanes& lit,
                                   const RTCRayHit8& packet, const LightTerms& light,
                                   const LaneArray& seen, const LaneArray& sky,
                                   std::array<LaneArray, 3>& luminance) {
  const std::array<std::array<float, 9>, 3>& c = light.diffuse;
  LaneArray open;  // share of the diffuse light that arrives
#pragma GCC ivdep
  for (std::size_t i = 0; i < kLanes; ++i) {
    open[i] = sky[i] + (1.0F - sky[i]) * light.albedo_around;
    const float x = lit.nx[i];
    const float y = lit.ny[i];
    const float z = lit.nz[i];
    // Nine harmonics; even ones are the same from behind.
    const float xy = x * y;
    const float yz = y * z;
    const float zz = 3.0F * z * z - 1.0F;
    const float xz = x * z;
    const float xx = x * x - y * y;
    const float one_way = 1.0F - 2.0F * met.transmission[i];
    const float wx = one_way * x;
    const float wy = one_way * y;
    const float wz = one_way * z;
    const float sun = lit.sun[i] * seen[i];
    const auto band = [&](const std::array<float, 9>& k, float albedo, float sun_lx) {
      const float diffuse = k[0] + wy * k[1] + wz * k[2] + wx * k[3] + xy * k[4] + yz * k[5] +
                            zz * k[6] + xz * k[7] + xx * k[8];
      return albedo * (1.0F / kPi) * (sun_lx * sun + (diffuse > 0.0F ? diffuse : 0.0F) * open[i]);
    };
    luminance[0][i] = band(c[0], lit.red[i], light.sun_lx[0]);
    luminance[1][i] = band(c[1], lit.green[i], light.sun_lx[1]);
    luminance[2][i] = band(c[2], lit.blue[i], light.sun_lx[2]);
  }
  if (!lit.glossy) {
    return;
  }
  Coat shine;
  find_coat(lit, packet.ray, light, seen, shine);
#pragma GCC ivdep
  for (std::size_t i = 0; i < kLanes; ++i) {
    const float x = shine.x[i];
    const float y = shine.y[i];
    const float z = shine.z[i];
    const float xy = x * y;
    const float yz = y * z;
    const float zz = 3.0F * z * z - 1.0F;
    const float xz = x * z;
    const float xx = x * x - y * y;
    const float of_sky = shine.fresnel[i] * (1.0F / kPi) * open[i];
    const auto band = [&](const std::array<float, 9>& k, float sun_lx) {
      const float mirrored = k[0] + y * k[1] + z * k[2] + x * k[3] + xy * k[4] + yz * k[5] +
                             zz * k[6] + xz * k[7] + xx * k[8];
      return sun_lx * shine.glint[i] + of_sky * (mirrored > 0.0F ? mirrored : 0.0F);
    };
    luminance[0][i] += band(c[0], light.sun_lx[0]);
    luminance[1][i] += band(c[1], light.sun_lx[1]);
    luminance[2][i] += band(c[2], light.sun_lx[2]);
  }
}

}  // namespace rigwire::sim
