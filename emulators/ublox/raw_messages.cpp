#include "emulators/ublox/raw_messages.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "emulators/ublox/aiding.h"
#include "protocols/ubx/aiding.h"
#include "protocols/ubx/blocks.h"

namespace rigwire::emulators {
namespace {

namespace gps = protocols::gps;
namespace ubx = protocols::ubx;
using ubx::MessageId;

constexpr MessageId kRxmAlm{0x02, 0x30};
constexpr MessageId kRxmEph{0x02, 0x31};

constexpr std::int64_t kMillisecond_ns = 1'000'000;
constexpr double kL1_hz = 1'575.42e6;
constexpr double kCyclesPerMillisecond = kL1_hz * 1e-3;

/// A carrier noisier than the greatest sigma of RXM-RAWX is not used.
constexpr double kCarrierStep_cycles = 0.004;
constexpr double kCarrierLimit_cycles = 15 * kCarrierStep_cycles;
/// The sign of the data, and with it the half cycle, is known after a preamble: 6 s and some.
constexpr Duration kHalfCycleResolved = std::chrono::seconds{8};

bool carrier_usable(const GnssMeasurement& m) {
  return m.carrier_sigma_cycles <= kCarrierLimit_cycles;
}
bool half_cycle_resolved(const GnssMeasurement& m) {
  return m.locked >= kHalfCycleResolved;
}

/// Exponent n of the least step * 2^n that is not less than sigma, 0..15.
std::uint8_t exponent_of(double sigma, double step) {
  std::uint8_t n = 0;
  while (n < 15U && !(std::ldexp(step, n) >= sigma)) {
    ++n;
  }
  return n;
}

std::uint8_t rounded_cn0(double cn0_dbhz) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(cn0_dbhz, 0.0, 99.0)));
}

struct QualityPair {
  std::int8_t quality = 4;
  std::uint8_t loss_of_lock = 3;
};

QualityPair quality_of(const GnssMeasurement& m) {
  if (!carrier_usable(m)) {
    return {4, 3};
  }
  if (m.slipped) {
    return {5, 3};
  }
  return half_cycle_resolved(m) ? QualityPair{7, 0} : QualityPair{6, 2};
}

ubx::RxmRawxBlock rawx_block(const GnssMeasurement& m) {
  ubx::RxmRawxBlock block{.pseudorange_m = m.pseudorange_m,
                          .doppler_hz = static_cast<float>(m.doppler_hz),
                          .system = static_cast<std::uint8_t>(m.system),
                          .satellite = m.number,
                          .cn0_dbhz = rounded_cn0(m.cn0_dbhz),
                          .pseudorange_sigma = exponent_of(m.pseudorange_sigma_m, 0.01),
                          .doppler_sigma = exponent_of(m.doppler_sigma_hz, 0.002),
                          .status = ubx::kRawxRangeValid};
  if (!carrier_usable(m)) {
    return block;
  }
  block.carrier_phase_cycles = m.carrier_phase_cycles;
  block.locked_ms = static_cast<std::uint16_t>(
      std::clamp<std::int64_t>(m.locked.count() / kMillisecond_ns, 0, ubx::kRawxLongestLock_ms));
  const double steps = std::ceil(m.carrier_sigma_cycles / kCarrierStep_cycles);
  block.carrier_sigma = static_cast<std::uint8_t>(
      std::clamp(steps, 1.0, static_cast<double>(ubx::kRawxNoCarrierSigma - 1)));
  block.status |= ubx::kRawxCarrierValid;
  if (half_cycle_resolved(m)) {
    block.status |= ubx::kRawxHalfCycleKnown;
  }
  return block;
}

/// RxmSvsiBlock::flags.
constexpr std::uint8_t kHealthy = 0x10;
constexpr std::uint8_t kEphemerisKnown = 0x20;
constexpr std::uint8_t kAlmanacKnown = 0x40;
constexpr std::uint8_t kNotAvailable = 0x80;

