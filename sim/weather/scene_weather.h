// The weather of a scene: rain, snow, fog, haze and dust, each only if the parameters name it,
// varying in time.
//
// Everything moves on a grid of 20 ms: at each of its instants the air is prepared for beams, and a
// beam passes through the air of the instant at or before its own time (dust advected by the wind
// up to the beam's time), so that results depend neither on how time is sliced nor on who casts.
// Emitters are sampled at the first advance() at or after an instant.
//
// Cost of a beam and errors against more costly models: `rigwire bench weather`, docs/weather.md.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <span>
#include <vector>

#include "sim/weather/air_fault.h"
#include "sim/weather/droplets.h"
#include "sim/weather/dust_cloud.h"
#include "sim/weather/dust_emitter.h"
#include "sim/weather/dust_field.h"
#include "sim/weather/precipitation.h"
#include "sim/weather/weather.h"
#include "sim/weather/weather_parameters.h"
#include "sim/weather/wind.h"

namespace rigwire::sim {

/// What is in the air at a time of the course, interpolated.
struct AirState {
  double rain_mmph = 0.0;
  double snow_mmph = 0.0;
  double inverse_fog_visibility_pm = 0.0;
  double inverse_haze_visibility_pm = 0.0;
  Eigen::Vector2d wind_mps = Eigen::Vector2d::Zero();  ///< East, north; without gusts.
  double dryness = 0.0;
};

[[nodiscard]] AirState state_at(const std::vector<WeatherFrame>& course, Duration time);

class SceneWeather final : public Weather {
 public:
  static constexpr Duration kGrid = std::chrono::milliseconds{20};

  /// Clear air, for ever.
  SceneWeather();
  /// Throws std::invalid_argument as validate() does.
  SceneWeather(const WeatherParameters& parameters, std::uint64_t seed)
      : SceneWeather(parameters, seed, nullptr) {}
  /// Takes faults in addition to the course; they hold at the instants of the grid.
  SceneWeather(const WeatherParameters& parameters, std::uint64_t seed,
               std::shared_ptr<const AirFaults> faults);
  ~SceneWeather() override;

  /// Advances to `time`, which must not decrease: dust is stirred up, drifts and settles; rain and
  /// fog follow their course. Beams of times after the last call's `time` are answered from then
  /// on. Must not run while beams are cast.
  void advance(SimTime time, std::span<const DustEmitter> emitters);

  [[nodiscard]] AirPath along(const WeatherBeam& beam) const override;
  [[nodiscard]] bool present() const override { return present_; }

  // For tests, status and pictures.

  /// Returns the state by the course and its faults.
  [[nodiscard]] AirState state(SimTime time) const;
  [[nodiscard]] const DustParameters& dust_parameters() const { return parameters_.dust; }
  [[nodiscard]] const DustCloud& dust() const { return dust_; }
  [[nodiscard]] Eigen::Vector2d wind_mps() const { return wind_.velocity_mps(); }
  /// Returns the extinction per metre of everything but dust and the fog's layers, at an instant
  /// that is still kept.
  [[nodiscard]] double even_extinction_pm(SimTime time) const;

 private:
  /// The air at one instant of the grid.
  struct Air {
    SimTime time{};
    DropEchoes rain;
    DropEchoes snow;
    DropletOptics fog;
    DropletOptics haze;
    double even_pm = 0.0;  ///< Extinction of rain, snow and haze.
    Eigen::Vector3d wind_mps = Eigen::Vector3d::Zero();
    DustField dust;

    [[nodiscard]] bool clear() const {
      return even_pm == 0.0 && fog.extinction_pm == 0.0 && dust.empty();
    }
  };

  void step(SimTime time, std::span<const DustEmitter> emitters);
  void prepare(Air& air, SimTime time);
  [[nodiscard]] const Air& air_at(SimTime time) const;

  WeatherParameters parameters_;
  std::shared_ptr<const AirFaults> faults_;  ///< Null: there are none.
  Wind wind_;
  DustCloud dust_;
  bool dusty_ = false;
  SimTime until_{};         ///< Time of the last advance().
  std::deque<Air> airs_;    ///< In order of time; what beams may still ask for.
  std::vector<Air> spare_;  ///< Their memory is used again.
  bool present_ = false;
};

}  // namespace rigwire::sim
