// What files are played, and when.
#include "hil/files/replay_source.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include "drivers/endpoints.h"
#include "protocols/bytes.h"
#include "protocols/pcapng/link_packet.h"
#include "protocols/pcapng/pcap.h"

namespace rigwire::hil {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;
namespace pcapng = protocols::pcapng;
using testing::HasSubstr;

class ReplaySources : public testing::Test {
 protected:
  ReplaySources() {
    std::string pattern = "/tmp/rigwire-test-XXXXXX";
    folder_ = ::mkdtemp(pattern.data());
  }
  ~ReplaySources() override { fs::remove_all(folder_); }

  ReplaySourceSettings file(const std::string& name, const std::string& content) const {
    std::ofstream(folder_ / name, std::ios::binary) << content;
    ReplaySourceSettings settings;
    settings.file = (folder_ / name).string();
    return settings;
  }
  static std::string refusal(const ReplaySourceSettings& settings) {
    try {
      const ReplaySource source(settings);
    } catch (const std::exception& error) {
      return error.what();
    }
    return "taken";
  }
  /// A datagram in a capture of the older format, with nanoseconds, big-endian.
  static std::string pcap(pcapng::LinkType link, const std::string& in_front,
                          std::uint32_t second) {
    pcapng::Bytes packet;
    const std::uint8_t byte = 0x5A;
    pcapng::append_udp(packet, {0xC0A801C9, 2368}, {0xFFFFFFFF, 2368}, {&byte, 1});
    constexpr std::size_t kEthernet = 14;
    const std::string content = in_front + std::string(packet.begin() + kEthernet, packet.end());
    const auto word = [](std::uint32_t value) {
      std::array<std::uint8_t, 4> bytes{};
      protocols::store_big<std::uint32_t>(bytes, 0, value);
      return std::string(bytes.begin(), bytes.end());
    };
    const auto size = static_cast<std::uint32_t>(content.size());
    return word(0xA1B23C4D) + word(0x00020004) + word(0) + word(0) + word(65535) +
           word(static_cast<std::uint32_t>(link)) + word(second) + word(123'456'789) + word(size) +
           word(size) + content;
  }

