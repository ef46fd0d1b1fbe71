#include "emulators/vehicle_gateway/position.h"

#include <array>

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
};

}  // namespace

std::span<const VehicleReport::Entry> VehicleSatellites::schedule() {
  return kSchedule;
}

void VehicleSatellites::take(const GnssSample& sample) {
  report_.take(sample);
  taken_at_ = sample.time;
}

std::optional<protocols::can::Frame> VehicleSatellites::frame(SimTime now, std::uint32_t pgn,
                                                              std::uint8_t source) const {
  const bool fresh = taken_at_ && now - *taken_at_ <= kStale;
  const PositionReport report = fresh ? report_ : PositionReport{};
  switch (pgn) {
    case vehicle::VehiclePosition::kGroup.pgn:
      return vehicle::encode(report.position, source);
    case vehicle::VehicleDirectionSpeed::kGroup.pgn:
      return vehicle::encode(report.direction, source);
    case vehicle::VehiclePosition2::kGroup.pgn:
      return vehicle::encode(report.quality, source);
    default:
      return std::nullopt;
  }
}

}  // namespace rigwire::emulators
