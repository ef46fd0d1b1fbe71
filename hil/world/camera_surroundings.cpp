#include "hil/world/camera_surroundings.h"

#include <chrono>
#include <utility>

#include "sim/camera/sun.h"

namespace rigwire::hil {
namespace {

constexpr Duration kLightPeriod = std::chrono::seconds(10);

}  // namespace

CameraSurroundings::CameraSurroundings(const Calendar& calendar, double latitude_deg,
                                       double longitude_deg, const sim::DaylightParameters& sky,
                                       const sim::WeatherParameters& air,
                                       std::shared_ptr<const sim::AirFaults> faults)
    : calendar_(calendar),
      latitude_deg_(latitude_deg),
      longitude_deg_(longitude_deg),
      daylight_(sky),
      weather_(air),
      faults_(std::move(faults)) {}

sim::Daylight CameraSurroundings::light_at(SimTime time) const {
  const SimTime held = light_changes(time) - kLightPeriod;
  return {daylight_, sim::sun_direction(
                         sim::sun_position(calendar_.utc(held), latitude_deg_, longitude_deg_))};
}

SimTime CameraSurroundings::light_changes(SimTime after) {
  return kStart + ((after - kStart) / kLightPeriod + 1) * kLightPeriod;
}

sim::CameraAir CameraSurroundings::air_at(SimTime time, const sim::DustCloud* dust) const {
  return {weather_, time, dust, faults_.get()};
}

std::shared_ptr<const sim::SkyVisibility> CameraSurroundings::sky(const sim::Scene& scene) {
  const std::scoped_lock lock(mutex_);
  if (!sky_) {
    sky_ = std::make_shared<const sim::SkyVisibility>(scene);
  }
  return sky_;
}

}  // namespace rigwire::hil
