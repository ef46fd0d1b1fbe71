#include "emulators/velodyne/unit_report.h"

#include <array>
#include <charconv>
#include <cstddef>
#include <string_view>
#include <utility>

namespace rigwire::emulators {
namespace {

namespace velodyne = protocols::velodyne;
using velodyne::StatusEchoes;
using velodyne::StatusGps;

velodyne::StatusRecord first_record(const velodyne::Model& model,
                                    const velodyne::Hdl64eCalibration& calibration) {
  velodyne::StatusRecord record;
  record.format = model.dual_return ? velodyne::StatusFormat::s3 : velodyne::StatusFormat::s2;
  record.calibration = calibration;
  return record;
}

/// What cannot be read stays zero.
std::array<std::uint8_t, 4> address_bytes(std::string_view text) {
  std::array<std::uint8_t, 4> bytes{};
  const char* at = text.data();
  const char* const end = text.data() + text.size();
  for (std::uint8_t& byte : bytes) {
    const auto [next, error] = std::from_chars(at, end, byte);
    if (error != std::errc{}) {
      return {};
    }
    at = next == end ? end : next + 1;
  }
  return bytes;
}

StatusGps gps_state(bool pulse, bool sentence) {
  if (pulse) {
    return sentence ? StatusGps::pulse_and_sentence : StatusGps::pulse;
  }
  return sentence ? StatusGps::sentence : StatusGps::none;
}

}  // namespace

std::optional<velodyne::Hdl64eCalibration> unit_calibration(const VelodyneSettings& settings,
                                                            const velodyne::Model& model) {
  if (!model.status_channel) {
    return std::nullopt;
  }
  return velodyne::as_sent(settings.calibration ? *settings.calibration
                                                : velodyne::nominal_calibration(model));
}

UnitReport::UnitReport(const velodyne::Model& model, const velodyne::Hdl64eCalibration& calibration,
                       const VelodyneLiveSettings& live)
    : record_(first_record(model, calibration)), channel_(record_) {
  settings_changed(live);
}

void UnitReport::settings_changed(const VelodyneLiveSettings& live) {
  fill(live);
  channel_.update(record_);
}

void UnitReport::fill(const VelodyneLiveSettings& live) {
  record_.motor_rpm = static_cast<std::int16_t>(live.rotor_rpm);
  record_.view_start_centideg = static_cast<std::uint16_t>(live.view_start_deg * 100);
  record_.view_end_centideg = static_cast<std::uint16_t>((live.view_end_deg + 1) * 100);
  record_.source = address_bytes(live.net_address);
  record_.destination = address_bytes(live.host_address);
  switch (live.return_mode) {
    case velodyne::ReturnMode::strongest:
      record_.echoes = StatusEchoes::strongest;
      break;
    case velodyne::ReturnMode::last:
      record_.echoes = StatusEchoes::last;
      break;
    case velodyne::ReturnMode::dual:
      record_.echoes = StatusEchoes::both;
      break;
  }
}

velodyne::StatusByte UnitReport::next(SimTime now, const TimeInput& input) {
  if (packets_ % velodyne::kStatusCycle == 0) {
    const bool pulse = input.state(now) != velodyne::PulseState::absent;
    const bool sentence = input.sentences_arrive(now);
    now_.gps = gps_state(pulse, sentence);
    if (const auto& time = input.said()) {
      now_.hour = static_cast<std::uint8_t>(time->hour);
      now_.minute = static_cast<std::uint8_t>(time->minute);
      now_.second = static_cast<std::uint8_t>(time->second);
      now_.day = static_cast<std::uint8_t>(time->day);
      now_.month = static_cast<std::uint8_t>(time->month);
      now_.year = static_cast<std::uint8_t>(time->year % 100);
    }
    const auto warnings = static_cast<std::uint8_t>((pulse ? velodyne::kPulsePresent : 0) |
                                                    (sentence ? velodyne::kGpsTimePresent : 0));
    if (warnings != record_.warnings) {
      record_.warnings = warnings;
      channel_.update(record_);
    }
  }
  return channel_.at(packets_++, now_);
}

}  // namespace rigwire::emulators
