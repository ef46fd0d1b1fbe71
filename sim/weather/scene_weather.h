// The weather of a scene: rain, fog, snow and dust, each only where the scene names it, changing in
// time.
#pragma once

#include <span>

#include "sim/weather/dust_emitter.h"
#include "sim/weather/weather.h"

namespace rigwire::sim {

class SceneWeather final : public Weather {
 public:
  /// Lives up to `time`, which must not decrease: dust is stirred up, drifts and settles; rain and
  /// fog follow their course. Not beside casting.
  void advance(SimTime time, std::span<const DustEmitter> emitters);

  [[nodiscard]] AirPath along(const WeatherBeam& beam) const override;
  [[nodiscard]] bool present() const override { return false; }
};

}  // namespace rigwire::sim
