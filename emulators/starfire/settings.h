// Settings of an emulated John Deere StarFire 3000: its serial line and its node on the bus.
//
// What the display of the real one sets (operator's manual OMPFP11008, "Serial RS232 Output"):
// speed, message rate, and each of five sentences on or off. Which speeds and rates it offers is
// not known; here any usual one is taken.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "emulators/j1939/identity.h"
#include "emulators/supply.h"
#include "sim/samples/time.h"

namespace rigwire::emulators {

struct StarFireSettings {
  std::uint32_t baud = 19200;                          ///< 4800 .. 115200, 8N1.
  Duration sentence_period = std::chrono::seconds{1};  ///< 100 ms, 200 ms or 1 s.
  /// In the order in which they leave: GGA GSA RMC VTG ZDA.
  std::vector<std::string> sentences{"GGA", "GSA", "RMC", "VTG", "ZDA"};
  std::string talker = "GP";  ///< GP or GN.
  SupplySettings supply;
  Duration start_up = std::chrono::seconds{2};  ///< From there to the first sample; 0 .. 10 min.
  Duration latency =
      std::chrono::milliseconds{80};  ///< From the epoch to what it sends; 0 .. 90 ms.
  // The node.
  std::uint8_t source_address = 28;  ///< 0 .. 253.
  std::uint32_t serial = 1;          ///< 1 .. 2097151; identity in the NAME, unique on a bus.
  /// The real device's NAME is not known: function and industry group are the standard's, the
  /// manufacturer code is no maker's.
  J1939NameSettings name{.function = kVehicleNavigation, .industry_group = kAgriculture};
};

void visit(fields::Visitor& v, StarFireSettings& p);
/// Throws std::invalid_argument naming the setting, the value found and what is allowed; also when
/// the sentences do not fit through the line.
void validate(const StarFireSettings& settings);

/// Epochs of the node: 5 Hz.
inline constexpr Duration kStarFirePeriod = std::chrono::milliseconds{200};

}  // namespace rigwire::emulators
