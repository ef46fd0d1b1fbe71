#include "protocols/velodyne/status_record.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <string_view>

#include "protocols/bytes.h"

namespace rigwire::protocols::velodyne {
namespace {

constexpr std::string_view kRecordStart = "UNIT#";
constexpr std::size_t kUpperThresholdAt = kRecordStart.size();
constexpr std::size_t kLowerThresholdAt = kUpperThresholdAt + 1;
constexpr std::size_t kLasersAt = kLowerThresholdAt + 1;
constexpr std::size_t kLaserStride = 28;

/// Within a laser's piece.
struct LaserField {
  std::size_t at;
  double Hdl64eLaser::*value;
  double unit;
};
constexpr std::array<LaserField, 9> kLaserFields{{
    {1, &Hdl64eLaser::vert_correction_deg, 0.01},
    {3, &Hdl64eLaser::rot_correction_deg, 0.01},
    {5, &Hdl64eLaser::dist_correction_m, 0.001},
    {7, &Hdl64eLaser::dist_correction_x_m, 0.001},
    {9, &Hdl64eLaser::dist_correction_y_m, 0.001},
    {11, &Hdl64eLaser::vert_offset_m, 0.001},
    {13, &Hdl64eLaser::horiz_offset_m, 0.001},
    {15, &Hdl64eLaser::focal_distance_m, 0.001},
    {17, &Hdl64eLaser::focal_slope, 0.1},
}};
constexpr std::size_t kMinIntensityAt = kLaserFields.back().at + 2;
constexpr std::size_t kMaxIntensityAt = kMinIntensityAt + 1;
constexpr std::size_t kReservedAt = kMaxIntensityAt + 1;
static_assert(kReservedAt + 7 == kLaserStride);

constexpr std::size_t kTailAt = kLasersAt + kHdl64eLasers * kLaserStride - 7;
constexpr std::size_t kHumidityAt = kTailAt + 6;
constexpr std::size_t kMotorAt = kHumidityAt + 1;
constexpr std::size_t kViewStartAt = kMotorAt + 2;
constexpr std::size_t kViewEndAt = kViewStartAt + 2;
constexpr std::size_t kLifeAt = kViewEndAt + 2;
constexpr std::size_t kSourceAt = kLifeAt + 2;
constexpr std::size_t kDestinationAt = kSourceAt + 4;
constexpr std::size_t kEchoesAt = kDestinationAt + 4;
constexpr std::size_t kWarningsAt = kEchoesAt + 1;
constexpr std::size_t kPowerAt = kWarningsAt + 1;
constexpr std::size_t kCheckAt = kPowerAt + 1;
static_assert(kTailAt == 1792 && kCheckAt + 2 == kStatusRecordSize);

constexpr std::size_t laser_at(std::size_t laser) {
  return kLasersAt + laser * kLaserStride;
}

std::int16_t counts(double value, double unit) {
  return static_cast<std::int16_t>(std::lround(std::clamp(value / unit, -32768.0, 32767.0)));
}

void encode_laser(const Hdl64eLaser& laser, std::span<std::uint8_t> piece) {
  for (const LaserField& field : kLaserFields) {
    store_little(piece, field.at, counts(laser.*field.value, field.unit));
  }
  piece[kMinIntensityAt] = laser.min_intensity;
  piece[kMaxIntensityAt] = laser.max_intensity;
}

Hdl64eLaser decode_laser(std::span<const std::uint8_t> piece) {
  Hdl64eLaser laser;
  for (const LaserField& field : kLaserFields) {
    laser.*field.value = load_little<std::int16_t>(piece, field.at) * field.unit;
  }
  laser.min_intensity = piece[kMinIntensityAt];
  laser.max_intensity = piece[kMaxIntensityAt];
  return laser;
}

}  // namespace

Hdl64eCalibration as_sent(const Hdl64eCalibration& calibration) {
  Hdl64eCalibration sent = calibration;
  for (Hdl64eLaser& laser : sent.lasers) {
    for (const LaserField& field : kLaserFields) {
      laser.*field.value = counts(laser.*field.value, field.unit) * field.unit;
    }
  }
  return sent;
}

std::uint16_t status_crc(std::span<const std::uint8_t, kStatusRecordSize> bytes) {
  constexpr unsigned kPolynomial = 0x8005;
  unsigned crc = 0;
  for (std::size_t laser = 0; laser < kHdl64eLasers; ++laser) {
    for (const std::uint8_t byte : bytes.subspan(laser_at(laser) + 1, kReservedAt - 1)) {
      crc ^= static_cast<unsigned>(byte) << 8U;
      for (int bit = 0; bit < 8; ++bit) {
        crc = (crc & 0x8000U) != 0 ? (crc << 1U) ^ kPolynomial : crc << 1U;
      }
      crc &= 0xFFFFU;
    }
  }
  return static_cast<std::uint16_t>(crc);
}

void encode(const StatusRecord& record, std::span<std::uint8_t, kStatusRecordSize> bytes) {
  assert(record.calibration.lasers.size() == kHdl64eLasers);
  std::ranges::fill(bytes, std::uint8_t{0});
  std::ranges::copy(kRecordStart, bytes.begin());
  bytes[kUpperThresholdAt] = record.upper_threshold;
  bytes[kLowerThresholdAt] = record.lower_threshold;
  for (std::size_t i = 0; i < kHdl64eLasers; ++i) {
    const auto piece = bytes.subspan(laser_at(i), kReservedAt);
    piece[0] = static_cast<std::uint8_t>(i);
    encode_laser(record.calibration.lasers[i], piece);
    if (record.format == StatusFormat::s3 && i + 1 < kHdl64eLasers) {
      bytes[laser_at(i) + kReservedAt] = record.warnings;
    }
  }
  std::ranges::copy(record.calibrated_at, bytes.begin() + kTailAt);
  bytes[kHumidityAt] = record.humidity_percent;
  store_little(bytes, kMotorAt, record.motor_rpm);
  store_little(bytes, kViewStartAt, record.view_start_centideg);
  store_little(bytes, kViewEndAt, record.view_end_centideg);
  store_little(bytes, kLifeAt, record.life_hours);
  std::ranges::copy(record.source, bytes.begin() + kSourceAt);
  std::ranges::copy(record.destination, bytes.begin() + kDestinationAt);
  bytes[kEchoesAt] = static_cast<std::uint8_t>(record.echoes);
  bytes[kWarningsAt] = record.warnings;
  bytes[kPowerAt] = record.power_level;
  store_little(bytes, kCheckAt,
               record.format == StatusFormat::s3 ? status_crc(bytes)
                                                 : static_cast<std::uint16_t>(kStatusRecordSize));
}

Decoded<StatusRecord> decode_status_record(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < kStatusRecordSize) {
    return Incomplete{kStatusRecordSize, bytes.size()};
  }
  if (!std::ranges::equal(bytes.first(kRecordStart.size()), kRecordStart)) {
    return Malformed{"the record does not begin with UNIT#", 0};
  }
  StatusRecord record;
  const auto check = load_little<std::uint16_t>(bytes, kCheckAt);
  if (check == status_crc(bytes.first<kStatusRecordSize>())) {
    record.format = StatusFormat::s3;
  } else if (check != kStatusRecordSize) {
    return Malformed{"the check is neither that of an S3 nor the length of an S2", kCheckAt};
  }
  for (std::size_t i = 0; i < kHdl64eLasers; ++i) {
    if (bytes[laser_at(i)] != i) {
      return Malformed{"lasers are not numbered 0 to 63", laser_at(i)};
    }
    record.calibration.lasers.push_back(decode_laser(bytes.subspan(laser_at(i), kReservedAt)));
  }
  if (bytes[kEchoesAt] > static_cast<std::uint8_t>(StatusEchoes::both)) {
    return Malformed{"unknown setting of the echoes", kEchoesAt};
  }
  record.upper_threshold = bytes[kUpperThresholdAt];
  record.lower_threshold = bytes[kLowerThresholdAt];
  std::ranges::copy(bytes.subspan(kTailAt, record.calibrated_at.size()),
                    record.calibrated_at.begin());
  record.humidity_percent = bytes[kHumidityAt];
  record.motor_rpm = load_little<std::int16_t>(bytes, kMotorAt);
  record.view_start_centideg = load_little<std::uint16_t>(bytes, kViewStartAt);
  record.view_end_centideg = load_little<std::uint16_t>(bytes, kViewEndAt);
  record.life_hours = load_little<std::uint16_t>(bytes, kLifeAt);
  std::ranges::copy(bytes.subspan(kSourceAt, record.source.size()), record.source.begin());
  std::ranges::copy(bytes.subspan(kDestinationAt, record.destination.size()),
                    record.destination.begin());
  record.echoes = static_cast<StatusEchoes>(bytes[kEchoesAt]);
  record.warnings = bytes[kWarningsAt];
  record.power_level = bytes[kPowerAt];
  return {std::move(record), kStatusRecordSize};
}

}  // namespace rigwire::protocols::velodyne
