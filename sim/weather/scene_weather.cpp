#include "sim/weather/scene_weather.h"

namespace rigwire::sim {

void SceneWeather::advance(SimTime /*time*/, std::span<const DustEmitter> /*emitters*/) {}

AirPath SceneWeather::along(const WeatherBeam& /*beam*/) const {
  return {};
}

}  // namespace rigwire::sim
