#include "emulators/ublox/correction_output.h"

#include <algorithm>

#include "emulators/ublox/correction_signals.h"
#include "fields/constants.h"
#include "protocols/rtcm3/message.h"

namespace rigwire::emulators {
namespace {

namespace rtcm3 = protocols::rtcm3;

/// Rows of CFG-MSG: id within the class, and the message.
struct Row {
  std::uint8_t id;
  std::uint16_t number;
};
constexpr std::array<Row, 12> kRows{{{0x05, 1005},
                                     {0x4A, 1074},
                                     {0x4D, 1077},
                                     {0x54, 1084},
                                     {0x57, 1087},
                                     {0x5E, 1094},
                                     {0x61, 1097},
                                     {0x7C, 1124},
                                     {0x7F, 1127},
                                     {0xE6, 1230},
                                     {0xFE, 4072},
                                     {0xFD, 4072}}};
constexpr std::uint8_t kTimingOf4072 = 0xFD;  // 4072.1 is not published, and not sent

struct Observed {
  rtcm3::MsmSystem system;
  rtcm3::MsmForm form;
};
std::optional<Observed> observed(std::uint16_t number) {
  constexpr std::array<std::uint16_t, 4> kBases{1070, 1080, 1090, 1120};
  for (std::size_t i = 0; i < kBases.size(); ++i) {
    for (const rtcm3::MsmForm form : {rtcm3::MsmForm::four, rtcm3::MsmForm::seven}) {
      if (number == kBases[i] + static_cast<int>(form)) {
        return Observed{static_cast<rtcm3::MsmSystem>(i), form};
      }
    }
  }
  return std::nullopt;
}

const UbloxCorrectionSignal* signal_of(const GnssMeasurement& m, rtcm3::MsmSystem system) {
  const auto* const found =
      std::ranges::find_if(kCorrectionSignals, [&](const UbloxCorrectionSignal& s) {
        return s.message == system && s.system == m.system && s.second == m.second;
      });
  return found == kCorrectionSignals.end() ? nullptr : found;
}

rtcm3::MultipleSignals signals(const UbloxCorrectionContent& content, const Observed& wanted,
                               bool more) {
  rtcm3::MultipleSignals p;
  p.system = wanted.system;
  p.form = wanted.form;
  p.station = content.station;
  p.epoch = rtcm3::msm_epoch(
      p.system, static_cast<std::uint32_t>(content.measured.time_of_week_ns / kMillisecond_ns),
      content.leap_seconds);
  p.more = more;
  constexpr Duration kHalfCycleResolved = std::chrono::seconds{8};  // as RXM-RAWX has it
  for (const GnssMeasurement& m : content.sample->measurements) {
    const UbloxCorrectionSignal* const signal = signal_of(m, p.system);
    if (signal == nullptr || p.count == p.cells.size()) {
      continue;
    }
    const double wave_m = *wavelength_m(*signal, m.channel);
    if (m.system == GnssSystem::glonass) {
      p.channels[m.number - 1U] = m.channel;
    }
    p.cells[p.count++] = {m.number,
                          signal->sent,
                          {.range_m = m.pseudorange_m,
                           .phase_m = m.carrier_phase_cycles * wave_m,
                           .rate_mps = -m.doppler_hz * wave_m,
                           .locked_s = to_seconds(m.locked),
                           .half_cycle = m.locked < kHalfCycleResolved,
                           .cn0_dbhz = m.cn0_dbhz}};
  }
  return p;
}

}  // namespace

std::uint16_t correction_number(protocols::ubx::MessageId id) {
  const auto* const found = std::ranges::find(kRows, id.message_id, &Row::id);
  return id.message_class != kClassRtcm3 || found == kRows.end() ? std::uint16_t{0} : found->number;
}

bool is_observation(protocols::ubx::MessageId id) {
  return observed(correction_number(id)).has_value();
}

bool has_correction(const UbloxCorrectionContent& content, protocols::ubx::MessageId id) {
  if (content.sample == nullptr || id.message_id == kTimingOf4072) {
    return false;
  }
  const std::uint16_t number = correction_number(id);
  if (const auto wanted = observed(number)) {
    return std::ranges::any_of(content.sample->measurements, [&](const GnssMeasurement& m) {
      return signal_of(m, wanted->system) != nullptr;
    });
  }
  constexpr std::uint16_t kPlace = 1005;
  constexpr std::uint16_t kBiases = 1230;
  return number == kPlace ? content.place_E_m.has_value() : number == kBiases || content.has_fix;
}

std::size_t encode_correction(const UbloxCorrectionContent& content, protocols::ubx::MessageId id,
                              bool more, std::span<std::uint8_t> out) {
  if (!has_correction(content, id)) {
    return 0;
  }
  const std::uint16_t number = correction_number(id);
  if (const auto wanted = observed(number)) {
    return rtcm3::encode(signals(content, *wanted, more), out);
  }
  switch (number) {
    case 1005: {
      rtcm3::AntennaPosition p;
      p.station = content.station;
      p.position_m = *content.place_E_m;
      return rtcm3::encode(p, out);
    }
    case 1230:  // no bias is known: a mask of zeros, as a ZED-F9T sends
      return rtcm3::encode(rtcm3::GlonassBiases{.station = content.station, .aligned = false}, out);
    default: {
      return rtcm3::encode(
          rtcm3::MovingBase{
              content.station,
              static_cast<std::uint32_t>(content.measured.time_of_week_ns / kMillisecond_ns),
              content.position_E_m, content.velocity_E_mps},
          out);
    }
  }
}

}  // namespace rigwire::emulators
