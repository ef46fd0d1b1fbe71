#include "sim/lidar/beam_air.h"

#include <algorithm>
#include <cmath>

namespace rigwire::sim {
namespace {

/// Two-way optical depth; light that is gone altogether has a large one.
double optical_depth(const AirPath& path) {
  return -std::log(std::max(path.transmission, 1e-30));
}

/// A limit of detection above any echo.
constexpr double kNoEcho = 1e30;

/// Optical depth over range: straight lines from 0 through one or two known points.
struct Depths {
  double near_m = 0.0;
  double at_near = 0.0;
  double far_m = 0.0;
  double at_far = 0.0;

  [[nodiscard]] double at(double range_m) const {
    if (range_m >= far_m) {
      return far_m > 0.0 ? at_far * range_m / far_m : 0.0;
    }
    return at_near + (at_far - at_near) * (range_m - near_m) / (far_m - near_m);
  }
};

}  // namespace

AirEchoes pass_air(const Weather& weather, WeatherBeam beam, std::span<const float> weights,
                   std::span<SubRayHits> hits, std::size_t lane) {
  Depths depths;
  double near_m = SubRayHits::kNothing;
  bool open = false;  // for some part of the beam there is nothing but air
  for (std::size_t i = 0; i < hits.size(); ++i) {
    const auto range_m = static_cast<double>(hits[i].range_m[lane]);
    if (i >= weights.size() && !(hits[i].energy[lane] > 0.0F)) {
      continue;
    }
    if (std::isfinite(range_m)) {
      near_m = std::min(near_m, range_m);
      depths.far_m = std::max(depths.far_m, range_m);
    } else {
      open = true;
    }
  }
  if (!open) {
    beam.far_m = depths.far_m;
  }
  const AirPath path = weather.along(beam);
  const auto depth_at = [&](double far_m) {
    WeatherBeam shorter = beam;
    shorter.far_m = far_m;
    shorter.detection_energy = kNoEcho;  // its depth alone is asked for
    return optical_depth(weather.along(shorter));
  };
  if (depths.far_m > 0.0) {
    depths.at_far = open ? depth_at(depths.far_m) : optical_depth(path);
    if (depths.far_m - near_m > beam.pulse_m) {
      depths.near_m = near_m;
      depths.at_near = depth_at(near_m);
    }
  }
  for (SubRayHits& hit : hits) {
    if (hit.energy[lane] > 0.0F) {
      const auto range_m = static_cast<double>(hit.range_m[lane]);
      // Beer and Lambert: exp(-2 tau) by the two-way depth at the hit's range.
      const auto transmission = static_cast<float>(std::exp(-depths.at(range_m)));
      hit.energy[lane] *= transmission;
      hit.brightness[lane] *= transmission;
    }
  }
  AirEchoes echoes;
  for (std::size_t k = 0; k < path.echo_count; ++k) {
    const auto range_m = static_cast<float>(path.echoes[k].range_m);
    float share = 0.0F;
    for (std::size_t i = 0; i < weights.size(); ++i) {
      // Share of the beam that no surface has stopped before the air's echo.
      share += hits[i].range_m[lane] > range_m ? weights[i] : 0.0F;
    }
    const float energy = share * static_cast<float>(path.echoes[k].energy);
    if (energy > 0.0F) {
      const float brightness =
          energy * range_m * range_m / static_cast<float>(path.echoes[k].share_taken);
      echoes.parts[echoes.count++] = {range_m, energy, brightness, 0.0F};
    }
  }
  return echoes;
}

}  // namespace rigwire::sim