long degrees(double angle_rad) {
  return std::lround(angle_rad * 180.0 / std::numbers::pi);
}

/// Units of `unit_s` since a time of week, plus four, in four bits.
std::uint8_t age_of(const GpsTime& now, std::int32_t week, double time_of_week_s, double unit_s) {
  const double since_s = (now.week - week) * static_cast<double>(gps::kWeekSeconds) +
                         static_cast<double>(now.time_of_week_ns) * 1e-9 - time_of_week_s;
  return static_cast<std::uint8_t>(std::clamp(std::floor(since_s / unit_s) + 4.0, 0.0, 15.0));
}

/// Flags and age of a GPS satellite.
void say_orbits(const SubframeReception& reception, const GpsTime& now, ubx::RxmSvsiBlock& block) {
  const auto& ephemeris = reception.ephemeris(block.satellite);
  const auto& almanac = reception.almanac(block.satellite);
  if (!ephemeris && !almanac) {
    return;
  }
  block.flags = 0;
  if (almanac) {
    constexpr double kDay_s = 86'400.0;
    block.flags |= kAlmanacKnown;
    block.age |= age_of(now, almanac->week, almanac->almanac_time_s, kDay_s);
  }
  if (ephemeris) {
    constexpr double kHour_s = 3600.0;
    block.flags |= static_cast<std::uint8_t>(ephemeris->accuracy_index | kEphemerisKnown);
    block.age |= static_cast<std::uint8_t>(
        age_of(now, ephemeris->week, ephemeris->ephemeris_time_s, kHour_s) << 4U);
  }
  if ((ephemeris ? ephemeris->health : almanac->health) == 0) {
    block.flags |= kHealthy;
  }
}

bool per_satellite(MessageId id) {
  return id == ubx::AidEph::kId || id == kRxmEph || id == ubx::AidAlm::kId || id == kRxmAlm;
}
bool is_ephemeris(MessageId id) {
  return id == ubx::AidEph::kId || id == kRxmEph;
}

std::size_t nth_set(const std::bitset<32>& bits, std::size_t index) {
  std::size_t at = 0;
  while (at < bits.size() && (!bits[at] || index-- > 0)) {
    ++at;
  }
  return at;
}

}  // namespace

UbloxRawMessages::UbloxRawMessages(const Calendar& calendar, int generation)
    : calendar_(calendar), generation_(generation) {}

void UbloxRawMessages::begin(bool ephemerides_remembered, bool almanac_remembered) {
  reception_.begin(ephemerides_remembered, almanac_remembered);
  sbas_.begin();
  heard_ = false;
  phases_ = {};
  measurement_count_ = 0;
  view_count_ = 0;
}

void UbloxRawMessages::update(const GnssSample& sample, const UbloxTimeKnowledge& time) {
  const GpsTime now = calendar_.gps(sample.time);
  time_ = time;
  reception_.update(sample, now);
  sbas_.update(sample, now);
  set_label(sample);
  follow_phases(sample);
  clock_reset_ = sample.clock_reset;
  measurement_count_ = std::min(sample.measurements.size(), measurements_.size());
  std::copy_n(sample.measurements.begin(), measurement_count_, measurements_.begin());
  list_views(sample, now);
  last_ = sample.time;
  heard_ = true;
}

void UbloxRawMessages::list_views(const GnssSample& sample, const GpsTime& now) {
  view_count_ = 0;
  for (const SatelliteView& view : sample.satellites) {
    const bool known_system = view.system == GnssSystem::gps || view.system == GnssSystem::sbas;
    if (!known_system || view_count_ == views_.size()) {
      continue;
    }
    ubx::RxmSvsiBlock& block = views_[view_count_++];
    block = {.satellite = view.number,
             .flags = kNotAvailable,
             .azimuth_deg = static_cast<std::int16_t>(degrees(view.azimuth_rad) % 360),
             .elevation_deg = static_cast<std::int8_t>(degrees(view.elevation_rad))};
    if (view.system == GnssSystem::gps && view.number >= 1 && view.number <= gps::kSatellites) {
      say_orbits(reception_, now, block);
    }
  }
}

