#include "sim/gnss/error_field.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "sim/random.h"

namespace rigwire::sim {
namespace {

constexpr double kShortest = 10.0;   // maximum frequency, 1 / tau
constexpr double kSmallest = 100.0;  // maximum wave number of the troposphere, 1 / L
constexpr double kTroposphereLength_m = 5e5;
constexpr double kShellRadius_m = 6'371e3 + 350e3;

/// Cauchy's distribution within the shortest wave: the inverse of its distribution function.
double frequency(RandomStream& random) {
  const double greatest = std::atan(kShortest);
  return std::tan(random.uniform(-greatest, greatest));
}

double phase(RandomStream& random) {
  return random.uniform(0.0, 2.0 * std::numbers::pi);
}

Eigen::Vector3d gaussian3(RandomStream& random) {
  const double x = random.gaussian();
  const double y = random.gaussian();
  return {x, y, random.gaussian()};
}

/// Cauchy's distribution in three dimensions: a normal vector over a normal number.
Eigen::Vector3d cauchy3(RandomStream& random) {
  const Eigen::Vector3d vector = gaussian3(random);
  const Eigen::Vector3d number = vector / std::max(1e-9, std::abs(random.gaussian()));
  return number.norm() <= kSmallest ? number : Eigen::Vector3d(number.normalized() * kSmallest);
}

template <class Waves>
double sum(const Waves& waves, double time) {
  double value = 0.0;
  for (const auto& wave : waves) {
    value += std::cos(wave.frequency * time + wave.phase);
  }
  return value * std::sqrt(2.0 / static_cast<double>(waves.size()));
}

template <class Waves>
double sum(const Waves& waves, double time, const Eigen::Vector3d& place) {
  double value = 0.0;
  for (const auto& wave : waves) {
    value += std::cos(wave.frequency * time + wave.number.dot(place) + wave.phase);
  }
  return value * std::sqrt(2.0 / static_cast<double>(waves.size()));
}

/// In units of a length or time; what never changes has one value.
double scaled(double value, double unit) {
  return unit > 0.0 ? value / unit : 0.0;
}

/// Returns where a ray intersects the ionospheric shell.
Eigen::Vector3d pierce_point(const Eigen::Vector3d& p_E_m, const Eigen::Vector3d& direction_E) {
  // |p + s e| = R.
  const double along = p_E_m.dot(direction_E);
  const double missing = kShellRadius_m * kShellRadius_m - p_E_m.squaredNorm();
  const double s = -along + std::sqrt(std::max(0.0, along * along + missing));
  return p_E_m + s * direction_E;
}

}  // namespace

ErrorField::ErrorField(std::span<const Satellite> satellites, std::uint64_t seed)
    : values_(satellites.size()) {
  satellites_.reserve(satellites.size());
  for (const Satellite& satellite : satellites) {
    RandomStream random(seed, "gnss field/" + std::to_string(static_cast<int>(satellite.system)) +
                                  "/" + std::to_string(satellite.number));
    SatelliteWaves& waves = satellites_.emplace_back();
    const auto draw = [&](auto& part) {
      for (TimeWave& wave : part) {
        wave.frequency = frequency(random);
        wave.phase = phase(random);
      }
    };
    draw(waves.clock);
    std::ranges::for_each(waves.orbit, draw);
  }
  RandomStream ionosphere(seed, "gnss field/ionosphere");
  for (Wave& wave : ionosphere_) {
    wave.frequency = frequency(ionosphere);
    wave.number = gaussian3(ionosphere);
    wave.phase = phase(ionosphere);
  }
  RandomStream troposphere(seed, "gnss field/troposphere");
  for (Wave& wave : troposphere_) {
    wave.frequency = frequency(troposphere);
    wave.number = cauchy3(troposphere);
    wave.phase = phase(troposphere);
  }
}

double ErrorField::satellite(std::size_t index, double time_s, double correlation_s,
                             const Eigen::Vector3d& direction_E) const {
  const double time = scaled(time_s, correlation_s);
  SatelliteValue value;
  {
    const std::scoped_lock lock(mutex_);
    SatelliteValue& kept = values_[index];
    if (kept.time != time) {
      const SatelliteWaves& waves = satellites_[index];
      kept = {time,
              sum(waves.clock, time),
              {sum(waves.orbit[0], time), sum(waves.orbit[1], time), sum(waves.orbit[2], time)}};
    }
    value = kept;
  }
  return std::numbers::sqrt2 / 2.0 * (value.clock + value.orbit.dot(direction_E));
}

double ErrorField::ionosphere(double time_s, double correlation_s, double length_m,
                              const Eigen::Vector3d& p_E_m,
                              const Eigen::Vector3d& direction_E) const {
  const Eigen::Vector3d point = length_m > 0.0
                                    ? Eigen::Vector3d(pierce_point(p_E_m, direction_E) / length_m)
                                    : Eigen::Vector3d(Eigen::Vector3d::Zero());
  return sum(ionosphere_, scaled(time_s, correlation_s), point);
}

double ErrorField::troposphere(double time_s, double correlation_s,
                               const Eigen::Vector3d& p_E_m) const {
  return sum(troposphere_, scaled(time_s, correlation_s), p_E_m / kTroposphereLength_m);
}

}  // namespace rigwire::sim
