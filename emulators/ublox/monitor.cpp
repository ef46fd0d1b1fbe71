#include "emulators/ublox/monitor.h"

#include <algorithm>
#include <cmath>

#include "emulators/random_bits.h"
#include "emulators/ublox/geodesy.h"
#include "emulators/ublox/wire_units.h"
#include "fields/constants.h"
#include "protocols/ubx/aiding.h"
#include "protocols/ubx/blocks.h"
#include "protocols/ubx/configuration.h"
#include "protocols/ubx/identity.h"
#include "protocols/ubx/monitor.h"
#include "protocols/ubx/signal_security.h"
#include "protocols/ubx/timing.h"
#include "sim/samples/gnss_carriers.h"

namespace rigwire::emulators {
namespace {

using namespace protocols::ubx;

constexpr std::size_t kUart = kPortUart1;
std::uint8_t percent(std::size_t part, std::size_t whole) {
  return static_cast<std::uint8_t>((part * 100 + whole - 1) / whole);
}

std::size_t put_ports(const UbloxMonitorView& view, std::span<std::uint8_t> out) {
  std::array<MonIoPort, kMonitorPorts> ports{};
  MonIoPort& uart = ports[kUart];
  uart.received_bytes = view.port.bytes;
  uart.sent_bytes = static_cast<std::uint32_t>(view.transmitter.bytes_sent());
  uart.framing_errors = view.port.framing_errors;
  uart.sending = view.transmitter.waiting() > 0 ? 1 : 0;
  return encode_blocks<MonIoHead, MonIoPort>(MonIoHead{}, ports, out);
}

MonMsgpp parsed(const UbloxMonitorView& view) {
  MonMsgpp m;
  std::ranges::copy(view.port.messages, m.messages.begin() + kUart * view.port.messages.size());
  m.skipped_bytes[kUart] = view.port.skipped;
  if (view.second_port != nullptr) {
    std::ranges::copy(view.second_port->messages,
                      m.messages.begin() + kPortUart2 * view.second_port->messages.size());
    m.skipped_bytes[kPortUart2] = view.second_port->skipped;
  }
  return m;
}

MonRxbuf receive_buffer(const UbloxMonitorView& view) {
  MonRxbuf m;
  m.peak_usage_percent[kUart] = percent(view.port.peak_bytes, view.receive_capacity);
  return m;
}

MonTxbuf transmit_buffer(const UbloxMonitorView& view) {
  const UbloxTransmitter& line = view.transmitter;
  MonTxbuf m;
  m.pending_bytes[kUart] = to_field<std::uint16_t>(static_cast<double>(line.waiting()), 1.0);
  m.usage_percent[kUart] = percent(line.waiting(), line.capacity());
  m.peak_usage_percent[kUart] = percent(line.peak(), line.capacity());
  m.total_usage_percent = m.usage_percent[kUart];
  m.total_peak_usage_percent = m.peak_usage_percent[kUart];
  constexpr std::uint8_t kAllocation = 0x80;
  m.errors = view.port.overflow ? std::uint8_t{kAllocation | 1U << kUart} : std::uint8_t{0};
  return m;
}

/// 0 unknown, 1 none, 2 warning, 3 critical; known only when CFG-ITFM switches the monitor on.
std::uint8_t jamming_state(const UbloxMonitorView& view, double jamming) {
  constexpr std::uint8_t kEnabled = 0x80;  // bit 31 of the first word
  if ((view.configuration.present().interference[3] & kEnabled) == 0) {
    return 0;
  }
  constexpr double kWarning = 0.2;
  constexpr double kCritical = 0.6;
  return jamming >= kCritical ? 3 : jamming >= kWarning ? 2 : 1;
}

/// Returns the jamming indicator of a radio that receives only noise: it varies a little.
std::uint8_t quiet_jamming(const UbloxMonitorView& view) {
  const UbloxFrontEnd& quiet = view.configuration.profile().front_end;
  constexpr std::uint64_t kOwnStream = 0x6A61'6D6D'696E'6700;
  RandomBits random(view.seed ^ (kOwnStream + view.epoch));
  return static_cast<std::uint8_t>(quiet.jamming_floor + random.below(quiet.jamming_span + 1U));
}

/// The receiver with its first band, or the second one's noise, gain and jamming in their place.
MonHw hardware(const UbloxMonitorView& view, bool second_band = false) {
  const UbloxFrontEnd& quiet = view.configuration.profile().front_end;
  const RadioState radio =
      view.solution.sample == nullptr ? RadioState{} : view.solution.sample->radio;
  const double noise_db = second_band ? radio.second_noise_db : radio.noise_db;
  const double jamming = second_band ? radio.second_jamming : radio.jamming;
  MonHw m;
  m.noise_per_ms =
      to_field<std::uint16_t>(quiet.noise_per_ms * std::pow(10.0, noise_db / 20.0), 1.0);
  // The gain goes down as the noise comes up, and all the way under a strong carrier.
  m.gain_control = static_cast<std::uint16_t>(std::clamp(
      quiet.gain_control * (1.0 - 0.9 * jamming) * std::pow(10.0, -noise_db / 40.0), 0.0, 8191.0));
  m.antenna_status = view.antenna.status;
  m.antenna_power = view.antenna.power;
  constexpr std::uint8_t kClockCalibrated = 0x01;
  m.flags = static_cast<std::uint8_t>(kClockCalibrated | jamming_state(view, jamming) << 2U);
  const double floor = quiet_jamming(view);
  m.jamming_indicator = to_field<std::uint8_t>(floor + (255.0 - floor) * jamming, 1.0);
  return m;
}

/// The bands of a receiver with two. Without disturbance both read the same.
std::size_t put_bands(const UbloxMonitorView& view, std::span<std::uint8_t> out) {
  // The middle of what recordings show: 6 to 24, 150 to 169.
  constexpr std::int8_t kOffset = 15;
  constexpr std::uint8_t kMagnitude = 160;
  std::array<MonRfBlock, 2> bands;
  for (std::size_t band = 0; band < bands.size(); ++band) {
    const MonHw hearing = hardware(view, band == 1);
    bands[band].block = static_cast<std::uint8_t>(band);
    bands[band].flags = hearing.flags >> 2U & 3U;
    bands[band].antenna_status = hearing.antenna_status;
    bands[band].antenna_power = hearing.antenna_power;
    bands[band].noise_per_ms = hearing.noise_per_ms;
    bands[band].gain_control = hearing.gain_control;
    bands[band].jamming_indicator = hearing.jamming_indicator;
    bands[band].offset_i = bands[band].offset_q = kOffset;
    bands[band].magnitude_i = bands[band].magnitude_q = kMagnitude;
  }
  const MonRfHead head{0, static_cast<std::uint8_t>(bands.size())};
  return encode_blocks<MonRfHead, MonRfBlock>(head, bands, out);
}

MonHw2 radio_part() {
  MonHw2 m;
  m.magnitude_i = m.magnitude_q = 128;
  constexpr std::uint8_t kFromOneTimeMemory = 111;
  m.configuration_source = kFromOneTimeMemory;
  m.self_test = 0xFFFFFFFF;  // not done
  return m;
}

AidIni initial_state(const UbloxMonitorView& view) {
  const UbloxSolution& s = view.solution;
  AidIni m;
  m.position = in_centimetres(ecef_position(s));
  m.position_accuracy_cm =
      unsigned_field(std::hypot(s.horizontal_accuracy_m, s.vertical_accuracy_m), 0.01);
  m.week = static_cast<std::uint16_t>(s.week);
  m.time_of_week_ms = s.time_of_week_ms;
  m.time_of_week_rest_ns = s.time_of_week_rest_ns;
  m.time_accuracy_ns = unsigned_field(s.time_accuracy_s, 1e-9);
  m.clock_drift = signed_field(s.clock_drift, 1e-9);
  m.clock_drift_accuracy = 1;
  m.flags = (s.has_position ? 1U : 0U) | (s.time_known && s.date_known ? 2U : 0U) |
            (s.dimensions > 0 ? 4U : 0U);
  return m;
}

/// Nothing while CFG-TP5 has switched the pulse off.
std::optional<TimTp> next_pulse(const UbloxMonitorView& view) {
  const UbloxSolution& s = view.solution;
  const CfgTp5& pulse = view.configuration.present().pulses[0];
  const auto has = [&](unsigned bit) { return (pulse.flags >> bit & 1U) != 0; };
  const bool locked = has(2) && s.time_known;
  const std::uint32_t period = locked ? pulse.period_locked : pulse.period;
  if (!has(0) || period == 0) {
    return std::nullopt;
  }
  const std::uint32_t period_ms =
      std::max<std::uint32_t>(1, has(3) ? 1000 / period : period / 1000);
  constexpr std::uint32_t kWeek_ms = 604'800'000;
  TimTp m;
  m.time_of_week_ms = (s.time_of_week_ms / period_ms + 1) * period_ms;
  m.week = static_cast<std::uint16_t>(s.week);
  if (s.time_known && m.time_of_week_ms >= kWeek_ms) {
    m.time_of_week_ms = 0;
    m.week = static_cast<std::uint16_t>(m.week + 1);
  }
  // A pulse begins on a tick of the 48 MHz clock.
  constexpr double kTick_s = 1.0 / 48e6;
  m.quantisation_error_ps = signed_field(std::remainder(s.clock_bias_s, kTick_s), 1e-12);
  const bool on_gps_time = has(7);
  m.flags = static_cast<std::uint8_t>((on_gps_time ? 0 : 1) | (s.leap_known ? 2 : 0));
  return m;
}

TimTm2 time_mark(const UbloxMonitorView& view) {
  const UbloxTimeMark& mark = view.mark;
  TimTm2 m;
  constexpr std::uint8_t kGnssTime = 1 << 3;
  m.flags = static_cast<std::uint8_t>(
      (mark.fell ? 0x04 : 0) | kGnssTime | (view.solution.leap_known ? 0x20 : 0) |
      (view.solution.date_known ? 0x40 : 0) | (mark.rose ? 0x80 : 0));
  m.count = mark.count;
  const auto put = [](const GpsTime& time, std::uint16_t& week, std::uint32_t& tow_ms,
                      std::uint32_t& rest_ns) {
    week = static_cast<std::uint16_t>(time.week);
    tow_ms = static_cast<std::uint32_t>(time.time_of_week_ns / kMillisecond_ns);
    rest_ns = static_cast<std::uint32_t>(time.time_of_week_ns % kMillisecond_ns);
  };
  put(mark.rising, m.rising_week, m.rising_time_of_week_ms, m.rising_rest_ns);
  put(mark.falling, m.falling_week, m.falling_time_of_week_ms, m.falling_rest_ns);
  m.accuracy_ns = unsigned_field(view.solution.time_accuracy_s, 1e-9);
  return m;
}

/// UART1, and UART2 once there was traffic on it: HPG 1.50, 3.14.1.
std::size_t put_communications(const UbloxMonitorView& view, std::span<std::uint8_t> out) {
  constexpr std::uint16_t kUart1 = 0x0100;
  constexpr std::uint16_t kUart2 = 0x0201;
  constexpr std::uint8_t kBufferFull = 1 << 1;
  constexpr std::uint8_t kOverUart1 = 2 << 2;
  MonCommsHead head;
  head.errors = static_cast<std::uint8_t>(kOverUart1 | (view.port.overflow ? kBufferFull : 0));
  std::array<MonCommsPort, 2> ports;
  const auto put = [&](std::uint16_t id, const UbloxTransmitter& line,
                       const UbloxPortStatistics& statistics) {
    MonCommsPort& port = ports[head.ports++];
    port.port = id;
    port.sending_bytes = to_field<std::uint16_t>(static_cast<double>(line.waiting()), 1.0);
    port.sent_bytes = static_cast<std::uint32_t>(line.bytes_sent());
    port.sending_percent = percent(line.waiting(), line.capacity());
    port.sending_peak_percent = percent(line.peak(), line.capacity());
    port.received_bytes = statistics.bytes;
    port.received_peak_percent = percent(statistics.peak_bytes, view.receive_capacity);
    for (std::size_t i = 0; i < port.messages.size(); ++i) {
      port.messages[i] = statistics.messages[head.protocols[i]];
    }
    port.skipped_bytes = statistics.skipped;
  };
  head.ports = 0;
  put(kUart1, view.transmitter, view.port);
  if (view.second_port != nullptr &&
      (view.second_port->bytes > 0 || view.second_line->bytes_sent() > 0)) {
    put(kUart2, *view.second_line, *view.second_port);
  }
  return encode_blocks<MonCommsHead, MonCommsPort>(head, std::span(ports).first(head.ports), out);
}

MonGnss major_systems(const UbloxMonitorView& view) {
  constexpr std::array kBits{GnssSystem::gps, GnssSystem::glonass, GnssSystem::beidou,
                             GnssSystem::galileo};
  const UbloxProfile& profile = view.configuration.profile();
  MonGnss m;
  for (std::size_t bit = 0; bit < kBits.size(); ++bit) {
    const auto mask = static_cast<std::uint8_t>(1U << bit);
    const auto found = std::ranges::find(profile.systems, kBits[bit], &SystemChannels::system);
    if (found == profile.systems.end()) {
      continue;
    }
    m.supported |= mask;
    m.default_on |= found->enabled ? mask : std::uint8_t{0};
    m.enabled |= view.configuration.enabled(kBits[bit]) ? mask : std::uint8_t{0};
  }
  // Galileo shares the band of GPS: one more than there are radio paths.
  constexpr int kMost = 4;
  m.simultaneous = static_cast<std::uint8_t>(std::min(profile.radio_paths + 1, kMost));
  return m;
}

/// No log was ever made. Capacity and reserved bytes as a NEO-M9N answers (pyubx2's examples).
LogInfo empty_log() {
  constexpr std::uint32_t kFileStore_bytes = 345'600;
  constexpr std::uint8_t kInactive = 1 << 4;
  LogInfo m;
  m.capacity_bytes = kFileStore_bytes;
  m.reserved = {0, 0x96, 0, 0, 0, 0x1E, 0, 0};
  m.status = kInactive;
  return m;
}

/// Returns the chip's number, which stays the same as long as the device's name and the seed do.
SecUniqid unique_number(const UbloxMonitorView& view) {
  constexpr std::uint64_t kOwnStream = 0x6368'6970'2069'6400;
  RandomBits random(view.seed ^ kOwnStream);
  SecUniqid m;
  for (std::uint8_t& byte : m.number) {
    byte = static_cast<std::uint8_t>(random.bits());
  }
  return m;
}

/// Centre frequencies of the signals of the tracked systems, each once.
std::size_t put_signal_security(const UbloxMonitorView& view, std::span<std::uint8_t> out) {
  constexpr unsigned kJammingBits = 1;
  constexpr std::uint8_t kJammingEnabled = 0x01;
  constexpr std::uint8_t kSpoofingEnabled = 0x08;
  constexpr unsigned kSpoofingBits = 4;
  constexpr std::uint32_t kJammed = 1U << 24U;
  const UbloxSignalSecurity& security = view.security;
  SecSigHead head;
  head.flags = static_cast<std::uint8_t>(kJammingEnabled | security.jamming() << kJammingBits |
                                         kSpoofingEnabled | security.spoofing() << kSpoofingBits);
  std::array<SecSigBlock, 8> blocks;
  const auto put = [&](GnssSystem system, bool second) {
    constexpr double kKilohertz = 1e3;
    const auto khz = static_cast<std::uint32_t>(carrier_hz(system, second, 0) / kKilohertz);
    const auto known = std::span(blocks).first(head.frequencies);
    const bool there = std::ranges::any_of(
        known, [&](const SecSigBlock& block) { return (block.state & (kJammed - 1U)) == khz; });
    if (!there && head.frequencies < blocks.size()) {
      blocks[head.frequencies++].state = khz | (security.jammed(second) ? kJammed : 0U);
    }
  };
  for (const bool second : {false, true}) {
    for (const SatelliteView& seen : view.solution.satellites) {
      if (seen.tracked && (!second || (has_second_carrier(seen.system) &&
                                       view.configuration.second_enabled(seen.system)))) {
        put(seen.system, second);
      }
    }
  }
  return encode_blocks<SecSigHead, SecSigBlock>(head, std::span(blocks).first(head.frequencies),
                                                out);
}

std::size_t put_signal_log(const UbloxMonitorView& view, std::span<std::uint8_t> out) {
  std::array<SecSiglogEvent, UbloxSignalSecurity::kMostEvents> events;
  SecSiglogHead head;
  for (const UbloxSignalSecurity::Event& event : view.security.log()) {
    events[head.events++] = {
        static_cast<std::uint32_t>((view.security.time() - event.at) / std::chrono::seconds{1}),
        static_cast<std::uint8_t>(event.detection), static_cast<std::uint8_t>(event.kind)};
  }
  return encode_blocks<SecSiglogHead, SecSiglogEvent>(head, std::span(events).first(head.events),
                                                      out);
}

}  // namespace

UbloxAntenna supervise(AntennaState state, const CfgAnt& settings) {
  const auto has = [&](unsigned bit) { return (settings.flags >> bit & 1U) != 0; };
  const bool controls = has(0);
  const bool detects_short = has(1);
  const bool detects_open = has(2);
  const bool powers_down = has(3);
  const std::uint8_t power = controls ? 1 : 2;
  if (state == AntennaState::short_circuit && detects_short) {
    return {3, powers_down ? std::uint8_t{0} : power, "ANTSTATUS=SHORT"};
  }
  if (state == AntennaState::open && detects_open) {
    return {4, power, "ANTSTATUS=OPEN"};
  }
  if (!detects_short && !detects_open) {
    return {1, power, "ANTSTATUS=DONTKNOW"};
  }
  return {2, power, "ANTSTATUS=OK"};
}

std::size_t encode_monitor(const UbloxMonitorView& view, MessageId id,
                           std::span<std::uint8_t> out) {
  if (id == MonIoHead::kId) return put_ports(view, out);
  if (id == MonMsgpp::kId) return encode(parsed(view), out);
  if (id == MonRxbuf::kId) return encode(receive_buffer(view), out);
  if (id == MonTxbuf::kId) return encode(transmit_buffer(view), out);
  if (id == MonRfHead::kId) return put_bands(view, out);
  if (id == MonCommsHead::kId) return put_communications(view, out);
  if (id == MonGnss::kId) return encode(major_systems(view), out);
  if (id == MonPatchHead::kId) return encode(MonPatchHead{}, out);
  if (id == SecUniqid::kId) return encode(unique_number(view), out);
  if (id == SecSigHead::kId) return put_signal_security(view, out);
  if (id == SecSiglogHead::kId) return put_signal_log(view, out);
  if (id == LogInfo::kId) return encode(empty_log(), out);
  if (id == MonHw::kId) return encode(hardware(view), out);
  if (id == MonHw2::kId) return encode(radio_part(), out);
  if (id == MonRxr::kId) return encode(MonRxr{1}, out);
  if (id == AidIni::kId) return encode(initial_state(view), out);
  if (id == TimTm2::kId) return encode(time_mark(view), out);
  if (id == TimTp::kId) {
    const auto pulse = next_pulse(view);
    return pulse ? encode(*pulse, out) : 0;
  }
  return 0;
}

}  // namespace rigwire::emulators
