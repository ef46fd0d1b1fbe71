// What a host asks of a gs_usb adapter over the control endpoint: requests, and the structures that
// go with them.
//
// gs_usb is the protocol between the Linux driver of that name and USB to CAN adapters: first those
// of Geschwister Schneider, today mostly the open firmware candleLight and its kin. It has no
// written specification. Sources: Linux 6.1, drivers/net/can/usb/gs_usb.c (the host);
// candle-usb/candleLight_fw, include/gs_usb.h and src/usbd_gs_can.c at 64dc8dc (the adapter).
//
//   request              number  direction  bytes  structure
//   host format             0    to device     4   HostFormat
//   bit timing              1    to device    20   BitTiming
//   mode                    2    to device     8   Mode
//   bit timing limits       4    to host      40   BitTimingLimits
//   device configuration    5    to host      12   DeviceConfiguration
//   time stamp              6    to host       4   TimeStamp
//   identify                7    to device     4   Identify
//   controller state       14    to host      12   ControllerState
//   bus-off recovery       32    to device     0
//
// All are vendor requests. wValue is the channel, except for host format and device configuration,
// where the driver sends 1. Every structure is a row of 32-bit words, least significant byte first
// (the first adapters took the host's byte order; candleLight does not). One table of words per
// structure serves encoder and decoder.
//
// Worked example: 250 kbit/s from a clock of 48 MHz with the sample point at 87.5 % is prescaler 12
// and 16 time quanta, 1 + 6 + 7 up to the sample point and 2 after it:
//   06000000 07000000 02000000 01000000 0C000000
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "protocols/bytes.h"
#include "protocols/result.h"

namespace rigwire::protocols::gs_usb {

enum class Request : std::uint8_t {
  host_format = 0,
  bit_timing = 1,
  mode = 2,
  bit_timing_limits = 4,
  device_configuration = 5,
  time_stamp = 6,
  identify = 7,
  data_bit_timing = 10,             ///< CAN FD.
  extended_bit_timing_limits = 11,  ///< CAN FD.
  set_termination = 12,
  get_termination = 13,
  controller_state = 14,
  bus_off_recovery = 32,
};

/// Bits of BitTimingLimits::features (what an adapter can) and Mode::flags (what a host wants of
/// it).
struct Feature {
  static constexpr std::uint32_t kListenOnly = 1U << 0;
  static constexpr std::uint32_t kLoopBack = 1U << 1;
  static constexpr std::uint32_t kTripleSample = 1U << 2;
  static constexpr std::uint32_t kOneShot = 1U << 3;
  static constexpr std::uint32_t kTimeStamp = 1U << 4;
  static constexpr std::uint32_t kIdentify = 1U << 5;
  static constexpr std::uint32_t kUserId = 1U << 6;
  static constexpr std::uint32_t kPadded = 1U << 7;  ///< Frames to the host fill a packet.
  static constexpr std::uint32_t kFlexibleDataRate = 1U << 8;
  static constexpr std::uint32_t kTermination = 1U << 11;
  static constexpr std::uint32_t kBusErrors = 1U << 12;  ///< Each bus error is reported.
  static constexpr std::uint32_t kControllerState = 1U << 13;
  static constexpr std::uint32_t kBusOffRecovery = 1U << 18;  ///< The host says when to recover.
};

struct HostFormat {
  std::uint32_t byte_order = 0x0000BEEF;

  friend bool operator==(const HostFormat&, const HostFormat&) = default;
};

/// In time quanta of prescaler / clock. A bit is one quantum of synchronisation and the segments.
struct BitTiming {
  std::uint32_t propagation_segment = 0;
  std::uint32_t phase_segment_1 = 0;
  std::uint32_t phase_segment_2 = 0;
  std::uint32_t jump_width = 0;
  std::uint32_t prescaler = 0;

  friend bool operator==(const BitTiming&, const BitTiming&) = default;
};

struct Mode {
  static constexpr std::uint32_t kReset = 0;  ///< The controller leaves the bus.
  static constexpr std::uint32_t kStart = 1;
  std::uint32_t mode = kReset;
  std::uint32_t flags = 0;  ///< Feature bits.

  friend bool operator==(const Mode&, const Mode&) = default;
};

/// Segment 1 is propagation and phase 1 together.
struct BitTimingLimits {
  std::uint32_t features = 0;
  std::uint32_t clock_hz = 0;
  std::uint32_t segment_1_min = 0;
  std::uint32_t segment_1_max = 0;
  std::uint32_t segment_2_min = 0;
  std::uint32_t segment_2_max = 0;
  std::uint32_t jump_width_max = 0;
  std::uint32_t prescaler_min = 0;
  std::uint32_t prescaler_max = 0;
  std::uint32_t prescaler_step = 0;

  friend bool operator==(const BitTimingLimits&, const BitTimingLimits&) = default;
};

struct DeviceConfiguration {
  std::uint32_t last_channel = 0;  ///< Top byte: number of channels less one; others reserved.
  std::uint32_t software_version = 0;
  std::uint32_t hardware_version = 0;

  [[nodiscard]] std::uint32_t channels() const { return (last_channel >> 24U) + 1U; }
  friend bool operator==(const DeviceConfiguration&, const DeviceConfiguration&) = default;
};

/// Free-running counter of the device.
struct TimeStamp {
  std::uint32_t microseconds = 0;

  friend bool operator==(const TimeStamp&, const TimeStamp&) = default;
};

struct Identify {
  std::uint32_t on = 0;