void UbloxRawMessages::set_label(const GnssSample& sample) {
  if (!time_.time_known) {
    label_ = {time_.since_start_ms, 0};
    return;
  }
  const GpsTime shown = calendar_.gps(sample.time + sample.clock_label_offset);
  label_ = {shown.time_of_week_ns / kMillisecond_ns,
            time_.week_known ? shown.week + time_.week_shift : 0};
}

void UbloxRawMessages::follow_phases(const GnssSample& sample) {
  std::bitset<gps::kSatellites> seen;
  const double elapsed_s = heard_ ? to_seconds(sample.time - last_) : 0.0;
  for (const GnssMeasurement& m : sample.measurements) {
    if (m.system != GnssSystem::gps || m.number < 1 || m.number > gps::kSatellites) {
      continue;
    }
    PhaseOrigin& phase = phases_[m.number - 1U];
    seen.set(m.number - 1U);
    if (!phase.locked || m.slipped) {
      phase.origin_cycles = std::floor(m.carrier_phase_cycles);
    } else if (sample.clock_reset) {
      // Phase grown by Doppler since (trapezoid); what is left of the jump is whole milliseconds.
      const double grown = -0.5 * (m.doppler_hz + phase.doppler_hz) * elapsed_s;
      const double jump = m.carrier_phase_cycles - phase.carrier_cycles - grown;
      phase.origin_cycles += std::round(jump / kCyclesPerMillisecond) * kCyclesPerMillisecond;
    }
    phase.locked = true;
    phase.carrier_cycles = m.carrier_phase_cycles;
    phase.doppler_hz = m.doppler_hz;
  }
  for (std::size_t i = 0; i < phases_.size(); ++i) {
    phases_[i].locked = phases_[i].locked && seen[i];
  }
}

bool UbloxRawMessages::handles(MessageId id) {
  return per_satellite(id) || id == ubx::RxmRawHead::kId || id == ubx::RxmRawxHead::kId ||
         id == ubx::RxmSfrb::kId || id == ubx::RxmSfrbxHead::kId || id == ubx::RxmSvsiHead::kId ||
         id == ubx::AidHui::kId;
}

std::size_t UbloxRawMessages::count(MessageId id) const {
  if (!heard_) {
    return 0;
  }
  if (id == ubx::RxmRawHead::kId || id == ubx::RxmRawxHead::kId || id == ubx::RxmSvsiHead::kId) {
    return 1;
  }
  if (id == ubx::RxmSfrb::kId || id == ubx::RxmSfrbxHead::kId) {
    return reception_.subframes().size() + sbas_.messages().size();
  }
  if (per_satellite(id)) {
    return is_ephemeris(id) ? reception_.new_ephemerides().count()
                            : reception_.new_almanacs().count();
  }
  return 0;
}

std::size_t UbloxRawMessages::encode(MessageId id, std::size_t index,
                                     std::span<std::uint8_t> out) const {
  if (index >= count(id)) {
    return 0;
  }
  if (id == ubx::RxmRawHead::kId) {
    return encode_raw(out);
  }
  if (id == ubx::RxmRawxHead::kId) {
    return encode_rawx(out);
  }
  if (id == ubx::RxmSvsiHead::kId) {
    return encode_svsi(out);
  }
  const bool of_satellites = id == ubx::RxmSfrb::kId || id == ubx::RxmSfrbxHead::kId;
  if (of_satellites && index >= reception_.subframes().size()) {
    return encode_sbas(id, sbas_.messages()[index - reception_.subframes().size()], out);
  }
  if (id == ubx::RxmSfrb::kId) {
    return encode_sfrb(reception_.subframes()[index], out);
  }
  if (id == ubx::RxmSfrbxHead::kId) {
    return encode_sfrbx(reception_.subframes()[index], out);
  }
  return is_ephemeris(id)
             ? encode_aiding_ephemeris(reception_, nth_set(reception_.new_ephemerides(), index) + 1,
                                       id, out)
             : encode_aiding_almanac(reception_, nth_set(reception_.new_almanacs(), index) + 1, id,
                                     out);
}

