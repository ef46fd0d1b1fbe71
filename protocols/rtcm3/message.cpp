#include "protocols/rtcm3/message.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "protocols/rtcm3/bits.h"
#include "protocols/rtcm3/multiple_signals.h"

namespace rigwire::protocols::rtcm3 {
namespace {

constexpr unsigned kNumberBits = 12;
constexpr unsigned kStationBits = 12;
constexpr double kStep_m = 1e-4;  // of antenna positions

template <class Bits>
constexpr bool kReads = std::is_same_v<Bits, BitReader>;

template <class Bits, class Position>
void walk_coordinate(Bits& bits, Position& position_m, std::size_t axis) {
  constexpr unsigned kCoordinate = 38;
  bits.scaled(kCoordinate, Sign::twos, kStep_m, position_m[axis]);
}

/// 1005 and 1006: RTCM 10403.3 tables 3.5-6 and 3.5-7.
template <class Bits, class Record>
void walk(Bits& bits, Record& p) {
  bits.whole(kStationBits, p.station);
  bits.whole(6, p.itrf_year);
  bits.flag(p.gps);
  bits.flag(p.glonass);
  bits.flag(p.galileo);
  bits.flag(p.computed);
  walk_coordinate(bits, p.position_m, 0);
  bits.flag(p.single_oscillator);
  bits.spare(1);
  walk_coordinate(bits, p.position_m, 1);
  bits.whole(2, p.quarter_cycles);
  walk_coordinate(bits, p.position_m, 2);
}
constexpr unsigned kHeightBits = 16;

Message read_position(BitReader& bits, bool with_height) {
  AntennaPosition p;
  walk(bits, p);
  if (with_height) {
    bits.scaled(kHeightBits, Sign::none, kStep_m, p.antenna_height_m.emplace());
  }
  return p;
}

void write(BitWriter& bits, const AntennaPosition& p) {
  walk(bits, p);
  if (p.antenna_height_m) {
    bits.scaled(kHeightBits, Sign::none, kStep_m, *p.antenna_height_m);
  }
}

/// 1230: table 3.5-104; a bias follows for each bit of the mask.
template <class Bits, class Record>
void walk_biases(Bits& bits, Record& p) {
  constexpr double kBias_m = 0.02;
  bits.whole(kStationBits, p.station);
  bits.flag(p.aligned);
  bits.spare(3);
  for (auto& bias : p.biases_m) {
    bool there = bias.has_value();
    bits.flag(there);
    if constexpr (kReads<Bits>) {
      bias = there ? std::optional(0.0) : std::nullopt;
    }
  }
  for (auto& bias : p.biases_m) {
    if (bias) {
      bits.scaled(16, Sign::twos, kBias_m, *bias);
    }
  }
}

/// 1033: table 3.5-18; each text behind the count of its characters.
template <class Bits, class Text>
void walk_text(Bits& bits, Text& text) {
  bits.whole(8, text.size);
  for (std::size_t i = 0; i < std::min<std::size_t>(text.size, StationDescriptors::Text::kGreatest);
       ++i) {
    bits.whole(8, text.characters[i]);
  }
}

template <class Bits, class Record>
void walk_descriptors(Bits& bits, Record& p) {
  bits.whole(kStationBits, p.station);
  walk_text(bits, p.antenna);
  bits.whole(8, p.set_up);
  for (auto* text : {&p.antenna_serial, &p.receiver, &p.firmware, &p.receiver_serial}) {
    walk_text(bits, *text);
  }
}

/// False: a count that no text has.
bool read_descriptors(BitReader& bits, StationDescriptors& p) {
  walk_descriptors(bits, p);
  return std::ranges::all_of(
      std::array{p.antenna.size, p.antenna_serial.size, p.receiver.size, p.firmware.size,
                 p.receiver_serial.size},
      [](std::size_t size) { return size <= StationDescriptors::Text::kGreatest; });
}

/// 4072.0, ours.
template <class Bits, class Record>
void walk_moving(Bits& bits, Record& p) {
  constexpr double kSpeedStep_mps = 1e-3;
  bits.spare(kStationBits);  // subtype 0
  bits.whole(kStationBits, p.station);
  bits.whole(30, p.time_of_week_ms);
  for (std::size_t axis = 0; axis < p.position_m.size(); ++axis) {
    walk_coordinate(bits, p.position_m, axis);
  }
  for (auto& speed_mps : p.velocity_mps) {
    bits.scaled(19, Sign::twos, kSpeedStep_mps, speed_mps);
  }
}

// 1001 to 1004 and 1009 to 1012: tables 3.5-1 to 3.5-5 and 3.5-9 to 3.5-13. What differs between
// the systems is data; a message is of one or two carriers, and extended or not.

struct LegacyForm {
  unsigned time_bits;
  unsigned channel_bits;  ///< 0: no channel.
  unsigned range_bits;    ///< L1 pseudorange in steps of 0.02 m, modulo `modulus_m`.
  unsigned modulus_bits;
  double modulus_m;  ///< Modulus of the pseudorange, m.
};
constexpr LegacyForm kGps{30, 0, 24, 8, legacy_modulus_m(false)};
constexpr LegacyForm kGlonass{27, 5, 25, 7, legacy_modulus_m(true)};
const LegacyForm& form_of(const LegacyObservations& p) {
  return p.glonass ? kGlonass : kGps;
}

constexpr double kRangeStep_m = 0.02;
constexpr double kPhaseStep_m = 0.0005;
constexpr double kCn0Step = 0.25;
constexpr unsigned kPhaseBits = 20;
constexpr unsigned kSecondRangeBits = 14;
constexpr std::int64_t kNoPhase = -(1 << (kPhaseBits - 1));
constexpr std::int64_t kNoSecondRange = -(1 << (kSecondRangeBits - 1));

/// A signed count of `step`; `none` where there is no value or it does not fit.
std::int64_t count_or(std::optional<double> value, double step, std::int64_t none) {
  if (!value || !(std::abs(*value / step) < static_cast<double>(-none))) {
    return none;
  }
  return std::llround(*value / step);
}
std::optional<double> value_of(std::int64_t count, double step, std::int64_t none) {
  return count == none ? std::nullopt : std::optional(static_cast<double>(count) * step);
}

template <class Bits>
void walk_lock(Bits& bits, std::uint32_t& lock) {
  bits.whole(7, lock);
}

/// Reads one satellite of 1001 to 1004 or 1009 to 1012. The message splits the L1 pseudorange into
/// a multiple of the modulus and a remainder; all other ranges and phases are differences from it.
/// Without the multiple (messages that are not extended) the remainder is the range.
LegacyObservations::Satellite read_satellite(BitReader& bits, const LegacyObservations& p) {
  const LegacyForm& form = form_of(p);
  LegacyObservations::Satellite s;
  std::int64_t channel = 0;
  std::int64_t phase = 0;
  std::int64_t second_range = 0;
  std::int64_t second_phase = 0;
  double within_m = 0.0;
  std::uint32_t lock = 0;
  std::uint32_t modulus = 0;
  bits.whole(6, s.number);
  bits.flag(s.first_precise);
  if (form.channel_bits > 0) {
    bits.whole(form.channel_bits, channel);
    s.channel = static_cast<std::int8_t>(channel - kChannelOffset);
  }
  bits.scaled(form.range_bits, Sign::none, kRangeStep_m, within_m);
  bits.count(kPhaseBits, phase);
  walk_lock(bits, lock);
  s.first.locked_s = legacy_lock_s(lock);
  if (p.extended) {
    bits.whole(form.modulus_bits, modulus);
    bits.scaled(8, Sign::none, kCn0Step, s.first.cn0_dbhz);
  }
  const double range_m = modulus * form.modulus_m + within_m;
  s.first.range_m = range_m;
  const auto from_range = [&](std::optional<double> difference_m) {
    return difference_m ? std::optional(range_m + *difference_m) : std::nullopt;
  };
  s.first.phase_m = from_range(value_of(phase, kPhaseStep_m, kNoPhase));
  if (!p.second_band) {
    return s;
  }

  bits.whole(2, s.second_code);
  bits.count(kSecondRangeBits, second_range);
  bits.count(kPhaseBits, second_phase);
  walk_lock(bits, lock);
  s.second.locked_s = legacy_lock_s(lock);
  if (p.extended) {
    bits.scaled(8, Sign::none, kCn0Step, s.second.cn0_dbhz);
  }
  s.second.range_m = from_range(value_of(second_range, kRangeStep_m, kNoSecondRange));
  s.second.phase_m = from_range(value_of(second_phase, kPhaseStep_m, kNoPhase));
  return s;
}

void write_satellite(BitWriter& bits, const LegacyObservations::Satellite& s,
                     const LegacyObservations& p) {
  const LegacyForm& form = form_of(p);
  const double range_m = *s.first.range_m;
  auto modulus = static_cast<std::uint32_t>(std::floor(range_m / form.modulus_m));
  std::int64_t within =
      nearest_count(range_m - modulus * form.modulus_m, kRangeStep_m, form.range_bits, Sign::none);
  // Just below a whole modulus the nearest step is above it: that is the next one's beginning.
  if (static_cast<double>(within) * kRangeStep_m >= form.modulus_m &&
      modulus + 1 < 1U << form.modulus_bits) {
    ++modulus;
    within = 0;
  }
  // The range that a decoder finds; the other values are coded relative to it.
  const double told_m = modulus * form.modulus_m + static_cast<double>(within) * kRangeStep_m;
  const auto beyond = [&](std::optional<double> value_m) {
    return value_m ? std::optional(*value_m - told_m) : std::nullopt;
  };
  bits.whole(6, s.number);
  bits.flag(s.first_precise);
  if (form.channel_bits > 0) {
    bits.whole(form.channel_bits, s.channel + kChannelOffset);
  }
  bits.whole(form.range_bits, within);
  bits.count(kPhaseBits, count_or(beyond(s.first.phase_m), kPhaseStep_m, kNoPhase));
  bits.whole(7, legacy_lock_count(s.first.locked_s));
  if (p.extended) {
    bits.whole(form.modulus_bits, modulus);
    bits.scaled(8, Sign::none, kCn0Step, s.first.cn0_dbhz);
  }
  if (!p.second_band) {
    return;
  }
  bits.whole(2, s.second_code);
  bits.count(kSecondRangeBits, count_or(beyond(s.second.range_m), kRangeStep_m, kNoSecondRange));
  bits.count(kPhaseBits, count_or(beyond(s.second.phase_m), kPhaseStep_m, kNoPhase));
  bits.whole(7, legacy_lock_count(s.second.locked_s));
  if (p.extended) {
    bits.scaled(8, Sign::none, kCn0Step, s.second.cn0_dbhz);
  }
}

/// A range that its message can carry.
bool can_be_told(const LegacyObservations::Satellite& s, const LegacyForm& form) {
  return s.first.range_m && *s.first.range_m >= 0.0 &&
         *s.first.range_m < std::ldexp(form.modulus_m, static_cast<int>(form.modulus_bits));
}

template <class Bits, class Record>
void walk_head(Bits& bits, Record& p, const LegacyForm& form, std::size_t& count) {
  bits.whole(kStationBits, p.station);
  bits.whole(form.time_bits, p.time_ms);
  bits.flag(p.more);
  bits.whole(5, count);
  bits.flag(p.divergence_free);
  bits.whole(3, p.smoothing);
}

void read_legacy(BitReader& bits, LegacyObservations& p) {
  walk_head(bits, p, form_of(p), p.count);
  for (std::size_t i = 0; i < p.count && !bits.short_of(); ++i) {
    p.satellites[i] = read_satellite(bits, p);
  }
}

void write(BitWriter& bits, const LegacyObservations& p) {
  const LegacyForm& form = form_of(p);
  const auto satellites = std::span(p.satellites).first(p.count);
  auto told = static_cast<std::size_t>(
      std::ranges::count_if(satellites, [&](const auto& s) { return can_be_told(s, form); }));
  walk_head(bits, p, form, told);
  for (const LegacyObservations::Satellite& s : satellites) {
    if (can_be_told(s, form)) {
      write_satellite(bits, s, p);
    }
  }
}

void write(BitWriter& bits, const GlonassBiases& p) {
  walk_biases(bits, p);
}
void write(BitWriter& bits, const StationDescriptors& p) {
  walk_descriptors(bits, p);
}
void write(BitWriter& bits, const MovingBase& p) {
  walk_moving(bits, p);
}
void write(BitWriter& bits, const MultipleSignals& p) {
  write_multiple_signals(bits, p);
}

constexpr std::uint16_t kPosition = 1005;
constexpr std::uint16_t kPositionAndHeight = 1006;
constexpr std::uint16_t kGpsLegacy = 1001;
constexpr std::uint16_t kGlonassLegacy = 1009;
constexpr std::uint16_t kLegacyExtended = 1;  // added to these
constexpr std::uint16_t kLegacySecondBand = 2;
constexpr std::uint16_t kDescriptors = 1033;
constexpr std::uint16_t kBiases = 1230;
constexpr std::uint16_t kProprietary = 4072;

/// Nothing: another message.
std::optional<LegacyObservations> legacy_of(std::uint16_t number) {
  for (const bool glonass : {false, true}) {
    const int kind = number - (glonass ? kGlonassLegacy : kGpsLegacy);
    if (kind >= 0 && kind <= kLegacyExtended + kLegacySecondBand) {
      LegacyObservations p;
      p.glonass = glonass;
      p.extended = (kind & kLegacyExtended) != 0;
      p.second_band = (kind & kLegacySecondBand) != 0;
      return p;
    }
  }
  return std::nullopt;
}

}  // namespace

StationDescriptors::Text::Text(std::string_view text)
    : size(static_cast<std::uint8_t>(std::min(text.size(), kGreatest))) {
  std::ranges::copy(text.substr(0, size), characters.begin());
}

std::uint16_t number_of(const Message& message) {
  struct Number {
    std::uint16_t operator()(const AntennaPosition& p) const {
      return p.antenna_height_m ? kPositionAndHeight : kPosition;
    }
    std::uint16_t operator()(const GlonassBiases& /*p*/) const { return kBiases; }
    std::uint16_t operator()(const StationDescriptors& /*p*/) const { return kDescriptors; }
    std::uint16_t operator()(const LegacyObservations& p) const {
      return static_cast<std::uint16_t>((p.glonass ? kGlonassLegacy : kGpsLegacy) +
                                        (p.extended ? kLegacyExtended : 0) +
                                        (p.second_band ? kLegacySecondBand : 0));
    }
    std::uint16_t operator()(const MultipleSignals& p) const {
      return number_of_multiple_signals(p.system, p.form);
    }
    std::uint16_t operator()(const MovingBase& /*p*/) const { return kProprietary; }
  };
  return std::visit(Number{}, message);
}

Decoded<Message> decode_message(std::span<const std::uint8_t> payload) {
  BitReader bits(payload);
  std::uint16_t number = 0;
  bits.whole(kNumberBits, number);
  std::optional<Message> message;
  switch (number) {
    case kPosition:
    case kPositionAndHeight:
      message = read_position(bits, number == kPositionAndHeight);
      break;
    case kDescriptors:
      if (!read_descriptors(bits, message.emplace().emplace<StationDescriptors>())) {
        return Malformed{"RTCM 3 text of at most 31 characters", kNumberBits / 8};
      }
      break;
    case kBiases:
      walk_biases(bits, message.emplace().emplace<GlonassBiases>());
      break;
    case kProprietary: {
      constexpr std::size_t kOurs = 26;  // 12 + 12 + 12 + 30 + 3 * 38 + 3 * 19 bits
      if (FrameView{payload}.second_field() != 0 || payload.size() < 3 ||
          payload.size() > kOurs + 4) {
        return Malformed{"RTCM 3 message 4072 in our form", 0};
      }
      walk_moving(bits, message.emplace().emplace<MovingBase>());
      break;
    }
    default:
      if (const auto legacy = legacy_of(number)) {
        read_legacy(bits, message.emplace().emplace<LegacyObservations>(*legacy));
        break;
      }
      if (const auto form = multiple_signals_of(number)) {
        auto& signals = message.emplace().emplace<MultipleSignals>();
        signals.system = form->system;
        signals.form = form->form;
        if (!read_multiple_signals(bits, signals)) {
          return Malformed{"RTCM 3 masks of satellites and signals", kNumberBits / 8};
        }
        break;
      }
      return Malformed{"RTCM 3 message that is decoded", 0};
  }
  if (bits.short_of()) {
    return Malformed{"RTCM 3 message of full length", payload.size()};
  }
  return {*message, bits.bytes()};
}

std::size_t encode(const Message& message, std::span<std::uint8_t> out) {
  BitWriter bits;
  bits.whole(kNumberBits, number_of(message));
  std::visit([&](const auto& p) { write(bits, p); }, message);
  return encode_frame(bits.bytes(), out);
}

// Lock times: RTCM 10403.3 tables 3.4-2 (DF013), 3.5-74 (DF402), 3.5-75 (DF407).

namespace {

/// Counts of DF013: from each on, seconds per count.
struct LockRange {
  std::uint32_t from;
  std::uint32_t step_s;
  std::int32_t offset_s;  ///< seconds = step * count - offset
};
constexpr std::array<LockRange, 6> kLegacyLocks{
    {{0, 1, 0}, {24, 2, 24}, {48, 4, 120}, {72, 8, 408}, {96, 16, 1176}, {120, 32, 3096}}};
constexpr std::uint32_t kLegacyGreatest = 127;

/// Returns the highest count whose time is not above `locked_s`, by bisection: times grow with
/// counts.
template <class Time>
std::uint32_t greatest_count(double locked_s, std::uint32_t greatest, Time time_of) {
  std::uint32_t low = 0;
  std::uint32_t high = greatest;
  while (low < high) {
    const std::uint32_t middle = (low + high + 1) / 2;
    if (time_of(middle) <= locked_s) {
      low = middle;
    } else {
      high = middle - 1;
    }
  }
  return low;
}

}  // namespace

double legacy_lock_s(std::uint32_t count) {
  count = std::min(count, kLegacyGreatest);
  constexpr double kLongest_s = 937.0;
  if (count == kLegacyGreatest) {
    return kLongest_s;
  }
  const auto* range = kLegacyLocks.begin();
  while (range + 1 != kLegacyLocks.end() && (range + 1)->from <= count) {
    ++range;
  }
  return static_cast<double>(range->step_s * count) - range->offset_s;
}
std::uint32_t legacy_lock_count(double locked_s) {
  return greatest_count(locked_s, kLegacyGreatest, legacy_lock_s);
}

double msm4_lock_s(std::uint32_t count) {
  constexpr double kFirst_s = 0.032;
  count = std::min(count, std::uint32_t{15});
  return count == 0 ? 0.0 : std::ldexp(kFirst_s, static_cast<int>(count) - 1);
}
std::uint32_t msm4_lock_count(double locked_s) {
  return greatest_count(locked_s, 15, msm4_lock_s);
}

double msm7_lock_s(std::uint32_t count) {
  constexpr std::uint32_t kGreatest = 704;
  constexpr std::uint32_t kBlock = 32;
  count = std::min(count, kGreatest);
  // 64 counts of 1 ms, then blocks of 32 whose step doubles; the last count is alone.
  const int block = count < 2 * kBlock ? 0 : static_cast<int>(count / kBlock) - 1;
  const double ms =
      std::ldexp(static_cast<double>(count) - static_cast<double>(block) * kBlock, block);
  return ms * 1e-3;
}
std::uint32_t msm7_lock_count(double locked_s) {
  return greatest_count(locked_s, 704, msm7_lock_s);
}

// Epochs of the systems.

namespace {

constexpr std::int64_t kDay_ms = 86'400'000;
constexpr std::int64_t kWeek_ms = 7 * kDay_ms;
constexpr std::int64_t kBeidouBehind_ms = 14'000;
constexpr std::int64_t kMoscow_ms = 3 * 3'600'000;
constexpr unsigned kDayShift = 27;
constexpr std::uint32_t kNoDay = 7;

std::uint32_t of_week(std::int64_t ms) {
  return static_cast<std::uint32_t>((ms % kWeek_ms + kWeek_ms) % kWeek_ms);
}

}  // namespace

std::uint32_t msm_epoch(MsmSystem system, std::uint32_t gps_time_of_week_ms, int leap_seconds) {
  const std::int64_t gps = gps_time_of_week_ms;
  switch (system) {
    case MsmSystem::gps:
    case MsmSystem::galileo:
      break;
    case MsmSystem::beidou:
      return of_week(gps - kBeidouBehind_ms);
    case MsmSystem::glonass: {
      const std::int64_t moscow = of_week(gps - std::int64_t{leap_seconds} * 1000 + kMoscow_ms);
      return static_cast<std::uint32_t>(moscow / kDay_ms) << kDayShift |
             static_cast<std::uint32_t>(moscow % kDay_ms);
    }
  }
  return gps_time_of_week_ms;
}

std::optional<std::uint32_t> gps_time_of_week_ms(MsmSystem system, std::uint32_t epoch,
                                                 int leap_seconds) {
  if (system == MsmSystem::glonass) {
    const std::uint32_t day = epoch >> kDayShift;
    const std::int64_t of_day = epoch & ((1U << kDayShift) - 1U);
    if (day == kNoDay || of_day > kDay_ms) {  // a leap second may be counted
      return std::nullopt;
    }
    return of_week(day * kDay_ms + of_day - kMoscow_ms + std::int64_t{leap_seconds} * 1000);
  }
  if (epoch >= kWeek_ms) {
    return std::nullopt;
  }
  return system == MsmSystem::beidou ? of_week(std::int64_t{epoch} + kBeidouBehind_ms) : epoch;
}

}  // namespace rigwire::protocols::rtcm3
