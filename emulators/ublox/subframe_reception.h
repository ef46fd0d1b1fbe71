// What a receiver collects from the navigation messages of the GPS satellites that it tracks:
// subframes as they become complete, and what follows from them.
//
// A subframe takes 6 s and is there for a satellite that was tracked from its beginning to its end;
// it comes with the first epoch at or after its end. (On a NEO-7P's line it leaves before the raw
// measurements of that epoch.) Orbits, ionosphere and UTC are known once their subframes came:
// an ephemeris with subframes 1, 2 and 3 of one issue, within 30 s; all almanacs within 12.5 min.
#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "protocols/gps/broadcast.h"
#include "sim/samples/calendar.h"
#include "sim/samples/gnss_sample.h"

namespace rigwire::emulators {

/// A subframe that became complete.
struct ReceivedSubframe {
  std::uint8_t prn = 0;
  std::uint8_t channel = 0;  ///< Receiver channel; constant while a satellite is tracked.
  protocols::gps::Step begun;
  protocols::gps::Subframe subframe;
};

class SubframeReception {
 public:
  SubframeReception();

  /// Starts with nothing tracked. What is said to be remembered is kept; a receiver that has never
  /// received anything takes it from what the satellites send at the next epoch.
  void begin(bool ephemerides_remembered, bool almanac_remembered);

  /// An epoch at `now`; times do not decrease. The satellites that sample.satellites calls tracked
  /// are.
  void update(const GnssSample& sample, const GpsTime& now);

  /// Complete since the epoch before: by time, then by PRN.
  [[nodiscard]] std::span<const ReceivedSubframe> subframes() const { return subframes_; }

  /// By PRN, 1..32.
  [[nodiscard]] const std::optional<protocols::gps::Ephemeris>& ephemeris(std::size_t prn) const {
    return ephemerides_[prn - 1];
  }
  [[nodiscard]] const std::optional<protocols::gps::Almanac>& almanac(std::size_t prn) const {
    return almanacs_[prn - 1];
  }
  [[nodiscard]] const std::optional<protocols::gps::IonosphereUtc>& ionosphere_utc() const {
    return ionosphere_utc_;
  }
  [[nodiscard]] const std::optional<protocols::gps::AlmanacHealth>& health() const {
    return health_;
  }
  /// Satellites whose ephemeris, or almanac, became known or changed at this epoch; by PRN - 1.
  [[nodiscard]] const std::bitset<32>& new_ephemerides() const { return new_ephemerides_; }
  [[nodiscard]] const std::bitset<32>& new_almanacs() const { return new_almanacs_; }

 private:
  struct Channel {
    bool tracked = false;
    std::uint8_t number = 0;
    std::int64_t first_whole_step = 0;
    std::uint8_t subframes_heard = 0;  ///< Bit id - 1, of the issue below.
    std::uint16_t issue = 0;
  };

  void take_navigation(const GnssSample& sample, std::int64_t now_ns);
  void recall();
  void track(const GnssSample& sample, std::int64_t now_ns);
  void receive(std::size_t prn, std::int64_t step);
  void hear(std::size_t prn, const protocols::gps::ScheduledSubframe& place,
            const protocols::gps::Broadcast& broadcast);
  void hear_page(const protocols::gps::ScheduledSubframe& place,
                 const protocols::gps::Broadcast& broadcast);
  [[nodiscard]] std::uint8_t free_channel() const;

  std::shared_ptr<const GpsNavigation> navigation_;
  protocols::gps::Broadcast now_;
  protocols::gps::Broadcast before_;  ///< For subframes that began up to before_until_ns_.
  std::int64_t before_until_ns_ = 0;
  std::int64_t last_ns_ = -1;
  std::int64_t steps_done_ = -1;
  bool recall_ephemerides_ = false;
  bool recall_almanac_ = false;
  std::array<Channel, protocols::gps::kSatellites> channels_{};
  std::vector<ReceivedSubframe> subframes_;
  std::array<std::optional<protocols::gps::Ephemeris>, protocols::gps::kSatellites> ephemerides_;
  std::array<std::optional<protocols::gps::Almanac>, protocols::gps::kSatellites> almanacs_;
  std::optional<protocols::gps::IonosphereUtc> ionosphere_utc_;
  std::optional<protocols::gps::AlmanacHealth> health_;
  std::bitset<32> new_ephemerides_;
  std::bitset<32> new_almanacs_;
};

}  // namespace rigwire::emulators
