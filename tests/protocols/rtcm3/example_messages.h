// Messages of a made-up reference station, for the codec's own tests and for other programs'.
#pragma once

#include <array>
#include <cmath>
#include <initializer_list>
#include <vector>

#include "protocols/rtcm3/message.h"

namespace rigwire::protocols::rtcm3 {

inline constexpr std::uint16_t kExampleStation = 2'003;
inline constexpr std::uint32_t kExampleTime_ms = 36'030'000;  // Sunday 10:00:30 GPS time
inline constexpr int kExampleLeapSeconds = 18;

/// Ranges of satellites that differ in every field; second signals a few metres off.
inline SignalObservation example_observation(int satellite, int signal) {
  const double range_m = 20'123'456.789 + 1'234'567.891 * satellite + 3.217 * signal;
  return {.range_m = range_m,
          .phase_m = range_m + 41.1234 - 7.3 * signal,
          .rate_mps = -512.3456 + 97.531 * satellite + 0.0021 * signal,
          .locked_s = 1.5 * satellite,
          .half_cycle = satellite % 2 == 0,
          .cn0_dbhz = 31.0 + satellite + 4.0 * signal};
}

inline constexpr std::array kForms{MsmForm::four, MsmForm::five, MsmForm::seven};

inline MultipleSignals example_signals(MsmSystem system, MsmForm form,
                                       std::initializer_list<std::uint8_t> signals) {
  MultipleSignals p;
  p.system = system;
  p.form = form;
  p.station = kExampleStation;
  p.epoch = msm_epoch(system, kExampleTime_ms, kExampleLeapSeconds);
  p.more = system != MsmSystem::beidou;
  for (const std::uint8_t satellite : std::to_array<std::uint8_t>({3, 7, 11, 14})) {
    int number = 0;
    for (const std::uint8_t signal : signals) {
      p.cells[p.count++] = {satellite, signal, example_observation(satellite, number++)};
    }
    if (system == MsmSystem::glonass && form != MsmForm::four) {
      p.channels[satellite - 1U] = static_cast<std::int8_t>(satellite % 13 - 6);
    }
  }
  return p;
}

inline std::vector<MultipleSignals> example_systems(MsmForm form) {
  using namespace msm_signal;
  return {example_signals(MsmSystem::gps, form, {kGps1C, kGps2L}),
          example_signals(MsmSystem::glonass, form, {kGlonass1C, kGlonass2C}),
          example_signals(MsmSystem::galileo, form, {kGalileo1C, kGalileo7Q}),
          example_signals(MsmSystem::beidou, form, {kBeidou2I, kBeidou7I})};
}

inline AntennaPosition example_position() {
  AntennaPosition p;
  p.station = kExampleStation;
  p.position_m = {4'139'423.1234, 550'210.9876, -4'804'002.0005};
  return p;
}

inline StationDescriptors example_descriptors() {
  StationDescriptors p;
  p.station = kExampleStation;
  p.antenna = StationDescriptors::Text("LEIAR25.R4      LEIT");
  p.set_up = 3;
  p.receiver = StationDescriptors::Text("LEICA GR50 ");
  p.firmware = StationDescriptors::Text("4.50");
  p.receiver_serial = StationDescriptors::Text("1830399");
  return p;
}

inline LegacyObservations example_legacy(bool glonass, bool second_band = true,
                                         bool extended = true) {
  LegacyObservations p;
  p.glonass = glonass;
  p.second_band = second_band;
  p.extended = extended;
  p.station = kExampleStation;
  p.time_ms = glonass ? kExampleTime_ms - 18'000 + 3 * 3'600'000 : kExampleTime_ms;
  p.more = !glonass;
  for (const std::uint8_t number : std::to_array<std::uint8_t>({5, 9, 21})) {
    auto& s = p.satellites[p.count++];
    s.number = number;
    s.channel = glonass ? static_cast<std::int8_t>(number % 13 - 6) : std::int8_t{0};
    s.first = example_observation(number % 16, 0);
    s.second = example_observation(number % 16, 1);
    for (SignalObservation* o : {&s.first, &s.second}) {
      o->rate_mps.reset();
      o->half_cycle = false;
    }
  }
  return p;
}

inline std::vector<std::uint8_t> framed(const Message& message) {
  std::vector<std::uint8_t> bytes(kGreatestFrame);
  bytes.resize(encode(message, bytes));
  return bytes;
}

}  // namespace rigwire::protocols::rtcm3