  fs::path folder_;
};

TEST_F(ReplaySources, AnHourOfFramesDoesNotDriftByANanosecond) {
  std::string log;
  for (int i = 0; i <= 36'000; ++i) {  // 10 Hz
    const std::int64_t us = 1'780'300'800'000'001 + 100'000LL * i + i % 7;
    log += "(" + std::to_string(us / 1'000'000) + "." +
           std::to_string(1'000'000 + us % 1'000'000).substr(1) + ") can 123#00\n";
  }
  ReplaySourceSettings settings = file("can.log", log);
  settings.speed = 3.0;
  ReplaySource source(settings);
  ASSERT_EQ(source.summary().units, 36'001U);
  for (std::int64_t i = 0; i <= 36'000; ++i) {
    const ReplayedUnit* unit = source.next();
    ASSERT_NE(unit, nullptr);
    const std::int64_t played_ns = (100'000'000 * i + i % 7 * 1000) * 1000 / 3000;
    EXPECT_NEAR(static_cast<double>((unit->due - kStart).count() - played_ns), 0.0, 1.0) << i;
  }
  EXPECT_EQ(source.next(), nullptr);
}

TEST_F(ReplaySources, ALoopBeginsAgainAfterItsLengthAndGapsAreCut) {
  ReplaySourceSettings settings =
      file("can.log", "(10.0) can 001#\n(10.5) can 002#\n(20.5) can 003#\n");
  settings.loop = true;
  settings.gaps = ReplayedGaps::cut;
  ReplaySource source(settings);
  std::vector<std::int64_t> due_ms;
  for (int i = 0; i < 5; ++i) {
    due_ms.push_back((source.next()->due - kStart) / 1ms);
  }
  // 1.5 s and a mean gap.
  EXPECT_THAT(due_ms, testing::ElementsAre(0, 500, 1500, 2250, 2750));
}

TEST_F(ReplaySources, DatagramsAreFoundOnEveryLink) {
  const std::string ip("\x08\x00", 2);
  const std::string mac(12, '\0');
  const std::vector<std::pair<pcapng::LinkType, std::string>> links{
      {pcapng::LinkType::ethernet, mac + ip},
      {pcapng::LinkType::ethernet, mac + std::string("\x81\x00\x00\x05", 4) + ip},
      {pcapng::LinkType::raw_ip, ""},
      {pcapng::LinkType::linux_cooked, std::string(14, '\0') + ip},
      {pcapng::LinkType::linux_cooked_2, ip + std::string(18, '\0')}};
  for (const auto& [link, in_front] : links) {
    ReplaySource source(file("drive.pcap", pcap(link, in_front, 100)));
    const ReplayedUnit* unit = source.next();
    ASSERT_NE(unit, nullptr) << static_cast<int>(link);
    EXPECT_EQ(unit->bytes, std::vector<std::uint8_t>{0x5A});
    EXPECT_EQ(unit->to.port, 2368);
  }
  ReplaySourceSettings other = file("drive.pcap", pcap(pcapng::LinkType::raw_ip, "", 100));
  other.from_address = "192.168.1.77";
  EXPECT_THAT(refusal(other), HasSubstr("nothing in it can be played"));
  other.from_address = "192.168.1.201";
  EXPECT_EQ(refusal(other), "taken");
}

TEST_F(ReplaySources, ATruncatedCapturePlaysWhatIsWhole) {
  const std::string whole = pcap(pcapng::LinkType::raw_ip, "", 100);
  const ReplaySource source(file("drive.pcap", whole + whole.substr(pcapng::kPcapHead, 20)));
  EXPECT_EQ(source.summary().units, 1U);
  EXPECT_TRUE(source.summary().truncated);
}

TEST_F(ReplaySources, ALogWithoutInstantsGoesByItsOwnClockAcrossMidnight) {
  ReplaySourceSettings settings =
      file("gnss.nmea", "$GPRMC,235959.00,A*00\r\n$GPGSV,1*00\r\n$GPRMC,000000.00,A*00\r\n");
  settings.baud = 9600;
  ReplaySource source(settings);
  const SimTime first = source.next()->due;
  const SimTime second = source.next()->due;
  const SimTime third = source.next()->due;
  EXPECT_EQ(second - first, Duration{13 * (10'000'000'000 / 9600)});  // bytes of ten bits
  EXPECT_EQ(third - first, 1s);
}

TEST_F(ReplaySources, WhatCannotBePlayedIsRefusedWithItsReason) {
  EXPECT_THAT(refusal(file("empty", "")), HasSubstr("empty"));
  EXPECT_THAT(refusal(file("text", "no clock\n")), HasSubstr("nothing tells when"));
  EXPECT_THAT(refusal(file("back.log", "(10.0) can 001#\n(8.5) can 001#\n")),
              HasSubstr("time goes back by 1.5"));
  EXPECT_THAT(refusal(file("bad.log", "(10.0) can 001#\nnonsense\n(11.0) can 001#\n")),
              HasSubstr("line 2"));
  ReplaySourceSettings none;
  none.file = (folder_ / "none").string();
  EXPECT_THAT(refusal(none), HasSubstr("No such file"));
}

TEST_F(ReplaySources, OneOfTwoWiresOfACaptureIsChosenByItsName) {
  pcapng::Bytes bytes;
  pcapng::append(bytes, pcapng::Section{"test", ""});
  for (const char* name : {"can", "body"}) {
    pcapng::append(bytes, pcapng::Interface{pcapng::LinkType::socketcan, name, ""});
  }
  for (const std::uint32_t wire : {0U, 1U}) {
    const auto packet = pcapng::can_packet(protocols::can::Frame{0x100U + wire});
    pcapng::Packet captured;
    captured.interface = wire;
    captured.time_ns = 5;
    captured.bytes = packet;
    pcapng::append(bytes, captured);
  }
  ReplaySourceSettings settings = file("all.pcapng", std::string(bytes.begin(), bytes.end()));
  EXPECT_THAT(refusal(settings), HasSubstr("several wires that fit, found \"can\" and \"body\""));
  settings.wire = "chassis";
  EXPECT_THAT(refusal(settings), HasSubstr("no such wire, found \"chassis\", allowed body, can"));
  settings.wire = "body";
  ReplaySource source(settings);
  EXPECT_EQ(source.next()->frame.id, 0x101U);
}

}  // namespace
}  // namespace rigwire::hil
