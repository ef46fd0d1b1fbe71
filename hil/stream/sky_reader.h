// The satellites that a receiver reports, as a client reads them from its bytes: u-blox's NAV-SAT,
// else NMEA's GSV (directions) and GSA (which are used).
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "protocols/gnss_stream/splitter.h"
#include "protocols/nmea/readers.h"

namespace rigwire::hil {

struct SkySatellite {
  std::string name;  ///< "GPS 12": the system, and the message's own number.
  int azimuth_deg = 0;
  int elevation_deg = 0;
  int cn0_dbhz = 0;  ///< 0: no signal is received.
  bool used = false;
};

class SkyReader {
 public:
  using Use = std::function<void(std::string_view message, std::span<const SkySatellite> sky)>;
  /// Takes the next piece of the stream. Returns the whole sky with each NAV-SAT, and with the last
  /// GSV of each group of GSV. Satellites without a known direction are left out.
  void take(std::span<const std::uint8_t> bytes, const Use& use);

 private:
  void take(const protocols::ubx::FrameView& frame, const Use& use);
  void take(const protocols::nmea::SentenceView& sentence, const Use& use);
  void take_view(std::string_view talker, const protocols::nmea::Gsv& view, const Use& use);
  void take_used(std::string_view talker, const protocols::nmea::Gsa& used);
  /// Returns the satellites of all groups, each once.
  [[nodiscard]] std::vector<SkySatellite> sky() const;

  /// Satellites of one talker and one signal. A receiver that speaks NMEA 4.10 or later sends a
  /// group for each signal, and one with signal 0 for the satellites that it does not receive.
  struct Group {
    std::vector<protocols::nmea::GsvSatellite> incomplete;  ///< Pages received so far.
    std::vector<protocols::nmea::GsvSatellite> complete;
    int round = 0;  ///< Round in which it was completed.
  };

  protocols::gnss_stream::Splitter messages_;
  /// By talker and signal: 0 when the sentences do not name it.
  std::map<std::pair<std::string, int>, Group> groups_;
  int round_ = 0;  ///< The receiver sends each group once a round.
  /// System, 0 when the sentences do not name it, and number.
  std::set<std::pair<int, int>> used_;
  bool viewed_since_used_ = true;  ///< The next GSA begins an epoch.
};

}  // namespace rigwire::hil