std::size_t UbloxRawMessages::answers(MessageId id, std::span<const std::uint8_t> selector) const {
  if (per_satellite(id)) {
    if (selector.empty()) {
      return gps::kSatellites;
    }
    return selector.size() == 1 && selector[0] >= 1 && selector[0] <= gps::kSatellites ? 1 : 0;
  }
  if (!selector.empty()) {
    return 0;
  }
  const bool measured =
      id == ubx::RxmRawHead::kId || id == ubx::RxmRawxHead::kId || id == ubx::RxmSvsiHead::kId;
  return id == ubx::AidHui::kId || (measured && heard_) ? 1 : 0;
}

std::size_t UbloxRawMessages::encode_answer(MessageId id, std::span<const std::uint8_t> selector,
                                            std::size_t index, std::span<std::uint8_t> out) const {
  if (index >= answers(id, selector)) {
    return 0;
  }
  if (id == ubx::AidHui::kId) {
    return encode_aiding_health(reception_, out);
  }
  if (per_satellite(id)) {
    const std::size_t prn = selector.empty() ? index + 1 : selector[0];
    return is_ephemeris(id) ? encode_aiding_ephemeris(reception_, prn, id, out)
                            : encode_aiding_almanac(reception_, prn, id, out);
  }
  return encode(id, index, out);
}

std::size_t UbloxRawMessages::encode_raw(std::span<std::uint8_t> out) const {
  std::array<ubx::RxmRawBlock, gps::kSatellites> blocks{};
  std::size_t n = 0;
  for (std::size_t i = 0; time_.time_known && i < measurement_count_; ++i) {
    const GnssMeasurement& m = measurements_[i];
    if (m.system != GnssSystem::gps || m.number < 1 || m.number > gps::kSatellites) {
      continue;
    }
    const QualityPair pair = quality_of(m);
    blocks[n++] = {
        .carrier_phase_cycles = m.carrier_phase_cycles - phases_[m.number - 1U].origin_cycles,
        .pseudorange_m = m.pseudorange_m,
        .doppler_hz = static_cast<float>(m.doppler_hz),
        .satellite = m.number,
        .quality = pair.quality,
        .cn0_dbhz = static_cast<std::int8_t>(rounded_cn0(m.cn0_dbhz)),
        .loss_of_lock = pair.loss_of_lock};
  }
  const ubx::RxmRawHead head{.time_of_week_ms = static_cast<std::int32_t>(label_.time_of_week_ms),
                             .week = static_cast<std::int16_t>(label_.week),
                             .satellites = static_cast<std::uint8_t>(n)};
  return ubx::encode_blocks<ubx::RxmRawHead, ubx::RxmRawBlock>(head, std::span(blocks).first(n),
                                                               out);
}

std::size_t UbloxRawMessages::encode_rawx(std::span<std::uint8_t> out) const {
  std::array<ubx::RxmRawxBlock, gps::kSatellites> blocks{};
  std::size_t n = 0;
  for (std::size_t i = 0; time_.time_known && i < measurement_count_; ++i) {
    blocks[n++] = rawx_block(measurements_[i]);
  }
  const ubx::RxmRawxHead head{
      .time_of_week_s = static_cast<double>(label_.time_of_week_ms) * 1e-3,
      .week = static_cast<std::uint16_t>(label_.week),
      .leap_seconds = static_cast<std::int8_t>(time_.leap_seconds),
      .measurements = static_cast<std::uint8_t>(n),
      .status = static_cast<std::uint8_t>((time_.leap_known ? ubx::kRawxLeapSecondsKnown : 0U) |
                                          (clock_reset_ ? ubx::kRawxClockReset : 0U)),
      .version = static_cast<std::uint8_t>(generation_ >= 8 ? 1 : 0)};
  return ubx::encode_blocks<ubx::RxmRawxHead, ubx::RxmRawxBlock>(head, std::span(blocks).first(n),
                                                                 out);
}

