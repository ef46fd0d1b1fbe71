// What the ISO 11783 valve block says in its trouble codes.
#include "emulators/iso_valve/iso_valves.h"

namespace rigwire::emulators {
namespace {

namespace vehicle = protocols::vehicle;

// Proprietary parameter numbers (J1939-73: 520192 .. 524287), this project's own; 168 and 1136 are
// the standard's supply voltage and control unit temperature.
constexpr std::uint32_t kCoilSpn = 520192;      // + section
constexpr std::uint32_t kPositionSpn = 520208;  // + section
constexpr std::uint32_t kCommandSpn = 520224;   // + section
constexpr std::uint32_t kSetUpSpn = 520240;
constexpr std::uint32_t kSupplyVoltageSpn = 168;
constexpr std::uint32_t kTemperatureSpn = 1136;

// Failure modes of J1939-73, annex A.
constexpr std::uint8_t kAboveNormal = 0;
constexpr std::uint8_t kErratic = 2;
constexpr std::uint8_t kVoltageLow = 4;
constexpr std::uint8_t kCurrentLow = 5;
constexpr std::uint8_t kCurrentHigh = 6;
constexpr std::uint8_t kMechanical = 7;
constexpr std::uint8_t kAbnormalRate = 9;
constexpr std::uint8_t kOutOfCalibration = 13;

vehicle::TroubleCode code_of(ValveFault fault, std::uint32_t section) {
  switch (fault) {
    case ValveFault::open_coil:
      return {kCoilSpn + section, kCurrentLow, 1};
    case ValveFault::over_current:
      return {kCoilSpn + section, kCurrentHigh, 1};
    case ValveFault::under_voltage:
      return {kSupplyVoltageSpn, kVoltageLow, 1};
    case ValveFault::spool_not_following:
      return {kPositionSpn + section, kMechanical, 1};
    case ValveFault::sensor:
      return {kPositionSpn + section, kErratic, 1};
    case ValveFault::over_temperature:
      return {kTemperatureSpn, kAboveNormal, 1};
    case ValveFault::none:
    case ValveFault::watchdog:
    case ValveFault::configuration:
      break;
  }
  return {kSetUpSpn, kOutOfCalibration, 1};
}

}  // namespace

IsoValves::Troubles IsoValves::troubles() const {
  Troubles troubles;
  const auto add = [&](const vehicle::TroubleCode& code) {
    if (troubles.count < troubles.codes.size()) {
      troubles.codes[troubles.count++] = code;
    }
  };
  if (amplifier_.fault() != ValveFault::none) {
    const auto section = static_cast<std::uint32_t>(amplifier_.fault_section().value_or(0));
    add(code_of(amplifier_.fault(), section));
  }
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    if (channels_[i].timed_out()) {
      add({kCommandSpn + static_cast<std::uint32_t>(i), kAbnormalRate, 1});
    }
  }
  return troubles;
}

bool IsoValves::send_diagnostics(SimTime now) {
  const Troubles troubles = this->troubles();
  vehicle::Lamps lamps;
  lamps.amber_warning = troubles.count != 0;
  lamps.red_stop = amplifier_.fault() != ValveFault::none;
  const vehicle::TroubleReport report =
      vehicle::make_trouble_report(lamps, std::span(troubles.codes).first(troubles.count));
  protocols::j1939::Identifier identifier;
  identifier.pgn = vehicle::kDm1Pgn;
  const bool sent = node_.send(now, identifier, report.payload());
  if (sent) {
    reported_ = troubles;
  }
  return sent;
}

}  // namespace rigwire::emulators
