// Light and air around all cameras of a rig: by its place and date, its weather, and what of the
// sky its scene leaves.
#pragma once

#include <memory>
#include <mutex>

#include "sim/camera/camera_air.h"
#include "sim/camera/daylight.h"
#include "sim/camera/sky_visibility.h"
#include "sim/samples/calendar.h"
#include "sim/scene/scene.h"
#include "sim/weather/dust_cloud.h"
#include "sim/weather/weather_parameters.h"

namespace rigwire::hil {

class CameraSurroundings {
 public:
  CameraSurroundings(const Calendar& calendar, double latitude_deg, double longitude_deg,
                     const sim::DaylightParameters& sky, const sim::WeatherParameters& air,
                     std::shared_ptr<const sim::AirFaults> faults = nullptr);

  /// Returns sun and sky at that time. The position of the sun is updated every ten seconds.
  [[nodiscard]] sim::Daylight light_at(SimTime time) const;
  [[nodiscard]] sim::CameraAir air_at(SimTime time, const sim::DustCloud* dust) const;
  /// Returns the sky visibility of the scene at its start; computed by the first caller. May be
  /// called from any thread.
  [[nodiscard]] std::shared_ptr<const sim::SkyVisibility> sky(const sim::Scene& scene);

  /// Returns when light_at() changes next.
  [[nodiscard]] static SimTime light_changes(SimTime after);

 private:
  Calendar calendar_;
  double latitude_deg_;
  double longitude_deg_;
  sim::DaylightParameters daylight_;
  sim::WeatherParameters weather_;
  std::shared_ptr<const sim::AirFaults> faults_;
  std::mutex mutex_;
  std::shared_ptr<const sim::SkyVisibility> sky_;
};

}  // namespace rigwire::hil
