// What an HDL-64E reports of itself through its status channel: the record of 1820 bytes that it
// repeats, seven in every sixteen packets (status_channel.h).
//
//   offset 0            "UNIT#", then the noise thresholds of the upper and the lower bank
//   offset 7 + 28 n     laser n = 0..63: number u8; then nine i16: elevation and rotation (0.01
//                       degree), far distance correction, near ones of x and y, vertical and
//                       horizontal offset, focal distance (mm), focal slope (0.1); min and
//                       max intensity u8; seven reserved bytes (S3: the first repeats the
//                       warnings), but for laser 63, whose place the tail takes
//   offset 1792         year (from 2000), month, day, hour, minute, second of the calibration;
//                       humidity; motor speed i16 rpm; view from and to u16 0.01 degree; life u16
//                       hours; source and destination address, 4 bytes each; echoes (0 strongest,
//                       1 last, 2 both); warnings; power level; check u16
//
// All little-endian. The check of an S3 is a CRC with polynomial 0x8005, from 0, most significant
// bit first, over bytes 1 to 20 of each laser; an S2 sends the length, 1820.
//
// Sources: HDL-64E S3 user's manual 63-HDL64ES3 Rev. K, appendix E, pages 33 to 37; HDL-64E S2 and
// S2.1 manual, appendices D and E; what the CRC covers, and that the S2 has none: velodyne_decoder
// 3.1.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "protocols/result.h"
#include "protocols/velodyne/hdl_64e_calibration.h"

namespace rigwire::protocols::velodyne {

inline constexpr std::size_t kStatusRecordSize = 5 + 2      // start, thresholds
                                                 + 64 * 28  // lasers, reserved bytes
                                                 - 7        // none behind the last one
                                                 + 28;      // tail
static_assert(kStatusRecordSize == 1820 && kStatusRecordSize % 7 == 0);

enum class StatusFormat : std::uint8_t { s2, s3 };
enum class StatusEchoes : std::uint8_t { strongest = 0, last = 1, both = 2 };

/// Bits of the warning byte; those of the voltage in an S2 alone.
inline constexpr std::uint8_t kWarnLensDirty = 1U << 0U;
inline constexpr std::uint8_t kWarnHot = 1U << 1U;
inline constexpr std::uint8_t kWarnCold = 1U << 2U;
inline constexpr std::uint8_t kWarnVoltageLow = 1U << 3U;
inline constexpr std::uint8_t kWarnVoltageHigh = 1U << 4U;
inline constexpr std::uint8_t kPulsePresent = 1U << 5U;
inline constexpr std::uint8_t kGpsTimePresent = 1U << 6U;

/// Power level: this or 0xA0 .. 0xA7.
inline constexpr std::uint8_t kPowerInternalCorrection = 0xA8;

struct StatusRecord {
  StatusFormat format = StatusFormat::s2;
  std::uint8_t upper_threshold = 24;
  std::uint8_t lower_threshold = 24;
  Hdl64eCalibration calibration;
  /// Year from 2000, month, day, hour, minute, second; 0xFF where unknown.
  std::array<std::uint8_t, 6> calibrated_at{12, 1, 1, 0, 0, 0};
  std::uint8_t humidity_percent = 0;
  std::int16_t motor_rpm = 600;
  std::uint16_t view_start_centideg = 0;
  std::uint16_t view_end_centideg = 36000;
  std::uint16_t life_hours = 0;
  std::array<std::uint8_t, 4> source{192, 168, 3, 43};
  std::array<std::uint8_t, 4> destination{192, 168, 3, 255};
  StatusEchoes echoes = StatusEchoes::strongest;
  std::uint8_t warnings = 0;
  std::uint8_t power_level = kPowerInternalCorrection;

  friend bool operator==(const StatusRecord&, const StatusRecord&) = default;
};

/// The calibration as the record can carry it: rounded to its units, clamped to its fields. A
/// sensor that is read through its status channel must measure with this one.
[[nodiscard]] Hdl64eCalibration as_sent(const Hdl64eCalibration& calibration);

/// Precondition: the calibration is validated.
void encode(const StatusRecord& record, std::span<std::uint8_t, kStatusRecordSize> bytes);

/// Malformed: start or check are wrong, lasers are not numbered 0 to 63, echoes are unknown. Which
/// check holds decides the format: S2 where it is the length.
Decoded<StatusRecord> decode_status_record(std::span<const std::uint8_t> bytes);

/// The CRC of an S3's record.
[[nodiscard]] std::uint16_t status_crc(std::span<const std::uint8_t, kStatusRecordSize> bytes);

}  // namespace rigwire::protocols::velodyne
