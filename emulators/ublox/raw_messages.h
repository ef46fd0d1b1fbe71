// What an emulated u-blox receiver says of raw measurements and broadcast navigation data, from
// samples to UBX frames:
//
//   RXM-RAW, RXM-SFRB             u-blox 7 with raw data (NEO-7P)
//   RXM-RAWX, RXM-SFRBX           u-blox M8T, F9
//   RXM-SVSI                      satellites in view with what is known of their orbits
//   AID-EPH, AID-ALM, AID-HUI     ephemerides, almanac, health with UTC and ionosphere; RXM-EPH and
//                                 RXM-ALM are older names of the first two
//
// The receiver calls begin() when it starts, update() at every epoch that it receives, and then
// asks for frames one by one. No I/O; nothing is allocated after construction.
//
// Sources: u-blox M8 receiver description, UBX-13003221 R28, sections 32.9 "UBX-AID" and 32.18
// "UBX-RXM". RXM-RAWX and RXM-SFRBX besides from recordings of a NEO-M8T (gpsd's regression tests):
// version 1 of RXM-RAWX; words in true polarity with the two bits before them. Where u-blox 7
// differs, from recordings of a NEO-7P:
// - RXM-RAW: the carrier phase starts near zero with each lock and runs on over the milliseconds by
//   which the receiver sets its clock; the pseudorange jumps with them.
// - RXM-RAW: mesQI and lli go in pairs: 7 and 0 locked, 6 and 2 while the half cycle is not
//   resolved, 5 and 3 just slipped, 4 and 3 without usable carrier.
// - RXM-SFRB: 24 data bits with their sign; a subframe leaves before the RXM-RAW of the epoch at
//   its end. Of SBAS each message a second, seven words of 32 bits and one of 26; the last two are
//   what was left in the buffer, here zero. (RXM-SFRBX has the eighth word's bits on the left.)
// - AID-EPH: words are 24 bits without sign, put together from what was decoded, so that reserved
//   bits, codes on L2 and age of data offset are 0; the hand-over word is that of toe.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "emulators/ublox/page_reception.h"
#include "emulators/ublox/sbas_reception.h"
#include "emulators/ublox/subframe_reception.h"
#include "protocols/ubx/frame.h"
#include "protocols/ubx/raw_measurements.h"
#include "sim/samples/calendar.h"
#include "sim/samples/gnss_sample.h"

namespace rigwire::emulators {

/// What the receiver knows of time at an epoch.
struct UbloxTimeKnowledge {
  bool time_known = false;  ///< Time of week; before it no measurement is said.
  bool week_known = false;  ///< Before it the week is 0.
  bool leap_known = false;
  std::int32_t leap_seconds = 0;
  std::int32_t week_shift = 0;       ///< Week as the firmware resolves it, less the true one.
  std::uint32_t since_start_ms = 0;  ///< Replaces the time of week until that is known.
};

/// Signals that one epoch measures at most; those beyond are left out.
inline constexpr std::size_t kMostRawSignals = 120;
/// Room for the longest frame of this file.
inline constexpr std::size_t kLongestRawFrame =
    protocols::ubx::kOverheadBytes + protocols::ubx::RxmRawxHead::kLength +
    kMostRawSignals * protocols::ubx::RxmRawxBlock::kLength;

class UbloxRawMessages {
 public:
  /// Time of the samples by `calendar`; `generation` as UbloxProfile::generation (7, 8, 9).
  UbloxRawMessages(const Calendar& calendar, int generation);

  /// The receiver starts or is reset: nothing is tracked. What it remembers of orbits stays; the
  /// first time it is what the satellites send at the first epoch.
  void begin(bool ephemerides_remembered, bool almanac_remembered);

  /// An epoch, in order of time. When the receiver receives nothing (antenna broken), it still
  /// comes, as a sample without tracked satellites: a satellite counts as tracked from one epoch
  /// that says so to the next one that does not.
  void update(const GnssSample& sample, const UbloxTimeKnowledge& time);

  /// Content of a message; `other`: not one of this file.
  enum class Kind : std::uint8_t { other, measurements, subframes, ephemeris, almanac, health };
  [[nodiscard]] static Kind kind(protocols::ubx::MessageId id);
  [[nodiscard]] static bool handles(protocols::ubx::MessageId id) {
    return kind(id) != Kind::other;
  }

  /// Frames of the message that are due at this epoch when it is switched on: one of RXM-RAW,
  /// RXM-RAWX, RXM-SVSI; one for each subframe and SBAS message that became complete of RXM-SFRB,
  /// RXM-SFRBX; one for each ephemeris or almanac that is new of the others. 0 before the first
  /// epoch.
  [[nodiscard]] std::size_t count(protocols::ubx::MessageId id) const;
  /// Writes frame `index` < count() and returns its size. Precondition: out.size() >=
  /// kLongestRawFrame.
  [[nodiscard]] std::size_t encode(protocols::ubx::MessageId id, std::size_t index,
                                   std::span<std::uint8_t> out) const;

  /// Frames that answer a poll with the payload `selector`: for the aiding messages one per
  /// satellite 1..32 or the one that the selector's only byte names, without data the short form;
  /// AID-HUI, RXM-RAW, RXM-RAWX, RXM-SVSI one. 0 when a poll is not answered.
  [[nodiscard]] std::size_t answers(protocols::ubx::MessageId id,
                                    std::span<const std::uint8_t> selector) const;
  /// Writes answer `index` < answers() and returns its size. Precondition: out.size() >=
  /// kLongestRawFrame.
  [[nodiscard]] std::size_t encode_answer(protocols::ubx::MessageId id,
                                          std::span<const std::uint8_t> selector, std::size_t index,
                                          std::span<std::uint8_t> out) const;

  /// What the receiver has collected.
  [[nodiscard]] const SubframeReception& reception() const { return reception_; }

 private:
  /// Label of the measurements, by the receiver's clock.
  struct Label {
    std::int64_t time_of_week_ms = 0;
    std::int32_t week = 0;
  };
  /// The carrier phase of RXM-RAW counts from here.
  struct PhaseOrigin {
    bool locked = false;
    double origin_cycles = 0.0;
    double carrier_cycles = 0.0;  ///< At the epoch before, with its Doppler.
    double doppler_hz = 0.0;
  };

  void set_label(const GnssSample& sample);
  void follow_phases(const GnssSample& sample);
  void list_views(const GnssSample& sample, const GpsTime& now);
  [[nodiscard]] std::size_t encode_measurements(protocols::ubx::MessageId id,
                                                std::span<std::uint8_t> out) const;
  [[nodiscard]] std::size_t encode_raw(std::span<std::uint8_t> out) const;
  [[nodiscard]] std::size_t encode_rawx(std::span<std::uint8_t> out) const;
  [[nodiscard]] std::size_t encode_svsi(std::span<std::uint8_t> out) const;
  const Calendar calendar_;
  int generation_;
  SubframeReception reception_;
  SbasReception sbas_;
  PageReception pages_;
  bool heard_ = false;
  SimTime last_{};
  UbloxTimeKnowledge time_;
  Label label_;
  bool clock_reset_ = false;
  std::array<PhaseOrigin, protocols::gps::kSatellites> phases_{};
  std::array<GnssMeasurement, kMostRawSignals> measurements_{};
  std::size_t measurement_count_ = 0;
  std::array<protocols::ubx::RxmSvsiBlock, 64> views_{};
  std::size_t view_count_ = 0;
};

}  // namespace rigwire::emulators
