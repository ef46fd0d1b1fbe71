#include "protocols/rtcm3/multiple_signals.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace rigwire::protocols::rtcm3 {
namespace {

/// In the order of MsmSystem.
constexpr std::array<std::uint16_t, 4> kBases{1070, 1080, 1090, 1120};

// What the forms differ in, RTCM 10403.3 tables 3.5-80 to 3.5-88 and the fields they name.
struct Width {
  unsigned bits;
  double step;  ///< For ranges in light milliseconds.

  [[nodiscard]] std::int64_t none() const { return -(std::int64_t{1} << (bits - 1)); }
};
struct Form {
  Width range;
  Width phase;
  unsigned lock_bits;
  Width cn0;
  std::uint32_t (*lock_count)(double);
  double (*lock_s)(std::uint32_t);
  bool rates;  ///< And with them what else is said of a satellite.
};
constexpr Form kForm4{{15, 0x1p-24},   {22, 0x1p-29}, 4,    {6, 1.0},
                      msm4_lock_count, msm4_lock_s,   false};
constexpr Form kForm5{{15, 0x1p-24},   {22, 0x1p-29}, 4,   {6, 1.0},
                      msm4_lock_count, msm4_lock_s,   true};
constexpr Form kForm7{{20, 0x1p-29},   {24, 0x1p-31}, 10,  {10, 0x1p-4},
                      msm7_lock_count, msm7_lock_s,   true};
constexpr Width kRoughRate{14, 1.0};
constexpr Width kFineRate{15, 1e-4};

constexpr std::uint32_t kNoRoughRange = 255;
constexpr unsigned kRoughFraction = 1024;  ///< Rough ranges count 2^-10 ms.
constexpr std::uint8_t kNoChannel = 15;

/// Values that occur once for each satellite.
struct Rough {
  std::uint8_t satellite = 0;
  std::uint32_t range_ms = kNoRoughRange;
  std::uint32_t fraction = 0;
  std::uint8_t extended = 0;
  std::int64_t rate_mps = kRoughRate.none();

