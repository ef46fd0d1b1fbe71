#include "emulators/ublox/raw_messages.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "emulators/ublox/signals.h"
#include "fields/constants.h"
#include "protocols/ubx/aiding.h"
#include "protocols/ubx/blocks.h"

namespace rigwire::emulators {
namespace {

namespace gps = protocols::gps;
namespace ubx = protocols::ubx;
using ubx::MessageId;

constexpr MessageId kRxmAlm{0x02, 0x30};
constexpr MessageId kRxmEph{0x02, 0x31};

constexpr double kL1_hz = 1'575.42e6;
constexpr double kCyclesPerMillisecond = kL1_hz * 1e-3;

/// A carrier noisier than the maximum sigma of RXM-RAWX is not used.
constexpr double kCarrierStep_cycles = 0.004;
constexpr double kCarrierLimit_cycles = 15 * kCarrierStep_cycles;
/// The sign of the data, and with it the half cycle, is known after a preamble: 6 s and some.
constexpr Duration kHalfCycleResolved = std::chrono::seconds{8};

bool is_gps_l1(const GnssMeasurement& m) {
  return m.system == GnssSystem::gps && !m.second && m.number >= 1 && m.number <= gps::kSatellites;
}
bool carrier_usable(const GnssMeasurement& m) {
  return m.carrier_sigma_cycles <= kCarrierLimit_cycles;
}
bool half_cycle_resolved(const GnssMeasurement& m) {
  return m.locked >= kHalfCycleResolved;
}

/// Returns the smallest n for which step * 2^n is not less than sigma, at most 15.
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
                          .signal = ublox_signal(m.system, m.second),
                          .frequency_slot = ublox_frequency(m.system, m.number),
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
    constexpr double kAgeUnit_s = 86'400.0;
    block.flags |= kAlmanacKnown;
    block.age |= age_of(now, almanac->week, almanac->almanac_time_s, kAgeUnit_s);
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

// AID-EPH, AID-ALM and AID-HUI: whole frames of what was collected of the navigation message, under
// the id asked for; without data the short form.

// Words 3..10.
std::array<std::uint32_t, 8> content(const gps::SubframeData& data) {
  std::array<std::uint32_t, 8> words{};
  std::copy(data.words.begin() + 2, data.words.end(), words.begin());
  return words;
}

std::size_t encode_aiding_ephemeris(const SubframeReception& reception, std::size_t prn,
                                    MessageId id, std::span<std::uint8_t> out) {
  const auto& known = reception.ephemeris(prn);
  const auto satellite = static_cast<std::uint32_t>(prn);
  if (!known) {
    return ubx::encode(ubx::AidEphHead{.satellite = satellite}, out, id);
  }
  gps::Ephemeris decoded = *known;
  decoded.l2_code = 0;
  decoded.l2_p_data_off = false;
  decoded.age_of_data_offset = 0;
  ubx::AidEph message{.satellite = satellite};
  gps::SubframeData data;
  gps::set_head(data, {.next_step = static_cast<std::uint32_t>(decoded.ephemeris_time_s) /
                                    gps::kStepSeconds % gps::kStepsPerWeek,
                       .anti_spoof = false,
                       .subframe_id = 1});
  message.handover_word = data.words[1];
  gps::put_ephemeris(data, 1, decoded, decoded.week);
  message.subframe1 = content(data);
  gps::put_ephemeris(data, 2, decoded, decoded.week);
  message.subframe2 = content(data);
  gps::put_ephemeris(data, 3, decoded, decoded.week);
  message.subframe3 = content(data);
  return ubx::encode(message, out, id);
}

std::size_t encode_aiding_almanac(const SubframeReception& reception, std::size_t prn, MessageId id,
                                  std::span<std::uint8_t> out) {
  const auto& known = reception.almanac(prn);
  const auto satellite = static_cast<std::uint32_t>(prn);
  if (!known) {
    return ubx::encode(ubx::AidAlmHead{.satellite = satellite}, out, id);
  }
  gps::SubframeData data;
  gps::put_almanac(data, *known);
  return ubx::encode(ubx::AidAlm{.satellite = satellite,
                                 .week = static_cast<std::uint32_t>(known->week),
                                 .words = content(data)},
                     out, id);
}

std::size_t encode_aiding_health(const SubframeReception& reception, std::span<std::uint8_t> out) {
  constexpr std::uint32_t kHealthValid = 0x1;
  constexpr std::uint32_t kUtcValid = 0x2;
  constexpr std::uint32_t kIonosphereValid = 0x4;
  ubx::AidHui message;
  if (const auto& health = reception.health(); health) {
    for (std::size_t i = 0; i < gps::kSatellites; ++i) {
      message.health |= health->health[i] == 0 ? 1U << i : 0U;
    }
    message.flags |= kHealthValid;
  }
  if (const auto& page = reception.ionosphere_utc(); page) {
    message.utc_a0_s = page->utc_a0_s;
    message.utc_a1 = page->utc_a1;
    message.utc_reference_s = static_cast<std::int32_t>(page->utc_reference_time_s);
    message.utc_reference_week = static_cast<std::int16_t>(page->utc_reference_week);
    message.leap_seconds = static_cast<std::int16_t>(page->leap_seconds);
    message.leap_week = static_cast<std::int16_t>(page->leap_week);
    message.leap_day = static_cast<std::int16_t>(page->leap_day);
    message.leap_seconds_future = static_cast<std::int16_t>(page->leap_seconds_future);
    for (std::size_t i = 0; i < page->alpha.size(); ++i) {
      message.klobuchar_alpha[i] = static_cast<float>(page->alpha[i]);
      message.klobuchar_beta[i] = static_cast<float>(page->beta[i]);
    }
    message.flags |= kUtcValid | kIonosphereValid;
  }
  return ubx::encode(message, out);
}

/// Frames of ten words of GPS, or eight of SBAS, that were received.
std::size_t put_subframe(const ReceivedSubframe& received, std::span<std::uint8_t> out) {
  constexpr std::uint32_t kSign = 0x80'0000;
  constexpr std::uint32_t kSignExtension = 0xFF00'0000;
  ubx::RxmSfrb message{.channel = received.channel, .satellite = received.prn};
  const auto words = gps::true_polarity(received.subframe);
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::uint32_t data = (words[i] >> gps::kParityBits) & gps::kDataMask;
    message.words[i] = (data & kSign) != 0U ? data | kSignExtension : data;
  }
  return ubx::encode(message, out);
}

std::size_t put_subframe(const ReceivedSbas& received, std::span<std::uint8_t> out) {
  ubx::RxmSfrb message{.channel = received.channel, .satellite = received.prn};
  std::ranges::copy(received.message.words, message.words.begin());
  return ubx::encode(message, out);
}

template <class Received, std::size_t kCount>
std::size_t put_words(GnssSystem system, const Received& received,
                      const std::array<std::uint32_t, kCount>& words, std::span<std::uint8_t> out) {
  std::array<ubx::RxmSfrbxWord, kCount> blocks;
  std::ranges::transform(words, blocks.begin(),
                         [](std::uint32_t word) { return ubx::RxmSfrbxWord{word}; });
  const ubx::RxmSfrbxHead head{.system = static_cast<std::uint8_t>(system),
                               .satellite = received.prn,
                               .words = static_cast<std::uint8_t>(kCount),
                               .channel = received.channel};
  return ubx::encode_blocks(head, std::span<const ubx::RxmSfrbxWord>(blocks), out);
}

std::size_t put_words(const ReceivedSubframe& received, std::span<std::uint8_t> out) {
  return put_words(GnssSystem::gps, received, gps::true_polarity(received.subframe), out);
}

std::size_t put_words(const ReceivedSbas& received, std::span<std::uint8_t> out) {
  constexpr unsigned kMissingInLast = 32 * protocols::sbas::kWords - protocols::sbas::kMessageBits;
  auto words = received.message.words;
  words.back() <<= kMissingInLast;
  return put_words(GnssSystem::sbas, received, words, out);
}

std::size_t put_words(const ReceivedPage& received, std::span<std::uint8_t> out) {
  std::array<ubx::RxmSfrbxWord, 10> blocks;
  std::ranges::transform(received.words, blocks.begin(),
                         [](std::uint32_t word) { return ubx::RxmSfrbxWord{word}; });
  const ubx::RxmSfrbxHead head{.system = static_cast<std::uint8_t>(received.system),
                               .satellite = received.number,
                               .signal = ublox_data_signal(received.system, received.second),
                               .frequency_slot = ublox_frequency(received.system, received.number),
                               .words = received.count};
  return ubx::encode_blocks(head, std::span<const ubx::RxmSfrbxWord>(blocks).first(received.count),
                            out);
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
  pages_.begin();
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
  pages_.update(sample, now, calendar_.leap_seconds(sample.time));
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
    if (!is_gps_l1(m)) {
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

UbloxRawMessages::Kind UbloxRawMessages::kind(MessageId id) {
  if (id == ubx::RxmRawHead::kId || id == ubx::RxmRawxHead::kId || id == ubx::RxmSvsiHead::kId) {
    return Kind::measurements;
  }
  if (id == ubx::RxmSfrb::kId || id == ubx::RxmSfrbxHead::kId) return Kind::subframes;
  if (id == ubx::AidEph::kId || id == kRxmEph) return Kind::ephemeris;
  if (id == ubx::AidAlm::kId || id == kRxmAlm) return Kind::almanac;
  return id == ubx::AidHui::kId ? Kind::health : Kind::other;
}

std::size_t UbloxRawMessages::count(MessageId id) const {
  if (!heard_) {
    return 0;
  }
  switch (kind(id)) {
    case Kind::measurements:
      return 1;
    case Kind::subframes:
      // RXM-SFRB knows GPS and SBAS alone.
      return reception_.subframes().size() + sbas_.messages().size() +
             (id == ubx::RxmSfrbxHead::kId ? pages_.pages().size() : 0);
    case Kind::ephemeris:
      return reception_.new_ephemerides().count();
    case Kind::almanac:
      return reception_.new_almanacs().count();
    case Kind::health:
    case Kind::other:
      break;
  }
  return 0;
}

std::size_t UbloxRawMessages::encode(MessageId id, std::size_t index,
                                     std::span<std::uint8_t> out) const {
  if (index >= count(id)) {
    return 0;
  }
  switch (kind(id)) {
    case Kind::measurements:
      return encode_measurements(id, out);
    case Kind::ephemeris:
      return encode_aiding_ephemeris(reception_, nth_set(reception_.new_ephemerides(), index) + 1,
                                     id, out);
    case Kind::almanac:
      return encode_aiding_almanac(reception_, nth_set(reception_.new_almanacs(), index) + 1, id,
                                   out);
    default:
      break;
  }
  const auto put = [&](const auto& received) {
    return id == ubx::RxmSfrb::kId ? put_subframe(received, out) : put_words(received, out);
  };
  const std::size_t of_gps = reception_.subframes().size();
  const std::size_t of_sbas = sbas_.messages().size();
  if (index >= of_gps + of_sbas) {
    return put_words(pages_.pages()[index - of_gps - of_sbas], out);
  }
  return index < of_gps ? put(reception_.subframes()[index])
                        : put(sbas_.messages()[index - of_gps]);
}

std::size_t UbloxRawMessages::encode_measurements(MessageId id, std::span<std::uint8_t> out) const {
  if (id == ubx::RxmRawHead::kId) {
    return encode_raw(out);
  }
  return id == ubx::RxmRawxHead::kId ? encode_rawx(out) : encode_svsi(out);
}

std::size_t UbloxRawMessages::answers(MessageId id, std::span<const std::uint8_t> selector) const {
  const Kind kind = UbloxRawMessages::kind(id);
  if (kind == Kind::ephemeris || kind == Kind::almanac) {
    if (selector.empty()) {
      return gps::kSatellites;
    }
    return selector.size() == 1 && selector[0] >= 1 && selector[0] <= gps::kSatellites ? 1 : 0;
  }
  const bool told = kind == Kind::health || (kind == Kind::measurements && heard_);
  return told && selector.empty() ? 1 : 0;
}

std::size_t UbloxRawMessages::encode_answer(MessageId id, std::span<const std::uint8_t> selector,
                                            std::size_t index, std::span<std::uint8_t> out) const {
  if (index >= answers(id, selector)) {
    return 0;
  }
  const std::size_t prn = selector.empty() ? index + 1 : selector[0];
  switch (kind(id)) {
    case Kind::health:
      return encode_aiding_health(reception_, out);
    case Kind::ephemeris:
      return encode_aiding_ephemeris(reception_, prn, id, out);
    case Kind::almanac:
      return encode_aiding_almanac(reception_, prn, id, out);
    default:
      return encode(id, index, out);
  }
}

std::size_t UbloxRawMessages::encode_raw(std::span<std::uint8_t> out) const {
  std::array<ubx::RxmRawBlock, gps::kSatellites> blocks{};
  std::size_t n = 0;
  for (std::size_t i = 0; time_.time_known && i < measurement_count_; ++i) {
    const GnssMeasurement& m = measurements_[i];
    if (!is_gps_l1(m)) {
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
  return ubx::encode_blocks(head, std::span<const ubx::RxmRawBlock>(blocks).first(n), out);
}

std::size_t UbloxRawMessages::encode_rawx(std::span<std::uint8_t> out) const {
  std::array<ubx::RxmRawxBlock, kMostRawSignals> blocks{};
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
  return ubx::encode_blocks(head, std::span<const ubx::RxmRawxBlock>(blocks).first(n), out);
}

std::size_t UbloxRawMessages::encode_svsi(std::span<std::uint8_t> out) const {
  const std::size_t n = time_.time_known ? view_count_ : 0;
  const ubx::RxmSvsiHead head{.time_of_week_ms = static_cast<std::uint32_t>(label_.time_of_week_ms),
                              .week = static_cast<std::int16_t>(label_.week),
                              .visible = static_cast<std::uint8_t>(n),
                              .satellites = static_cast<std::uint8_t>(n)};
  return ubx::encode_blocks(head, std::span<const ubx::RxmSvsiBlock>(views_).first(n), out);
}

}  // namespace rigwire::emulators
