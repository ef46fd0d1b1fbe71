// What files are played, and when.
#include "hil/files/replay_source.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <utility>

#include "drivers/endpoints.h"
#include "protocols/bytes.h"
#include "protocols/nmea/sentence.h"
#include "protocols/pcapng/link_packet.h"
#include "protocols/pcapng/pcap.h"
#include "protocols/ubx/layout.h"
#include "protocols/ubx/navigation.h"

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

  static std::string nmea(const std::string& body) {
    std::array<char, 8> end{};
    std::snprintf(end.data(), end.size(), "*%02X\r\n", protocols::nmea::checksum(body));
    return "$" + body + end.data();
  }
  template <class Message>
  static std::string ubx(const Message& message) {
    const auto frame = protocols::ubx::encode(message);
    return std::string(frame.begin(), frame.end());
  }
  /// NAV-PVT of a second of the week that began on Sunday, 29 November 2026; leap seconds are 18.
  static std::string nav_pvt(unsigned second_of_week) {
    protocols::ubx::NavPvt92 message;
    message.time_of_week_ms = second_of_week % 604'800 * 1000;
    const std::chrono::sys_seconds utc = std::chrono::sys_days(std::chrono::year{2026} / 11 / 29) +
                                         std::chrono::seconds{second_of_week} - 18s;
    const auto day = std::chrono::floor<std::chrono::days>(utc);
    const std::chrono::year_month_day date(day);
    const std::chrono::hh_mm_ss time(utc - day);
    message.year = static_cast<std::uint16_t>(static_cast<int>(date.year()));
    message.month = static_cast<std::uint8_t>(static_cast<unsigned>(date.month()));
    message.day = static_cast<std::uint8_t>(static_cast<unsigned>(date.day()));
    message.hour = static_cast<std::uint8_t>(time.hours().count());
    message.minute = static_cast<std::uint8_t>(time.minutes().count());
    message.second = static_cast<std::uint8_t>(time.seconds().count());
    message.valid = 3;
    return ubx(message);
  }
  /// From the first unit to the last, and how many there are.
  std::pair<double, std::uint64_t> extent(const std::string& name, const std::string& content) {
    ReplaySourceSettings settings = file(name, content);
    settings.baud = 115'200;
    const ReplaySource source(settings);
    return {to_seconds(source.summary().length), source.summary().units};
  }

  fs::path folder_;
};

TEST_F(ReplaySources, WhatComesBeforeTheFirstTimeComesJustBeforeIt) {
  const std::string whole =
      nmea("GPGGA,100000.00,,,,,0") + nmea("GPGGA,100001.00,,,,,0") + nmea("GPGGA,100002.00,,,,,0");
  EXPECT_NEAR(extent("whole.nmea", whole).first, 2.0, 0.001);
  const auto [length_s, units] = extent("mid.nmea", nmea("GPGSV,1,1,00") + whole);
  EXPECT_EQ(units, 4U);
  EXPECT_GT(length_s, 2.0);
  EXPECT_LT(length_s, 2.01);
}

