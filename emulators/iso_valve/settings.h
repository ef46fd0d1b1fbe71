// What an ISO 11783 valve block is set to.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "emulators/j1939/identification.h"
#include "emulators/valve_amplifier/settings.h"
#include "fields/rules.h"
#include "sim/samples/time.h"

namespace rigwire::emulators {

/// Axes of the two joysticks, in the order of IsoValveSettings::levers.
enum class JoystickAxis : std::uint8_t {
  x1,
  y1,
  grip_x1,
  grip_y1,
  theta1,
  x2,
  y2,
  grip_x2,
  grip_y2,
  theta2,
};
inline constexpr std::size_t kJoystickAxes = 10;

struct IsoValveSettings {
  std::uint8_t source_address = 0x80;  ///< Preferred; 128 .. 247.
  std::uint32_t serial = 1;            ///< In the NAME; 21 bits.
  std::uint16_t manufacturer = 2047;   ///< In the NAME; 11 bits. 2047: no number assigned.
  std::uint8_t function = 255;         ///< In the NAME. 255: not specified.
  IdentificationSettings identification{.model = "valve block", .type = "auxiliary valve control"};
  std::uint8_t first_valve = 0;              ///< Auxiliary valve of section 1; the others follow.
  std::uint8_t general_purpose_section = 0;  ///< Of the general-purpose valve, from 1; 0 = none.
  Duration command_timeout = std::chrono::milliseconds(300);   ///< 100 ms .. 10 s.
  Duration power_on{0};                                        ///< From the start of the run.
  Duration processing_delay = std::chrono::microseconds(200);  ///< From an event to its frame.
  Duration sample_period = std::chrono::milliseconds(10);      ///< Transducers, 1 ms .. 1 s.
  double spool_travel_m = 0.007;                               ///< Neutral to full, 1e-4 .. 0.03.
  /// The section that each axis moves; a leading '-' turns it round; empty: none.
  std::array<std::string, kJoystickAxes> levers{};
  /// Its watchdog is not used: each valve has its own time-out.
  ValveAmplifierSettings amplifier;
};

void visit(fields::Visitor& v, IsoValveSettings& p);
/// Throws std::invalid_argument naming the setting, what was found and what is allowed.
void validate(const IsoValveSettings& settings);

}  // namespace rigwire::emulators
