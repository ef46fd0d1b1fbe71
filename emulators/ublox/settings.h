// Settings of an emulated u-blox receiver, and its own defects; those of its surroundings come with
// the samples.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "emulators/supply.h"
#include "emulators/ublox/profile.h"
#include "fields/rules.h"
#include "sim/samples/fault_book.h"
#include "sim/samples/time.h"

namespace rigwire::emulators {

/// Position, velocity and satellites are repeated.
struct FrozenFixFault {
  static constexpr fields::Named kNamed{"frozen", "The device repeats its last fix; time goes on."};
};
struct WrongLeapSecondFault {
  static constexpr fields::Named kNamed{"wrong_leap_second", "The device's leap seconds are off."};

  int seconds = 1;
};
struct UartNoiseFault {
  static constexpr fields::Named kNamed{"noise",
                                        "Bits of the serial line are turned over, both ways."};

  double bit_error_rate = 1e-4;
  Duration ramp{0};

  void grow(double share) { bit_error_rate *= share; }
};

struct SlowFixFault {
  static constexpr fields::Named kNamed{"slow", "Only some of the epochs are worked out."};

  double share = 0.5;  ///< Share of the epochs that are solved, spread evenly.
  Duration ramp{0};

  void grow(double of_it) { share = 1.0 - of_it * (1.0 - share); }
};
struct RefusedConfigurationFault {
  static constexpr fields::Named kNamed{
      "refuses", "Whatever a client would change is answered with NAK and stays as it is."};
};

inline void visit(fields::Visitor&, FrozenFixFault&) {}
inline void visit(fields::Visitor&, RefusedConfigurationFault&) {}
void visit(fields::Visitor& v, SlowFixFault& p);
void visit(fields::Visitor& v, WrongLeapSecondFault& p);
void visit(fields::Visitor& v, UartNoiseFault& p);

struct UbloxFault {
  FaultPeriod when;
  std::variant<FrozenFixFault, SlowFixFault, WrongLeapSecondFault, RefusedConfigurationFault,
               UartNoiseFault>
      what;
};
void visit(fields::Visitor& v, UbloxFault& p);

struct UbloxSettings {
  const UbloxProfile* profile = &ublox_neo_7p();          ///< The type of receiver.
  std::uint32_t baud = 9600;                              ///< One of ublox_bauds(), 8N1.
  Duration measurement_period = std::chrono::seconds{1};  ///< shortest_period .. 62.5 s, whole ms.
  /// Sentences switched on at start: RMC VTG GGA GSA GSV GLL ZDA.
  std::vector<std::string> nmea_sentences{"RMC", "VTG", "GGA", "GSA", "GSV", "GLL"};
  /// UBX messages switched on at start: NAV-POSECEF, NAV-SOL, ... (see UbloxProfile::messages).
  std::vector<std::string> ubx_messages;
  /// RTCM messages that the second UART sends from the start, of types that have one, and its
  /// speed.
  std::vector<std::string> uart2_messages;
  std::uint32_t uart2_baud = 38'400;
  /// Earth-fixed place that it holds from power-on as a base station (CFG-TMODE fixed), and the
  /// station that it then calls itself.
  std::optional<std::array<double, 3>> place_E_m;
  std::uint16_t station = 0;
  /// False: messages of a base station are counted and not used.
  bool uses_corrections = true;
  /// From power-on to the first fix; 0 = hot start, with a fix in the first epoch. A cold restart
  /// by CFG-RST takes this time again, or 30 s when it is 0. At most 1 h.
  Duration time_to_first_fix{0};
  /// From the navigation epoch to the first byte; 0 .. 200 ms. Not documented by u-blox; clients
  /// allow for 60 .. 120 ms.
  Duration solution_latency = std::chrono::milliseconds{80};
  /// From power-on or reset to the first byte; 0 .. 10 s. Not documented.
  Duration start_up = std::chrono::milliseconds{200};
  bool start_banner = true;  ///< The TXT sentences after power-on and reset.
  /// Bytes that wait for the line at most, 1024 .. 65536; a message that does not fit is lost
  /// whole.
  std::size_t transmit_buffer_bytes = 4096;
  /// Keeps time, orbits and the saved configuration while the supply is off.
  bool backup_battery = true;
  std::vector<UbloxFault> faults;
  std::vector<SupplyFault> supply_faults;
  std::uint64_t noise_seed = 1;  ///< Seed of the noise, the chip's number and its radio.
};

/// Precondition: the profile is not null; it sets the ranges of `rate` and `baud`.
void visit(fields::Visitor& v, UbloxSettings& p);
/// Throws std::invalid_argument naming the setting, the value found and what is allowed; also when
/// the messages switched on do not fit through the line: bytes per second needed and available
/// (what the device is delivered with is always allowed).
void validate(const UbloxSettings& settings);

/// Line speeds that CFG-PRT and the settings accept.
[[nodiscard]] std::span<const std::uint32_t> ublox_bauds();

}  // namespace rigwire::emulators