  [[nodiscard]] bool has_range() const { return range_ms != kNoRoughRange; }
  [[nodiscard]] double range() const {
    return range_ms + static_cast<double>(fraction) / kRoughFraction;
  }
  [[nodiscard]] bool has_rate() const { return rate_mps != kRoughRate.none(); }
};

/// Values that occur once for each cell.
struct Fine {
  std::int64_t range = 0;
  std::int64_t phase = 0;
  std::uint32_t lock = 0;
  bool half_cycle = false;
  double cn0_dbhz = 0.0;
  std::int64_t rate = 0;
};

template <class Bits, class Record>
void walk_head(Bits& bits, Record& p) {
  bits.whole(12, p.station);
  bits.whole(30, p.epoch);
  bits.flag(p.more);
  bits.whole(3, p.issue);
  bits.spare(7);
  bits.whole(2, p.clock_steering);
  bits.whole(2, p.external_clock);
  bits.flag(p.divergence_free);
  bits.whole(3, p.smoothing);
}

/// Each field for all satellites, then the next one.
template <class Bits, class RoughSpan>
void walk_rough(Bits& bits, RoughSpan rough, bool rates) {
  for (auto& r : rough) bits.whole(8, r.range_ms);
  for (auto& r : rough) {
    if (rates) bits.whole(4, r.extended);
  }
  for (auto& r : rough) bits.whole(10, r.fraction);
  for (auto& r : rough) {
    if (rates) bits.count(kRoughRate.bits, r.rate_mps);
  }
}

template <class Bits, class FineSpan>
void walk_fine(Bits& bits, FineSpan fine, const Form& form) {
  for (auto& f : fine) bits.count(form.range.bits, f.range);
  for (auto& f : fine) bits.count(form.phase.bits, f.phase);
  for (auto& f : fine) bits.whole(form.lock_bits, f.lock);
  for (auto& f : fine) bits.flag(f.half_cycle);
  for (auto& f : fine) bits.scaled(form.cn0.bits, Sign::none, form.cn0.step, f.cn0_dbhz);
  for (auto& f : fine) {
    if (form.rates) bits.count(kFineRate.bits, f.rate);
  }
}

const Form& form_of(const MultipleSignals& p) {
  return p.form == MsmForm::seven ? kForm7 : p.form == MsmForm::five ? kForm5 : kForm4;
}

std::int64_t count_of(std::optional<double> value, const Width& width) {
  if (!value || !(std::abs(*value / width.step) < static_cast<double>(-width.none()))) {
    return width.none();
  }
  return std::llround(*value / width.step);
}

/// The value against the rough one, in `unit`s; nothing where either is missing.
std::optional<double> against(std::optional<double> value, bool has_rough, double rough,
                              double unit) {
  return value && has_rough ? std::optional(*value / unit - rough) : std::nullopt;
}
/// Back again.
std::optional<double> put_together(std::int64_t count, const Width& width, bool has_rough,
                                   double rough, double unit) {
  return count == width.none() || !has_rough
             ? std::nullopt
             : std::optional((rough + static_cast<double>(count) * width.step) * unit);
}

Fine fine_of(const SignalObservation& o, const Rough& rough, const Form& form) {
  Fine fine;
  fine.range = count_of(against(o.range_m, rough.has_range(), rough.range(), kLightMillisecond_m),
                        form.range);
  fine.phase = count_of(against(o.phase_m, rough.has_range(), rough.range(), kLightMillisecond_m),
                        form.phase);
  fine.lock = form.lock_count(o.locked_s);
  fine.half_cycle = o.half_cycle;
  fine.cn0_dbhz = o.cn0_dbhz;
  fine.rate = count_of(
      against(o.rate_mps, rough.has_rate(), static_cast<double>(rough.rate_mps), 1.0), kFineRate);
  return fine;
}

SignalObservation observation_of(const Fine& fine, const Rough& rough, const Form& form) {
  SignalObservation o;
  o.range_m =
      put_together(fine.range, form.range, rough.has_range(), rough.range(), kLightMillisecond_m);
  o.phase_m =
      put_together(fine.phase, form.phase, rough.has_range(), rough.range(), kLightMillisecond_m);
  o.locked_s = form.lock_s(fine.lock);
  o.half_cycle = fine.half_cycle;
  o.cn0_dbhz = fine.cn0_dbhz;
  if (form.rates) {
    o.rate_mps = put_together(fine.rate, kFineRate, rough.has_rate(),
                              static_cast<double>(rough.rate_mps), 1.0);
  }
  return o;
}

/// Rough range and rate by the satellite's first cell that has them.
Rough rough_of(std::uint8_t satellite, const MultipleSignals& p) {
  Rough rough;
  rough.satellite = satellite;
  for (const auto& cell : std::span(p.cells).first(p.count)) {
    if (cell.satellite != satellite) {
      continue;
    }
    const SignalObservation& o = cell.observation;
    const std::optional<double> range_m = o.range_m ? o.range_m : o.phase_m;
    const double fractions =
        range_m ? std::round(*range_m / kLightMillisecond_m * kRoughFraction) : -1.0;
    if (!rough.has_range() && fractions >= 0.0 &&
        fractions < static_cast<double>(kNoRoughRange) * kRoughFraction) {
      const auto whole = static_cast<std::uint32_t>(fractions);
      rough.range_ms = whole / kRoughFraction;
      rough.fraction = whole % kRoughFraction;
    }
    if (!rough.has_rate()) {
      rough.rate_mps = count_of(o.rate_mps, kRoughRate);
    }
  }
  if (form_of(p).rates && p.system == MsmSystem::glonass) {
    const auto channel = p.channels[satellite - 1U];
    rough.extended = channel ? static_cast<std::uint8_t>(*channel + kChannelOffset) : kNoChannel;
  }
  return rough;
}

/// Numbers from 1 of the bits of a mask, first bit first.
template <class Number>
std::size_t listed(std::uint64_t mask, unsigned bits, std::span<Number> out) {
  std::size_t count = 0;
  for (unsigned i = 0; i < bits; ++i) {
    if ((mask >> (bits - 1U - i) & 1U) != 0) {
      out[count++] = static_cast<Number>(i + 1U);
    }
  }
  return count;
}
constexpr unsigned kSatelliteBits = 64;
constexpr unsigned kSignalBits = 32;

std::uint64_t bit_of(unsigned number, unsigned bits) {
  return std::uint64_t{1} << (bits - number);
}

}  // namespace

std::uint16_t number_of_multiple_signals(MsmSystem system, MsmForm form) {
  return static_cast<std::uint16_t>(kBases[static_cast<std::size_t>(system)] +
                                    static_cast<std::uint16_t>(form));
}