std::size_t UbloxRawMessages::encode_svsi(std::span<std::uint8_t> out) const {
  const std::size_t n = time_.time_known ? view_count_ : 0;
  const ubx::RxmSvsiHead head{.time_of_week_ms = static_cast<std::uint32_t>(label_.time_of_week_ms),
                              .week = static_cast<std::int16_t>(label_.week),
                              .visible = static_cast<std::uint8_t>(n),
                              .satellites = static_cast<std::uint8_t>(n)};
  return ubx::encode_blocks<ubx::RxmSvsiHead, ubx::RxmSvsiBlock>(head, std::span(views_).first(n),
                                                                 out);
}

std::size_t UbloxRawMessages::encode_sfrb(const ReceivedSubframe& received,
                                          std::span<std::uint8_t> out) const {
  constexpr std::uint32_t kSign = 0x80'0000;
  constexpr std::uint32_t kSignExtension = 0xFF00'0000;
  ubx::RxmSfrb message{.channel = received.channel, .satellite = received.prn};
  const auto words = gps::true_polarity(received.subframe);
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::uint32_t data = (words[i] >> gps::kParityBits) & gps::kDataMask;
    message.words[i] = (data & kSign) != 0U ? data | kSignExtension : data;
  }
  const auto frame = ubx::encode(message);
  std::ranges::copy(frame, out.begin());
  return frame.size();
}

std::size_t UbloxRawMessages::encode_sbas(MessageId id, const ReceivedSbas& received,
                                          std::span<std::uint8_t> out) {
  const auto& words = received.message.words;
  if (id == ubx::RxmSfrb::kId) {
    ubx::RxmSfrb message{.channel = received.channel, .satellite = received.prn};
    std::ranges::copy(words, message.words.begin());
    const auto frame = ubx::encode(message);
    std::ranges::copy(frame, out.begin());
    return frame.size();
  }
  std::array<ubx::RxmSfrbxWord, protocols::sbas::kWords> blocks{};
  for (std::size_t i = 0; i < words.size(); ++i) {
    blocks[i].word = words[i];
  }
  constexpr unsigned kMissingInLast = 32 * protocols::sbas::kWords - protocols::sbas::kMessageBits;
  blocks.back().word <<= kMissingInLast;
  const ubx::RxmSfrbxHead head{.system = static_cast<std::uint8_t>(GnssSystem::sbas),
                               .satellite = received.prn,
                               .words = static_cast<std::uint8_t>(blocks.size()),
                               .channel = received.channel};
  return ubx::encode_blocks<ubx::RxmSfrbxHead, ubx::RxmSfrbxWord>(head, blocks, out);
}

std::size_t UbloxRawMessages::encode_sfrbx(const ReceivedSubframe& received,
                                           std::span<std::uint8_t> out) const {
  std::array<ubx::RxmSfrbxWord, gps::kWords> blocks{};
  const auto words = gps::true_polarity(received.subframe);
  for (std::size_t i = 0; i < words.size(); ++i) {
    blocks[i].word = words[i];
  }
  const ubx::RxmSfrbxHead head{.system = static_cast<std::uint8_t>(GnssSystem::gps),
                               .satellite = received.prn,
                               .words = static_cast<std::uint8_t>(blocks.size()),
                               .channel = received.channel};
  return ubx::encode_blocks<ubx::RxmSfrbxHead, ubx::RxmSfrbxWord>(head, blocks, out);
}

}  // namespace rigwire::emulators
