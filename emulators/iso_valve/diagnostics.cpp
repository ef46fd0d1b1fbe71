// What the ISO 11783 valve block says in its trouble codes, and its settings' checks.
#include <algorithm>
#include <stdexcept>

#include "emulators/iso_valve/iso_valves.h"
#include "protocols/vehicle/message.h"

namespace rigwire::emulators {
namespace {

namespace vehicle = protocols::vehicle;
using namespace std::chrono_literals;

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

[[noreturn]] void refuse(const std::string& setting, const std::string& found,
                         const std::string& allowed) {
  throw std::invalid_argument("iso valves " + setting + ": found " + found + ", allowed " +
                              allowed);
}

void check(const char* setting, double value, double lower, double upper, const char* unit) {
  if (!(value >= lower && value <= upper)) {
    refuse(setting, std::to_string(value) + unit,
           std::to_string(lower) + " .. " + std::to_string(upper) + unit);
  }
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
  // One frame is filled up with ones; what is longer goes by transport as it is.
  std::array<std::uint8_t, vehicle::kMessageBytes> frame;
  frame.fill(0xFF);
  const auto payload = report.payload();
  const bool short_one = payload.size() <= frame.size();
  if (short_one) {
    std::ranges::copy(payload, frame.begin());
  }
  protocols::j1939::Identifier identifier;
  identifier.pgn = vehicle::kDm1Pgn;
  const bool sent =
      short_one ? node_.send(now, identifier, frame) : node_.send(now, identifier, payload);
  if (sent) {
    reported_ = troubles;
  }
  return sent;
}

void validate(const IsoValveSettings& settings) {
  validate(settings.amplifier);
  check("source_address", settings.source_address, 128, 247, "");
  check("serial", settings.serial, 0, (1U << 21U) - 1, "");
  check("manufacturer", settings.manufacturer, 0, 2047, "");
  const std::size_t sections = settings.amplifier.sections.size();
  check("first_valve", settings.first_valve, 0,
        static_cast<double>(protocols::iso11783::kAuxiliaryValves - sections), "");
  check("general_purpose_section", settings.general_purpose_section, 0,
        static_cast<double>(sections), "");
  const auto check_time = [](const char* setting, Duration value, Duration lower, Duration upper) {
    check(setting, to_seconds(value) * 1e3, to_seconds(lower) * 1e3, to_seconds(upper) * 1e3,
          " ms");
  };
  check_time("command_timeout", settings.command_timeout, 100ms, 10s);
  check_time("power_on", settings.power_on, 0ms, 8760h);
  check_time("processing_delay", settings.processing_delay, 0ms, 4ms);
  check_time("sample_period", settings.sample_period, 1ms, 1s);
  check("spool_travel", settings.spool_travel_m, 1e-4, 0.03, " m");
  for (const std::string& lever : settings.levers) {
    const std::string name = lever.starts_with("-") ? lever.substr(1) : lever;
    const auto& names = settings.amplifier.sections;
    if (!lever.empty() && std::ranges::find(names, name) == names.end()) {
      std::string allowed = "a section, or - and a section:";
      for (const std::string& section : names) {
        allowed.append(" ").append(section);
      }
      refuse("joysticks", "\"" + lever + "\"", allowed);
    }
  }
}

}  // namespace rigwire::emulators