std::optional<MultipleSignalsForm> multiple_signals_of(std::uint16_t number) {
  for (std::size_t i = 0; i < kBases.size(); ++i) {
    for (const MsmForm form : {MsmForm::four, MsmForm::five, MsmForm::seven}) {
      if (number == number_of_multiple_signals(static_cast<MsmSystem>(i), form)) {
        return MultipleSignalsForm{static_cast<MsmSystem>(i), form};
      }
    }
  }
  return std::nullopt;
}

bool read_multiple_signals(BitReader& bits, MultipleSignals& p) {
  std::uint64_t satellite_mask = 0;
  std::uint64_t signal_mask = 0;
  walk_head(bits, p);
  bits.whole(kSatelliteBits, satellite_mask);
  bits.whole(kSignalBits, signal_mask);
  std::array<std::uint8_t, kSatelliteBits> satellites{};
  std::array<std::uint8_t, kSignalBits> signals{};
  const std::size_t satellite_count =
      listed<std::uint8_t>(satellite_mask, kSatelliteBits, satellites);
  const std::size_t signal_count = listed<std::uint8_t>(signal_mask, kSignalBits, signals);
  if (satellite_count * signal_count > MultipleSignals::kGreatest) {
    return false;
  }
  std::array<std::size_t, MultipleSignals::kGreatest> row{};  // of the satellite, by cell
  for (std::size_t i = 0; i < satellite_count; ++i) {
    for (std::size_t k = 0; k < signal_count; ++k) {
      bool there = false;
      bits.flag(there);
      if (there) {
        row[p.count] = i;
        p.cells[p.count++] = {satellites[i], signals[k], {}};
      }
    }
  }
  std::array<Rough, kSatelliteBits> rough{};
  walk_rough(bits, std::span(rough).first(satellite_count), form_of(p).rates);
  std::array<Fine, MultipleSignals::kGreatest> fine{};
  walk_fine(bits, std::span(fine).first(p.count), form_of(p));
  for (std::size_t i = 0; i < p.count; ++i) {
    p.cells[i].observation = observation_of(fine[i], rough[row[i]], form_of(p));
  }
  const bool channels = form_of(p).rates && p.system == MsmSystem::glonass;
  for (std::size_t i = 0; channels && i < satellite_count; ++i) {
    if (rough[i].extended <= 2 * kChannelOffset) {
      p.channels[satellites[i] - 1U] = static_cast<std::int8_t>(rough[i].extended - kChannelOffset);
    }
  }
  return true;
}

void write_multiple_signals(BitWriter& bits, const MultipleSignals& p) {
  const auto cells = std::span(p.cells).first(p.count);
  std::uint64_t satellite_mask = 0;
  std::uint64_t signal_mask = 0;
  for (const auto& cell : cells) {
    satellite_mask |= bit_of(cell.satellite, kSatelliteBits);
    signal_mask |= bit_of(cell.signal, kSignalBits);
  }
  const auto signal_count = static_cast<std::size_t>(std::popcount(signal_mask));
  while (static_cast<std::size_t>(std::popcount(satellite_mask)) * signal_count >
         MultipleSignals::kGreatest) {
    satellite_mask &= satellite_mask - 1;  // its last satellite
  }
  walk_head(bits, p);
  bits.whole(kSatelliteBits, satellite_mask);
  bits.whole(kSignalBits, signal_mask);
  std::array<std::uint8_t, kSatelliteBits> satellites{};
  std::array<std::uint8_t, kSignalBits> signals{};
  const std::size_t satellite_count =
      listed<std::uint8_t>(satellite_mask, kSatelliteBits, satellites);
  listed<std::uint8_t>(signal_mask, kSignalBits, signals);

  std::array<Rough, kSatelliteBits> rough{};
  std::array<Fine, MultipleSignals::kGreatest> fine{};
  std::size_t count = 0;
  for (std::size_t i = 0; i < satellite_count; ++i) {
    rough[i] = rough_of(satellites[i], p);
    for (std::size_t k = 0; k < signal_count; ++k) {
      const auto found = std::ranges::find_if(cells, [&](const auto& cell) {
        return cell.satellite == satellites[i] && cell.signal == signals[k];
      });
      bits.flag(found != cells.end());
      if (found != cells.end()) {
        fine[count++] = fine_of(found->observation, rough[i], form_of(p));
      }
    }
  }
  walk_rough(bits, std::span<const Rough>(rough).first(satellite_count), form_of(p).rates);
  walk_fine(bits, std::span<const Fine>(fine).first(count), form_of(p));
}

}  // namespace rigwire::protocols::rtcm3
