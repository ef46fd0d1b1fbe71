#include "hil/files/gps_alignment.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include "hil/files/replay_source.h"
#include "protocols/pcapng/link_packet.h"
#include "protocols/pcapng/pcapng.h"
#include "protocols/velodyne/position_packet.h"

namespace rigwire::hil {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;
namespace pcapng = protocols::pcapng;

/// 2026-06-01T08:00:00Z.
constexpr std::int64_t kEight_ns = 1'780'300'800'000'000'000;
constexpr std::int64_t kSecond_ns = 1'000'000'000;

std::string sentence(const std::string& body) {
  unsigned sum = 0;
  for (const char letter : body) {
    sum ^= static_cast<unsigned char>(letter);
  }
  return fmt::format("${}*{:02X}\r\n", body, sum);
}

std::string rmc(const std::string& time, char status = 'A') {
  return sentence(
      fmt::format("GPRMC,{},{},4925.482,N,00745.102,E,0.0,0.0,010626,,,A", time, status));
}

class GpsAlignments : public testing::Test {
 protected:
  GpsAlignments() {
    std::string pattern = "/tmp/rigwire-test-XXXXXX";
    folder_ = ::mkdtemp(pattern.data());
  }
  ~GpsAlignments() override { fs::remove_all(folder_); }

  ReplaySourceSettings file(const std::string& name, const std::string& content) const {
    std::ofstream(folder_ / name, std::ios::binary) << content;
    ReplaySourceSettings settings;
    settings.file = (folder_ / name).string();
    return settings;
  }
  /// A recording of three position packets, each late by another time, with stamps of the
  /// recorder's clock.
  ReplaySourceSettings lidar(const std::string& name, std::int64_t recorder_ahead_ns,
                             std::int64_t first_utc_ns, const std::string& time) const {
    pcapng::Bytes bytes;
    pcapng::append(bytes, pcapng::Section{"test", ""});
    pcapng::append(bytes, pcapng::Interface{pcapng::LinkType::ethernet, "eth0", ""});
    for (const std::int64_t late_ns : {900'000, 40'000, 500'000}) {
      protocols::velodyne::PositionPacket packet;
      packet.timestamp_us = static_cast<std::uint32_t>(first_utc_ns % (3600 * kSecond_ns) / 1000);
      packet.set_sentence(rmc(time));
      std::array<std::uint8_t, protocols::velodyne::kPositionPacketSize> datagram{};
      encode(packet, datagram);
      pcapng::Bytes frame;
      pcapng::append_udp(frame, {0xC0A801C9, 8308}, {0xFFFFFFFF, 8308}, datagram);
      pcapng::Packet laid;
      laid.time_ns = static_cast<std::uint64_t>(first_utc_ns + late_ns + recorder_ahead_ns);
      laid.bytes = frame;
      pcapng::append(bytes, laid);
      first_utc_ns += 1'000'000;
    }
    return file(name, std::string(bytes.begin(), bytes.end()));
  }
  static std::string refusal(const ReplaySourceSettings& settings) {
    try {
      (void)find_gps_alignment(settings);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "taken";
  }

  fs::path folder_;
};

TEST_F(GpsAlignments, ALogWithoutStampsIsByTheDateInIt) {
  const auto found = find_gps_alignment(
      file("a.nmea", rmc("080001.00", 'V') + rmc("080002.00") + rmc("080003.00")));
  // Its own count is the time of the day: ahead of it is the day.
  EXPECT_EQ(found.ahead_ns, kEight_ns - 8 * 3600 * kSecond_ns);
  EXPECT_EQ(found.by, "RMC");
  EXPECT_EQ(found.told, 2U);
}

TEST_F(GpsAlignments, StampsOfAnotherClockAreShiftedByTheLeastDelayOfASentence) {
  // The recorder's zero is at 07:59:50.25; messages leave 90, 30 and 60 ms late, in two pieces.
  const std::string first = rmc("080000.00");
  const std::string second = rmc("080001.00");
  const std::string third = rmc("080002.00");
  std::string index;
  std::size_t at = 0;
  const auto put = [&](const char* time, std::size_t length) {
    index += fmt::format("{} > {} {}\n", time, at, length);
    at += length;
  };
  put("9.800000000", 10);
  put("9.840000000", first.size() - 10);
  put("10.780000000", second.size());
  put("11.810000000", third.size());
  (void)file("a.index", index);
  const auto found = find_gps_alignment(file("a.bytes", first + second + third));
  EXPECT_EQ(found.ahead_ns, kEight_ns - 10 * kSecond_ns + 250'000'000 - 30'000'000);
  EXPECT_EQ(found.told, 3U);
}

TEST_F(GpsAlignments, AVelodynesHourIsThatOfItsSentenceAlsoWhereTheHourTurns) {
  const auto found = find_gps_alignment(
      lidar("a.pcapng", -5 * kSecond_ns, kEight_ns + 2 * kSecond_ns, "080002.00"));
  EXPECT_EQ(found.ahead_ns, 5 * kSecond_ns - 40'000);
  EXPECT_EQ(found.by, "Velodyne position packets");
  // Microseconds of the new hour, a sentence of the second before it.
  const auto turned = find_gps_alignment(lidar("b.pcapng", 0, kEight_ns + 5'000'000, "075959.00"));
  EXPECT_EQ(turned.ahead_ns, -40'000);
}

TEST_F(GpsAlignments, FramesAreByTheirStampsSince1970) {
  const auto found = find_gps_alignment(file("a.log", "(1780300800.250000) can0 18FEF100#01\n"));
  EXPECT_EQ(found.ahead_ns, 0);
  EXPECT_EQ(found.first_utc_ns, kEight_ns + 250'000'000);
  EXPECT_THAT(refusal(file("b.log", "(12.250000) can0 18FEF100#01\n")),
              HasSubstr("it has no GPS time with a date"));
}

TEST_F(GpsAlignments, AFileWithoutADateIsRefused) {
  const std::string gga =
      sentence("GPGGA,080000.00,4925.482,N,00745.102,E,1,08,1.0,240.0,M,48.0,M,,");
  EXPECT_THAT(refusal(file("a.nmea", gga)), HasSubstr("RMC, ZDA"));
  EXPECT_THAT(refusal(file("b.nmea", rmc("080000.00", 'V'))), HasSubstr("that has a fix"));
  std::string wrong = rmc("080000.00");
  wrong[10] = '9';  // its checksum no longer holds
  EXPECT_THAT(refusal(file("c.nmea", wrong)), HasSubstr("it has no times"));
}

TEST_F(GpsAlignments, TwoRecordersArePlayedInStep) {
  // One clock 5 s late, the other counting from its own start: both files hold 08:00:02.
  const auto one = lidar("a.pcapng", -5 * kSecond_ns, kEight_ns + 2 * kSecond_ns, "080002.00");
  (void)file("b.index", fmt::format("7.000000000 > 0 {}\n", rmc("080002.00").size()));
  const auto other = file("b.bytes", rmc("080002.00"));
  const auto due = [](const ReplaySourceSettings& settings) {
    ReplaySource source(settings, kEight_ns - find_gps_alignment(settings).ahead_ns);
    return source.next()->due.time_since_epoch().count();
  };
  EXPECT_NEAR(static_cast<double>(due(one)), 2e9, 1e6);
  EXPECT_EQ(due(other), 2 * kSecond_ns);
}

}  // namespace
}  // namespace rigwire::hil
