#include "emulators/vehicle_gateway/position.h"

#include <array>
#include <cmath>

namespace rigwire::emulators {

namespace vehicle = protocols::vehicle;

namespace {

constexpr vehicle::Group every(vehicle::Group group, std::chrono::milliseconds period) {
  group.period = period;
  return group;
}

using namespace std::chrono_literals;
constexpr std::array kSchedule{
    VehicleReport::Entry{every(vehicle::VehiclePosition::kGroup, 1s), 12},
    VehicleReport::Entry{every(vehicle::VehicleDirectionSpeed::kGroup, 1s), 22},
    VehicleReport::Entry{every(vehicle::VehiclePosition2::kGroup, 5s), 32},
    VehicleReport::Entry{vehicle::GroundBasedSpeed::kGroup, 7},
};

}  // namespace

std::span<const VehicleReport::Entry> VehicleSatellites::schedule() {
  return kSchedule;
}

void VehicleSatellites::take(const GnssSample& sample) {
  report_.take(sample);
  if (taken_at_ && std::isfinite(report_.direction.speed_mps)) {
    distance_m_ += report_.direction.speed_mps * to_seconds(sample.time - *taken_at_);
  }
  taken_at_ = sample.time;
}

std::optional<protocols::can::Frame> VehicleSatellites::frame(SimTime now, std::uint32_t pgn,
                                                              std::uint8_t source,
                                                              double vehicle_speed_mps) const {
  const bool fresh = taken_at_ && now - *taken_at_ <= kStale;
  const PositionReport report = fresh ? report_ : PositionReport{};
  switch (pgn) {
    case vehicle::VehiclePosition::kGroup.pgn:
      return vehicle::encode(report.position, source);
    case vehicle::VehicleDirectionSpeed::kGroup.pgn:
      return vehicle::encode(report.direction, source);
    case vehicle::VehiclePosition2::kGroup.pgn:
      return vehicle::encode(report.quality, source);
    case vehicle::GroundBasedSpeed::kGroup.pgn: {
      vehicle::GroundBasedSpeed message;
      message.speed_mps = report.direction.speed_mps;
      if (std::isfinite(message.speed_mps)) {
        message.distance_m = distance_m_;
        if (std::isfinite(vehicle_speed_mps)) {
          message.forward = vehicle::to_switch(vehicle_speed_mps >= 0.0);
        }
      }
      return vehicle::encode(message, source);
    }
    default:
      return std::nullopt;
  }
}

}  // namespace rigwire::emulators
