// Reception of the navigation messages of Galileo, BeiDou and GLONASS, and of GPS on L2C: pages,
// subframes, strings and messages as they become complete, whole ones only, in the form in which
// RXM-SFRBX hands them on.
//
//   GPS       CNAV of L2 CM: a message of 12 s, ten words, the last with twelve bits of it. What
//             satellites send when: protocols/gps/cnav.h. QZSS' L2C is not handed on
//   Galileo   I/NAV of E1-B and E5b-I: a page of 2 s. Eight words, and a ninth of which nothing is
//             documented (recordings of ZED-F9P have it), here 0
//   BeiDou    D1 of B1I and B2I: subframes 1 to 3 of each 30 s, ten words. 4 and 5, the almanac,
//             are not handed on
//   GLONASS   strings 1 to 5 of each 30 s: three words and the numbers of superframe and frame.
//             The almanac, 6 to 15, is not handed on
//
// The data of a signal come while its carrier is measured (GnssSample::measurements), so without
// raw measurements there are none.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sim/samples/calendar.h"
#include "sim/samples/gnss_sample.h"

namespace rigwire::emulators {

struct ReceivedPage {
  GnssSystem system = GnssSystem::galileo;
  std::uint8_t number = 0;
  bool second = false;
  std::uint8_t count = 0;
  std::array<std::uint32_t, 10> words{};
};

class PageReception {
 public:
  PageReception();

  /// Nothing is tracked any more.
  void begin();
  /// An epoch at `now`, GPS ahead of UTC by so much; times do not decrease.
  void update(const GnssSample& sample, const GpsTime& now, std::int32_t leap_seconds);

  /// Complete since the epoch before: by time, then by system and number.
  [[nodiscard]] std::span<const ReceivedPage> pages() const { return pages_; }

 private:
  /// One carrier of a satellite that sends such data.
  struct Channel {
    GnssSystem system;
    std::uint8_t number;
    bool second;
    bool tracked = false;
    std::int64_t whole_from_s = 0;  ///< Tracked since, rounded up to a second.
  };

  void track(const GnssSample& sample, std::int64_t now_ns);
  void hear(const Channel& channel, std::int64_t second, std::int32_t leap_seconds);

  std::vector<Channel> channels_;
  std::shared_ptr<const GpsNavigation> now_;
  std::shared_ptr<const GpsNavigation> before_;  ///< What began up to before_until_s_ is of it.
  std::int64_t before_until_s_ = -1;
  std::int64_t seconds_done_ = -1;
  std::vector<ReceivedPage> pages_;
};

}  // namespace rigwire::emulators
