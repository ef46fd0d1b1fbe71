#include "protocols/velodyne/position_packet.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "protocols/angle.h"
#include "protocols/bytes.h"

namespace rigwire::protocols::velodyne {
namespace {

constexpr std::size_t kInertialAt = kPositionHeadSize;
constexpr std::size_t kPositionTimestampAt =
    kInertialAt + kInertialGroups * kInertialGroupSize + kPositionGapSize;
constexpr std::size_t kPulseStateAt = kPositionTimestampAt + 4;
constexpr std::size_t kNmeaAt = kPulseStateAt + 1 + 3;
static_assert(kPositionTimestampAt == 198 && kNmeaAt == 206);
static_assert(kNmeaAt + kNmeaSize == kPositionPacketSize);

/// The extended layout, around the timestamp.
constexpr std::size_t kTopBoardAt = 0xBB;
constexpr std::size_t kBottomBoardAt = kTopBoardAt + 1;
constexpr std::size_t kAtCalibrationAt = kBottomBoardAt + 1;
constexpr std::size_t kChangeAt = kAtCalibrationAt + 1;
constexpr std::size_t kSinceAt = kChangeAt + 2;
constexpr std::size_t kReasonAt = kSinceAt + 4;
constexpr std::size_t kConditionsAt = kReasonAt + 1;
static_assert(kConditionsAt + 1 == kPositionTimestampAt);
constexpr std::size_t kThermalAt = kPulseStateAt + 1;
constexpr std::size_t kShutdownAt = kThermalAt + 1;
constexpr std::size_t kPowerUpAt = kShutdownAt + 1;
static_assert(kPowerUpAt + 1 == kNmeaAt);

constexpr std::uint8_t kCalibrating = 1U << 0U;
constexpr std::uint8_t kTemperatureChangeReached = 1U << 1U;
constexpr std::uint8_t kPeriodReached = 1U << 2U;

constexpr double kStandardGravity_mps2 = 9.80665;

constexpr std::uint16_t kTwelveBits = 0x0FFF;

std::uint16_t pack_12(std::int16_t counts) {
  assert(counts >= -2048 && counts <= 2047);
  return static_cast<std::uint16_t>(static_cast<std::uint16_t>(counts) & kTwelveBits);
}

std::int16_t unpack_12(std::uint16_t field) {
  const int counts = field & kTwelveBits;
  return static_cast<std::int16_t>(counts >= 2048 ? counts - 4096 : counts);
}

std::int16_t counts_of(double value, double unit) {
  const double counts = std::round(value / unit);
  return std::isnan(counts) ? std::int16_t{0}
                            : static_cast<std::int16_t>(std::clamp(counts, -2048.0, 2047.0));
}

void encode_status(const UnitStatus& status, std::span<std::uint8_t> bytes) {
  bytes[kTopBoardAt] = status.top_board_c;
  bytes[kBottomBoardAt] = status.bottom_board_c;
  bytes[kAtCalibrationAt] = status.at_calibration_c;
  store_little(bytes, kChangeAt, status.change_since_calibration_c);
  store_little(bytes, kSinceAt, status.since_calibration_s);
  bytes[kReasonAt] = static_cast<std::uint8_t>(status.last_calibration);
  bytes[kConditionsAt] = static_cast<std::uint8_t>(
      (status.calibrating ? kCalibrating : 0) |
      (status.temperature_change_reached ? kTemperatureChangeReached : 0) |
      (status.period_reached ? kPeriodReached : 0));
  bytes[kThermalAt] = status.thermal_shutdown ? 1 : 0;
  bytes[kShutdownAt] = status.at_shutdown_c;
  bytes[kPowerUpAt] = status.at_power_up_c;
}

UnitStatus decode_status(std::span<const std::uint8_t> bytes) {
  const std::uint8_t conditions = bytes[kConditionsAt];
  return {.top_board_c = bytes[kTopBoardAt],
          .bottom_board_c = bytes[kBottomBoardAt],
          .at_calibration_c = bytes[kAtCalibrationAt],
          .change_since_calibration_c = load_little<std::int16_t>(bytes, kChangeAt),
          .since_calibration_s = load_little<std::uint32_t>(bytes, kSinceAt),
          .last_calibration = static_cast<ConverterCalibration>(bytes[kReasonAt]),
          .calibrating = (conditions & kCalibrating) != 0,
          .temperature_change_reached = (conditions & kTemperatureChangeReached) != 0,
          .period_reached = (conditions & kPeriodReached) != 0,
          .thermal_shutdown = bytes[kThermalAt] != 0,
          .at_shutdown_c = bytes[kShutdownAt],
          .at_power_up_c = bytes[kPowerUpAt]};
}

}  // namespace

InertialGroup to_counts(const InertialReading& reading) {
  return {
      .gyro = counts_of(reading.rate_radps, kGyroUnit_degps * kDegree),
      .temperature = counts_of(reading.temperature_c - kTemperatureOrigin_c, kTemperatureUnit_c),
      .acceleration_x =
          counts_of(reading.acceleration_x_mps2, kAccelerationUnit_g * kStandardGravity_mps2),
      .acceleration_y =
          counts_of(reading.acceleration_y_mps2, kAccelerationUnit_g * kStandardGravity_mps2)};
}

InertialReading from_counts(const InertialGroup& group) {
  return {
      .rate_radps = group.gyro * kGyroUnit_degps * kDegree,
      .temperature_c = group.temperature * kTemperatureUnit_c + kTemperatureOrigin_c,
      .acceleration_x_mps2 = group.acceleration_x * kAccelerationUnit_g * kStandardGravity_mps2,
      .acceleration_y_mps2 = group.acceleration_y * kAccelerationUnit_g * kStandardGravity_mps2};
}

std::string_view PositionPacket::sentence() const {
  const auto end = std::ranges::find(nmea, '\0');
  return {nmea.data(), static_cast<std::size_t>(end - nmea.begin())};
}

void PositionPacket::set_sentence(std::string_view text) {
  assert(text.size() <= nmea.size() && text.find('\0') == std::string_view::npos);
  nmea.fill('\0');
  std::ranges::copy(text, nmea.begin());
}

void encode(const PositionPacket& packet, std::span<std::uint8_t, kPositionPacketSize> bytes) {
  std::ranges::fill(bytes, std::uint8_t{0});
  for (std::size_t g = 0; g < kInertialGroups; ++g) {
    const std::size_t at = kInertialAt + g * kInertialGroupSize;
    store_little(bytes, at, pack_12(packet.inertial[g].gyro));
    store_little(bytes, at + 2, pack_12(packet.inertial[g].temperature));
    store_little(bytes, at + 4, pack_12(packet.inertial[g].acceleration_x));
    store_little(bytes, at + 6, pack_12(packet.inertial[g].acceleration_y));
  }
  encode_status(packet.status, bytes);
  store_little(bytes, kPositionTimestampAt, packet.timestamp_us);
  bytes[kPulseStateAt] = static_cast<std::uint8_t>(packet.pulse_state);
  for (std::size_t i = 0; i < kNmeaSize; ++i) {
    bytes[kNmeaAt + i] = static_cast<std::uint8_t>(packet.nmea[i]);
  }
}

Decoded<PositionPacket> decode_position_packet(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < kPositionPacketSize) {
    return Incomplete{kPositionPacketSize, bytes.size()};
  }
  if (bytes.size() > kPositionPacketSize) {
    return Malformed{"a position packet has 512 bytes, this datagram has more",
                     kPositionPacketSize};
  }
  for (std::size_t i = 0; i < kPositionHeadSize; ++i) {
    if (bytes[i] != 0) {
      return Malformed{"the first 14 bytes must be zero", i};
    }
  }
  if (bytes[kPulseStateAt] > static_cast<std::uint8_t>(PulseState::error)) {
    return Malformed{"unknown state of the pulse input", kPulseStateAt};
  }
  if (bytes[kReasonAt] > static_cast<std::uint8_t>(ConverterCalibration::periodic)) {
    return Malformed{"unknown reason of the last calibration", kReasonAt};
  }
  if (bytes[kThermalAt] > 1) {
    return Malformed{"unknown thermal state", kThermalAt};
  }
  PositionPacket packet;
  packet.status = decode_status(bytes);
  for (std::size_t g = 0; g < kInertialGroups; ++g) {
    const std::size_t at = kInertialAt + g * kInertialGroupSize;
    packet.inertial[g] = {unpack_12(load_little<std::uint16_t>(bytes, at)),
                          unpack_12(load_little<std::uint16_t>(bytes, at + 2)),
                          unpack_12(load_little<std::uint16_t>(bytes, at + 4)),
                          unpack_12(load_little<std::uint16_t>(bytes, at + 6))};
  }
  packet.timestamp_us = load_little<std::uint32_t>(bytes, kPositionTimestampAt);
  packet.pulse_state = static_cast<PulseState>(bytes[kPulseStateAt]);
  bool ended = false;
  for (std::size_t i = 0; i < kNmeaSize; ++i) {
    const std::uint8_t byte = bytes[kNmeaAt + i];
    if (ended && byte != 0) {
      return Malformed{"text behind the end of the sentence", kNmeaAt + i};
    }
    ended = ended || byte == 0;
    packet.nmea[i] = static_cast<char>(byte);
  }
  return {packet, kPositionPacketSize};
}

}  // namespace rigwire::protocols::velodyne
