// Position fixes from the bytes that a satellite receiver sent: NMEA's GGA and u-blox's NAV-PVT, as
// a client reads them, and how sure they are.
//
// Standard deviations are NAV-PVT's accuracies, the horizontal one along east and along north;
// NMEA's are those of a GST between the fix before and this one, else a guess: the horizontal
// dilution times what gpsd takes (libgpsd_core.c, at 95 %: 15 m across and 23 m upwards of a fix
// alone, 3.75 m and 5.75 m with differential corrections; across that is 2.45 standard deviations,
// upwards 1.96), of integer RTK 2 cm and 4 cm, of float RTK nothing.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>

#include "protocols/gnss_stream/splitter.h"
#include "sim/local_frame.h"

namespace rigwire::hil {

struct ReceiverFix {
  sim::GeodeticPoint place;
  std::optional<std::array<double, 3>> sigma_m{};  ///< East, north, up; empty: nothing says.
  bool guessed = false;                            ///< By the dilution.
};

class FixReader {
 public:
  using Use = std::function<void(const ReceiverFix& fix)>;
  /// The next piece of the stream. A message without fix makes none.
  void take(std::span<const std::uint8_t> bytes, const Use& use);

 private:
  protocols::gnss_stream::Splitter messages_;
  std::optional<std::array<double, 3>> told_sigma_m_;  ///< By GST, for the next GGA.
};

}  // namespace rigwire::hil