  friend bool operator==(const Identify&, const Identify&) = default;
};

struct ControllerState {
  static constexpr std::uint32_t kActive = 0;
  static constexpr std::uint32_t kWarning = 1;
  static constexpr std::uint32_t kPassive = 2;
  static constexpr std::uint32_t kBusOff = 3;
  static constexpr std::uint32_t kStopped = 4;
  std::uint32_t state = kActive;
  std::uint32_t receive_errors = 0;
  std::uint32_t transmit_errors = 0;

  friend bool operator==(const ControllerState&, const ControllerState&) = default;
};

/// The words of a structure in their order on the wire.
template <class Structure>
struct Layout;
template <>
struct Layout<HostFormat> {
  static constexpr std::array words{&HostFormat::byte_order};
};
template <>
struct Layout<BitTiming> {
  static constexpr std::array words{&BitTiming::propagation_segment, &BitTiming::phase_segment_1,
                                    &BitTiming::phase_segment_2, &BitTiming::jump_width,
                                    &BitTiming::prescaler};
};
template <>
struct Layout<Mode> {
  static constexpr std::array words{&Mode::mode, &Mode::flags};
};
template <>
struct Layout<BitTimingLimits> {
  static constexpr std::array words{
      &BitTimingLimits::features,       &BitTimingLimits::clock_hz,
      &BitTimingLimits::segment_1_min,  &BitTimingLimits::segment_1_max,
      &BitTimingLimits::segment_2_min,  &BitTimingLimits::segment_2_max,
      &BitTimingLimits::jump_width_max, &BitTimingLimits::prescaler_min,
      &BitTimingLimits::prescaler_max,  &BitTimingLimits::prescaler_step};
};
template <>
struct Layout<DeviceConfiguration> {
  static constexpr std::array words{&DeviceConfiguration::last_channel,
                                    &DeviceConfiguration::software_version,
                                    &DeviceConfiguration::hardware_version};
};
template <>
struct Layout<TimeStamp> {
  static constexpr std::array words{&TimeStamp::microseconds};
};
template <>
struct Layout<Identify> {
  static constexpr std::array words{&Identify::on};
};
template <>
struct Layout<ControllerState> {
  static constexpr std::array words{&ControllerState::state, &ControllerState::receive_errors,
                                    &ControllerState::transmit_errors};
};

template <class Structure>
inline constexpr std::size_t kBytes = Layout<Structure>::words.size() * sizeof(std::uint32_t);
static_assert(kBytes<BitTiming> == 20 && kBytes<Mode> == 8 && kBytes<BitTimingLimits> == 40 &&
              kBytes<DeviceConfiguration> == 12);

template <class Structure>
[[nodiscard]] std::array<std::uint8_t, kBytes<Structure>> encode(const Structure& structure) {
  std::array<std::uint8_t, kBytes<Structure>> bytes{};
  std::size_t offset = 0;
  for (const auto word : Layout<Structure>::words) {
    store_little(std::span<std::uint8_t>(bytes), offset, structure.*word);
    offset += sizeof(std::uint32_t);
  }
  return bytes;
}

/// Ignores what follows the structure, as the firmware does.
template <class Structure>
[[nodiscard]] Decoded<Structure> decode(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < kBytes<Structure>) {
    return Incomplete{kBytes<Structure>, bytes.size()};
  }
  Structure structure;
  std::size_t offset = 0;
  for (const auto word : Layout<Structure>::words) {
    structure.*word = load_little<std::uint32_t>(bytes, offset);
    offset += sizeof(std::uint32_t);
  }
  return {structure, offset};
}

/// What the firmware checks before it takes a bit timing.
[[nodiscard]] inline bool permitted(const BitTiming& timing, const BitTimingLimits& limits) {
  const std::uint64_t segment_1 =
      std::uint64_t{timing.propagation_segment} + timing.phase_segment_1;
  return segment_1 >= limits.segment_1_min && segment_1 <= limits.segment_1_max &&
         timing.phase_segment_2 >= limits.segment_2_min &&
         timing.phase_segment_2 <= limits.segment_2_max &&
         timing.jump_width <= limits.jump_width_max && timing.prescaler >= limits.prescaler_min &&
         timing.prescaler <= limits.prescaler_max;
}

/// The bit rate to the nearest bit/s; nothing for a timing without length or prescaler, or whose
/// rate is below 1 bit/s.
[[nodiscard]] inline std::optional<std::uint32_t> bit_rate_bps(const BitTiming& timing,
                                                               std::uint32_t clock_hz) {
  constexpr std::uint64_t kSynchronisation = 1;
  const std::uint64_t quanta = kSynchronisation + timing.propagation_segment +
                               timing.phase_segment_1 + timing.phase_segment_2;
  if (quanta == kSynchronisation || timing.prescaler == 0) {
    return std::nullopt;
  }
  // Both factors stay below 2^34 and 2^32: beyond the clock the product needs no exact value.
  if (quanta > clock_hz || timing.prescaler > clock_hz) {
    return std::nullopt;
  }
  const std::uint64_t clocks_per_bit = quanta * timing.prescaler;
  const std::uint64_t rate = (clock_hz + clocks_per_bit / 2) / clocks_per_bit;
  if (rate == 0) {
    return std::nullopt;
  }
  return static_cast<std::uint32_t>(rate);
}

}  // namespace rigwire::protocols::gs_usb
