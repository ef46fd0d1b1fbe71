#include "protocols/velodyne/status_channel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <stdexcept>
#include <vector>

namespace rigwire::protocols::velodyne {
namespace {

using StatusChannelBytes = std::array<std::uint8_t, kStatusRecordSize>;

StatusRecord sample(StatusFormat format) {
  StatusRecord record;
  record.format = format;
  record.calibration = nominal_calibration(*find_model("HDL-64E S2"));
  for (std::size_t i = 0; i < kHdl64eLasers; ++i) {
    Hdl64eLaser& laser = record.calibration.lasers[i];
    const double phase = 1.7 * static_cast<double>(i);
    laser.rot_correction_deg += 0.3 * std::sin(phase);
    laser.dist_correction_m += 0.1 * std::cos(phase);
    laser.focal_distance_m = 12.0 + 11.0 * std::sin(phase);
    laser.focal_slope = 1.0 + 0.9 * std::cos(phase);
    laser.min_intensity = static_cast<std::uint8_t>(i);
  }
  record.calibration = as_sent(record.calibration);
  record.calibrated_at = {16, 11, 15, 12, 47, 47};
  record.humidity_percent = 25;
  record.motor_rpm = 900;
  record.view_start_centideg = 4500;
  record.view_end_centideg = 31500;
  record.life_hours = 2685;
  record.echoes = StatusEchoes::last;
  record.warnings = kWarnLensDirty | kPulsePresent;
  record.power_level = 0xA3;
  return record;
}

TEST(VelodyneStatusRecord, DecodesWhatItEncoded) {
  for (const StatusFormat format : {StatusFormat::s2, StatusFormat::s3}) {
    StatusChannelBytes bytes{};
    encode(sample(format), bytes);
    const auto decoded = decode_status_record(bytes);
    ASSERT_TRUE(decoded.ok()) << decoded.fault().reason;
    EXPECT_EQ(*decoded, sample(format));
  }
}

TEST(VelodyneStatusRecord, BytesStandWhereTheManualPutsThem) {
  StatusRecord record = sample(StatusFormat::s3);
  record.calibration.lasers[1].vert_correction_deg = -8.77;  // 0xFC93
  record.calibration.lasers[1].dist_correction_m = 1.5;      // 0x05DC
  record.calibration.lasers[1].horiz_offset_m = -0.026;      // 0xFFE6
  record.calibration.lasers[1].focal_slope = 1.4;            // 14
  StatusChannelBytes bytes{};
  encode(record, bytes);
  const std::size_t laser = 7 + 28;
  EXPECT_EQ(bytes[0], 'U');
  EXPECT_EQ(bytes[4], '#');
  EXPECT_EQ(bytes[laser], 1);
  EXPECT_EQ(bytes[laser + 1], 0x93);
  EXPECT_EQ(bytes[laser + 2], 0xFC);
  EXPECT_EQ(bytes[laser + 5], 0xDC);
  EXPECT_EQ(bytes[laser + 6], 0x05);
  EXPECT_EQ(bytes[laser + 13], 0xE6);
  EXPECT_EQ(bytes[laser + 14], 0xFF);
  EXPECT_EQ(bytes[laser + 17], 14);
  EXPECT_EQ(bytes[laser + 21], record.warnings) << "W of cycle 9";
  EXPECT_EQ(bytes[256 * 7], 16) << "year of the calibration, cycle 257";
  EXPECT_EQ(bytes[256 * 7 + 6], 25) << "humidity";
  EXPECT_EQ(bytes[257 * 7], 900 & 0xFF);
  EXPECT_EQ(bytes[259 * 7 + 2], 1) << "last return, cycle 260";
  EXPECT_EQ(bytes[259 * 7 + 4], 0xA3);
  record.format = StatusFormat::s2;
  encode(record, bytes);
  EXPECT_EQ(bytes[1818] | bytes[1819] << 8, 1820) << "an S2 sends the length";
}

/// Long division of the message, sixteen zeros behind it, bit by bit.
std::uint16_t remainder(const std::vector<std::uint8_t>& message) {
  std::uint32_t rest = 0;
  const auto shift_in = [&rest](unsigned bit) {
    rest = (rest << 1U) | bit;
    rest ^= (rest & 0x10000U) != 0 ? 0x18005U : 0U;
  };
  for (const std::uint8_t byte : message) {
    for (unsigned bit = 8; bit-- > 0;) {
      shift_in((byte >> bit) & 1U);
    }
  }
  for (int i = 0; i < 16; ++i) {
    shift_in(0);
  }
  return static_cast<std::uint16_t>(rest);
}

TEST(VelodyneStatusRecord, CheckIsTheRemainderOfTheLasersBytes) {
  EXPECT_EQ(remainder({'1', '2', '3', '4', '5', '6', '7', '8', '9'}), 0xFEE8) << "the catalogue's";
  StatusChannelBytes bytes{};
  encode(sample(StatusFormat::s3), bytes);
  std::vector<std::uint8_t> covered;
  for (std::size_t i = 0; i < 64; ++i) {
    covered.insert(covered.end(), bytes.begin() + 8 + 28 * static_cast<std::ptrdiff_t>(i),
                   bytes.begin() + 28 + 28 * static_cast<std::ptrdiff_t>(i));
  }
  EXPECT_EQ(status_crc(bytes), remainder(covered));
  EXPECT_EQ(bytes[1818] | bytes[1819] << 8, remainder(covered));
}

TEST(VelodyneStatusRecord, RefusesADamagedOne) {
  StatusChannelBytes bytes{};
  encode(sample(StatusFormat::s3), bytes);
  EXPECT_TRUE(decode_status_record(std::span(bytes).first(1819)).incomplete());
  StatusChannelBytes flipped = bytes;
  flipped[7 + 30 * 28 + 5] ^= 1;
  ASSERT_TRUE(decode_status_record(flipped).malformed());
  EXPECT_EQ(decode_status_record(flipped).fault().offset, 1818U);
  StatusChannelBytes renumbered = bytes;
  renumbered[7] = 5;
  EXPECT_TRUE(decode_status_record(renumbered).malformed());
  bytes[0] = 'u';
  EXPECT_TRUE(decode_status_record(bytes).malformed());
}

TEST(VelodyneStatusChannel, CyclesCarryTimeThenSevenBytes) {
  const StatusChannel channel(sample(StatusFormat::s3));
  const StatusLive live{.hour = 13,
                        .minute = 14,
                        .second = 15,
                        .day = 16,
                        .month = 7,
                        .year = 18,
                        .gps = StatusGps::pulse_and_sentence,
                        .temperature_c = 41,
                        .version = 0x2A};
  const std::array<StatusByte, 16> first{{{'H', 13},
                                          {'M', 14},
                                          {'S', 15},
                                          {'D', 16},
                                          {'N', 7},
                                          {'Y', 18},
                                          {'G', 'A'},
                                          {'T', 41},
                                          {'V', 42},
                                          {'1', 'U'},
                                          {'2', 'N'},
                                          {'3', 'I'},
                                          {'4', 'T'},
                                          {'5', '#'},
                                          {'6', 24},
                                          {'7', 24}}};
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(channel.at(i, live), first[i]) << i;
    EXPECT_EQ(channel.at(i + 4160, live), first[i]) << "the whole set takes 4160 packets";
  }
  EXPECT_EQ(channel.at(4 * 16 + 9, live).type, 'W') << "cycle 5";
  EXPECT_EQ(channel.at(257 * 16 + 9, live).type, 0xFE) << "motor speed, cycle 258";
  EXPECT_EQ(channel.at(259 * 16 + 11, live).type, 0xF9) << "echoes, cycle 260";
  EXPECT_EQ(channel.at(259 * 16 + 13, live).type, 0xF8) << "power, cycle 260";
  const StatusChannel s2(sample(StatusFormat::s2));
  for (std::size_t i = 0; i < kStatusPeriod; ++i) {
    ASSERT_NE(s2.at(i, live).type, 'W');
  }
}

TEST(VelodyneStatusChannel, ReaderReassemblesTheRecordFromAnyStart) {
  for (const StatusFormat format : {StatusFormat::s2, StatusFormat::s3}) {
    const StatusChannel channel(sample(format));
    const StatusLive live{.hour = 23, .second = 59, .gps = StatusGps::pulse, .version = 7};
    for (const std::uint64_t start : {0, 1, 9, 12, 4159, 2000}) {
      StatusReader reader;
      int records = 0;
      for (std::uint64_t packet = start; packet < start + 2 * kStatusPeriod; ++packet) {
        if (const auto record = reader.add(channel.at(packet, live))) {
          EXPECT_EQ(*record, sample(format));
          ++records;
        }
      }
      EXPECT_EQ(records, start == 0 || start == 1 || start == 9 ? 2 : 1) << start;
      EXPECT_EQ(reader.live(), live);
    }
  }
}

TEST(VelodyneStatusChannel, ReaderWaitsForTheNextRecordAfterALoss) {
  const StatusChannel channel(sample(StatusFormat::s2));
  for (const std::uint64_t lost : {20U, 26U, 100U, 3000U, 4159U}) {
    StatusReader reader;
    int records = 0;
    for (std::uint64_t packet = 0; packet < 2 * kStatusPeriod; ++packet) {
      if (packet != lost) {
        records += reader.add(channel.at(packet, {})) ? 1 : 0;
      }
    }
    EXPECT_EQ(records, 1) << lost;
    EXPECT_EQ(reader.rejected(), 1U) << lost;
  }
}

TEST(VelodyneStatusChannel, RefusesACalibrationOf31Lasers) {
  StatusRecord record = sample(StatusFormat::s2);
  record.calibration.lasers.resize(31);
  EXPECT_THROW(StatusChannel{record}, std::invalid_argument);
}

}  // namespace
}  // namespace rigwire::protocols::velodyne
