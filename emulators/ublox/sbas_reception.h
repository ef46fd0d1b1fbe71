// Reception of satellite based augmentation (SBAS): one message a second of each satellite that the
// receiver tracks, whole ones only.
//
// The corrections that the model applies are its own, so what is sent says "nothing to correct":
// the mask of GPS, fast corrections of 0 for it, and null messages. A satellite sends, by second of
// the week, fast corrections (types 2 and 3) and null messages (63) in turn, the mask (1) and the
// degradation (7) once a minute; recordings of WAAS have the same types, and besides orbits,
// almanacs and the ionosphere's grid, which are not sent here.
#pragma once

#include <array>
#include <bitset>
#include <cstdint>
#include <span>
#include <vector>

#include "protocols/sbas/message.h"
#include "sim/samples/calendar.h"
#include "sim/samples/gnss_sample.h"

namespace rigwire::emulators {

struct ReceivedSbas {
  std::uint8_t prn = 0;      ///< 120..158.
  std::uint8_t channel = 0;  ///< Receiver channel; constant while a satellite is tracked.
  protocols::sbas::Message message;
};

class SbasReception {
 public:
  SbasReception();

  /// Nothing is tracked any more.
  void begin();
  /// An epoch at `now`; times do not decrease.
  void update(const GnssSample& sample, const GpsTime& now);

  /// Complete since the epoch before: by time, then by PRN.
  [[nodiscard]] std::span<const ReceivedSbas> messages() const { return messages_; }

 private:
  static constexpr std::uint8_t kFirstPrn = 120;
  static constexpr std::size_t kSatellites = 39;
  struct Channel {
    bool tracked = false;
    std::int64_t first_whole_s = 0;
  };

  [[nodiscard]] protocols::sbas::Message message_at(std::int64_t second) const;

  std::array<Channel, kSatellites> channels_{};
  std::bitset<32> gps_;  ///< GPS satellites with an ephemeris in the broadcast.
  std::int64_t seconds_done_ = -1;
  std::vector<ReceivedSbas> messages_;
};

}  // namespace rigwire::emulators