TEST_F(ReplaySources, AWeekAndADayTurnOver) {
  std::string week;
  for (unsigned i = 0; i < 8; ++i) {
    week += nav_pvt(604'797 + i);
  }
  EXPECT_EQ(extent("week.ubx", week), std::pair(7.0, std::uint64_t{8}));
  std::string alone;  // messages that tell the time of week alone
  for (unsigned i = 0; i < 8; ++i) {
    protocols::ubx::NavPosllh message;
    message.time_of_week_ms = (604'797 + i) % 604'800 * 1000;
    alone += ubx(message);
  }
  EXPECT_EQ(extent("alone.ubx", alone), std::pair(7.0, std::uint64_t{8}));
  std::string undated;
  for (const char* time : {"235958", "235959", "000000", "000001"}) {
    undated += nmea("GPGGA," + std::string(time) + ".00,,,,,0");
  }
  EXPECT_EQ(extent("day.nmea", undated), std::pair(3.0, std::uint64_t{4}));
}

TEST_F(ReplaySources, ALeapSecondIsASecond) {
  std::string log;
  for (const char* time : {"235958", "235959", "235960", "000000", "000001"}) {
    log += nmea("GPGGA," + std::string(time) + ".00,,,,,0");
  }
  EXPECT_EQ(extent("undated.nmea", log), std::pair(4.0, std::uint64_t{5}));
  log.clear();
  for (const char* time :
       {"235958.00,A,,,,,,,311216", "235959.00,A,,,,,,,311216", "235960.00,A,,,,,,,311216",
        "000000.00,A,,,,,,,010117", "000001.00,A,,,,,,,010117"}) {
    log += nmea("GPRMC," + std::string(time));
  }
  EXPECT_EQ(extent("dated.nmea", log), std::pair(4.0, std::uint64_t{5}));
}

TEST_F(ReplaySources, TimeOfDayAndTimeOfWeekAreOneClock) {
  for (const unsigned begin :
       {259'200U + 3600U, 10U}) {  // a Wednesday, and a Sunday's first minute
    std::string log;
    std::string positions;
    for (unsigned i = 0; i < 5; ++i) {
      const unsigned utc = (begin + i + 86'400 - 18) % 86'400;
      std::array<char, 32> time{};
      std::snprintf(time.data(), time.size(), "%02u%02u%02u.00", utc / 3600, utc / 60 % 60,
                    utc % 60);
      const std::string gga = nmea("GNGGA," + std::string(time.data()) + ",,,,,0");
      protocols::ubx::NavPosllh position;
      position.time_of_week_ms = (begin + i) * 1000;
      log += gga + nav_pvt(begin + i);
      positions += gga + ubx(position);
    }
    for (const std::string& content : {log, positions}) {
      const auto [length_s, units] = extent("mixed.ubx", content);
      EXPECT_EQ(units, 10U);
      EXPECT_NEAR(length_s, 4.0, 0.02);
    }
  }
}

// Before it knows the leap seconds a receiver tells GPS time as UTC.
TEST_F(ReplaySources, AReceiverThatDoesNotKnowTheLeapSecondsIsOfTheSameEpoch) {
  std::string log;
  for (unsigned i = 0; i < 5; ++i) {
    protocols::ubx::NavPvt92 message;
    message.time_of_week_ms = (288'018 + i) * 1000;
    message.year = 2026;
    message.month = 12;
    message.day = 2;
    message.hour = 8;
    message.second = static_cast<std::uint8_t>(18 + i);
    message.valid = 3;
    log += nmea("GNGGA,08000" + std::to_string(i) + ".00,,,,,0") + ubx(message);
  }
  const auto [length_s, units] = extent("unresolved.ubx", log);
  EXPECT_EQ(units, 10U);
  EXPECT_NEAR(length_s, 4.0, 0.02);
}

TEST_F(ReplaySources, ADateThatIsCorrectedTakesNoTime) {
  const auto [length_s, units] = extent("date.nmea", nmea("GPRMC,100000.00,V,,,,,,,060180") +
                                                         nmea("GPRMC,100001.00,A,,,,,,,281126") +
                                                         nmea("GPRMC,100002.00,A,,,,,,,281126"));
  EXPECT_NEAR(length_s, 2.0, 1e-9);
}

TEST_F(ReplaySources, DamagedMessagesArePlayedWithoutTheirTimeAndCounted) {
  ReplaySourceSettings settings =
      file("damaged.nmea", nmea("GPGGA,100000.00,,,,,0") + "$GPGGA,230000.00,,,,,0*00\r\n" +
                               nmea("GPGGA,100001.00,,,,,0"));
  settings.baud = 115'200;
  const ReplaySource source(settings);
  EXPECT_EQ(source.summary().units, 3U);
  EXPECT_NEAR(to_seconds(source.summary().length), 1.0, 0.001);
  EXPECT_THAT(text_of_notes(source.summary().notes), HasSubstr("byte of no intact message"));
}

TEST_F(ReplaySources, AMessageOutOfOrderIsNotANewDay) {
  const auto [length_s, units] =
      extent("order.nmea", nmea("GPGGA,100001.00,,,,,0") + nmea("GPRMC,100000.00,A") +
                               nmea("GPGGA,100002.00,,,,,0"));
  EXPECT_EQ(units, 3U);
  EXPECT_NEAR(length_s, 1.0, 0.01);
}

TEST_F(ReplaySources, LinesOfCandumpThatAreNotPlayedAreCountedByKind) {
  const ReplaySource source(file("four.log",
                                 "(1.000000) can0 123#1122334455667788_9\n"
                                 "(1.010000) can0 123##011223344\n"
                                 "(1.020000) can0 123#11\n"
                                 "(1.030000) can0 20000004#0000000000000000\n"
                                 "(1.040000) can0 124#22 T\n"));
  EXPECT_EQ(source.summary().units, 2U);
  EXPECT_EQ(source.summary().length, 20ms);
  EXPECT_EQ(text_of_notes(source.summary().notes),
            "1 x CAN FD frame, 1 x error frame, 1 x frame that the recorder's own host sent (T)");
  EXPECT_THAT(refusal(file("none.log", "(1.0) can0 123##011223344\n")),
              HasSubstr("nothing in it can be played (source.wire, direction, filter, start, end), "
                        "found 1 x CAN FD frame"));
}

TEST_F(ReplaySources, ALogOfTwoBusesIsRefusedUnlessOneIsNamed) {
  ReplaySourceSettings settings =
      file("two.log", "(1.0) can0 123#11\n(1.1) can1 124#22\n(1.2) can0 125#33\n");
  EXPECT_THAT(refusal(settings), HasSubstr("several wires, found \"can0\" and \"can1\""));
  settings.wire = "can0";
  EXPECT_EQ(ReplaySource(settings).summary().units, 2U);
  settings.wire = "can7";
  EXPECT_THAT(refusal(settings), HasSubstr("no such wire, found \"can7\", allowed can0, can1"));
}

TEST_F(ReplaySources, DirectionsOfOthersAreNotOurs) {
  const auto capture = [&](const std::string& application) {
    pcapng::Bytes bytes;
    pcapng::append(bytes, pcapng::Section{application, ""});
    pcapng::append(bytes, pcapng::Interface{pcapng::LinkType::socketcan, "can", ""});
    for (const auto direction : {pcapng::Direction::inbound, pcapng::Direction::outbound}) {
      const auto packet = pcapng::can_packet(
          protocols::can::Frame{direction == pcapng::Direction::inbound ? 0x100U : 0x200U});
      pcapng::Packet captured;
      captured.bytes = packet;
      captured.direction = direction;
      pcapng::append(bytes, captured);
    }
    return std::string(bytes.begin(), bytes.end());
  };
  ReplaySource ours(file("ours.pcapng", capture("rigwire 0.1.0")));
  EXPECT_EQ(ours.summary().units, 1U) << "what a client sent is no part of it";
  EXPECT_EQ(ours.next()->frame.id, 0x200U);
  ReplaySourceSettings settings = file("theirs.pcapng", capture("Dumpcap"));
  EXPECT_EQ(ReplaySource(settings).summary().units, 2U);
  settings.direction = ReplayedDirection::inbound;
  ReplaySource inbound(settings);
  EXPECT_EQ(inbound.next()->frame.id, 0x100U);
  EXPECT_EQ(inbound.next(), nullptr);
  EXPECT_THAT(text_of_notes(inbound.summary().notes), HasSubstr("other direction"));
}

TEST_F(ReplaySources, APacketThatWasCutIsNotPlayed) {
  pcapng::Bytes bytes;
  pcapng::append(bytes, pcapng::Section{"", ""});
  pcapng::append(bytes, pcapng::Interface{pcapng::LinkType::socketcan, "can", ""});
  const auto packet = pcapng::can_packet(protocols::can::Frame{0x100U});
  pcapng::Packet captured;
  captured.bytes = packet;
  pcapng::append(bytes, captured);
  captured.original_length = 72;
  pcapng::append(bytes, captured);
  const ReplaySource source(file("cut.pcapng", std::string(bytes.begin(), bytes.end())));
  EXPECT_EQ(source.summary().units, 1U);
  EXPECT_EQ(text_of_notes(source.summary().notes), "1 x packet that the recorder cut");
}

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
      file("gnss.nmea", nmea("GPRMC,235959.00,A") + nmea("GPGSV,1") + nmea("GPRMC,000000.00,A"));
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
  EXPECT_THAT(refusal(file("text", "no clock\n")), HasSubstr("it has no times"));
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
