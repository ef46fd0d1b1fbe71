// ubxtool (Debian's gpsd-clients) on the receiver's line: every poll that a u-blox 7 answers is
// decoded by it, what it sets is in force, and the same through the daemon.
//
// The program is a required dependency: without it these tests fail. Every wait is bounded.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "child_process.h"
#include "live_receiver.h"
#include "private_wires.h"

namespace rigwire {
namespace {

using namespace std::chrono_literals;
using test::ChildProcess;
using test::LiveReceiver;
using testing::HasSubstr;
using testing::Not;

class Ubxtool : public testing::Test {
 protected:
  static constexpr std::uint32_t kBaud = 115'200;
  [[nodiscard]] static emulators::UbloxSettings settings() {
    emulators::UbloxSettings quick;
    quick.baud = kBaud;
    return quick;
  }
  [[nodiscard]] std::filesystem::path file(const std::string& name) const {
    return wires_.folder / name;
  }
  /// What it prints of requests and answers, sentences left out.
  [[nodiscard]] std::string run(const std::vector<std::string>& words) {
    ChildProcess tool(words, file("ubxtool.log"));
    EXPECT_EQ(tool.wait(20s), 0) << tool.output();
    std::istringstream lines(tool.output());
    std::string text;
    sentences_ = 0;
    for (std::string line; std::getline(lines, line);) {
      if (line.starts_with("$G")) {
        ++sentences_;
      } else {
        text += line + "\n";
      }
    }
    EXPECT_THAT(text, Not(HasSubstr("Traceback")));
    EXPECT_THAT(text, Not(HasSubstr("Bad Length")));
    EXPECT_THAT(text, Not(HasSubstr("invalid")));
    return text;
  }
  [[nodiscard]] std::string ask(const std::vector<std::string>& more, const std::string& wait = "1",
                                std::uint32_t baud = kBaud, const std::string& protocol = "14") {
    std::vector<std::string> words{"ubxtool", "-f",     wires_.gnss(), "-s", std::to_string(baud),
                                   "-P",      protocol, "-v",          "2",  "-w",
                                   wait};
    words.insert(words.end(), more.begin(), more.end());
    return run(words);
  }
  /// Names of the messages that were decoded, requests left out.
  [[nodiscard]] static std::set<std::string> answers(const std::string& text) {
    std::set<std::string> found;
    std::istringstream lines(text);
    std::string title;
    for (std::string line; std::getline(lines, line);) {
      if (!title.empty() && !line.empty() && line.find("Poll request") == std::string::npos) {
        found.insert(title);
      }
      title = line.starts_with("UBX-") ? line.substr(0, line.find(':')) : "";
    }
    return found;
  }
  /// Polls them all at once and expects each to be decoded.
  void expect_answers(const std::vector<std::string>& names) {
    std::vector<std::string> words;
    for (const std::string& name : names) {
      words.push_back("-p");
      words.push_back(name);
    }
    const std::string text = ask(words, "2");
    const auto found = answers(text);
    for (const std::string& name : names) {
      EXPECT_TRUE(found.contains("UBX-" + name)) << name << " is not answered";
      if (name.starts_with("CFG-")) {
        EXPECT_THAT(text, HasSubstr("(" + name.substr(4) + ")"));
      }
    }
    EXPECT_THAT(text, Not(HasSubstr("ACK-NAK")));
  }

  test::PrivateWires wires_;
  int sentences_ = 0;
};

TEST_F(Ubxtool, ReadsTheWholeConfiguration) {
  LiveReceiver receiver(settings(), wires_.gnss());
  ASSERT_TRUE(receiver.awake());
  expect_answers({"CFG-ANT", "CFG-DAT", "CFG-GNSS", "CFG-INF", "CFG-ITFM", "CFG-LOGFILTER",
                  "CFG-NAV5", "CFG-NAVX5", "CFG-NMEA", "CFG-PM2", "CFG-PRT", "CFG-RATE", "CFG-RINV",
                  "CFG-RXM", "CFG-SBAS", "CFG-TP5", "CFG-USB"});
}

TEST_F(Ubxtool, ReadsTheNavigationMessages) {
  LiveReceiver receiver(settings(), wires_.gnss());
  ASSERT_TRUE(receiver.awake());
  expect_answers({"NAV-AOPSTATUS", "NAV-CLOCK", "NAV-DGPS", "NAV-DOP", "NAV-POSECEF", "NAV-POSLLH",
                  "NAV-PVT", "NAV-SBAS", "NAV-SOL", "NAV-STATUS", "NAV-SVINFO", "NAV-TIMEGPS",
                  "NAV-TIMEUTC", "NAV-VELECEF", "NAV-VELNED"});
}

TEST_F(Ubxtool, ReadsTheMonitorsAndTheVersion) {
  LiveReceiver receiver(settings(), wires_.gnss());
  ASSERT_TRUE(receiver.awake());
  expect_answers({"MON-VER", "MON-HW", "MON-HW2", "MON-IO", "MON-MSGPP", "MON-RXBUF", "MON-TXBUF"});
  const std::string version = ask({"-p", "MON-VER"});
  for (const char* line :
       {"swVersion 1.00 (71863)", "hwVersion 00070000", "extension PROTVER 14.00",
        "extension MOD NEO-7P-0", "extension GPS;SBAS;GLO;QZSS"}) {
    EXPECT_THAT(version, HasSubstr(line));
  }
}

TEST_F(Ubxtool, WhatCameWithLaterProtocolsIsRefused) {
  LiveReceiver receiver(settings(), wires_.gnss());
  ASSERT_TRUE(receiver.awake());
  const std::string text = ask({"-p", "CFG-TMODE2", "-p", "CFG-ODO"});
  EXPECT_THAT(text, HasSubstr("UBX-ACK-NAK:\n  NAK to Class x06 (CFG) ID x3d (TMODE2)"));
  EXPECT_THAT(text, HasSubstr("UBX-ACK-NAK:\n  NAK to Class x06 (CFG) ID x1e (ODO)"));
}

TEST_F(Ubxtool, SetsRateAndModelAndBothAreInForce) {
  LiveReceiver receiver(settings(), wires_.gnss());
  ASSERT_TRUE(receiver.awake());
  EXPECT_THAT(ask({"-p", "CFG-RATE,200"}, "0.6"),
              HasSubstr("UBX-ACK-ACK:\n  ACK to Class x06 (CFG) ID x08 (RATE)"));
  EXPECT_THAT(ask({"-p", "MODEL,4"}, "0.6"),
              HasSubstr("UBX-ACK-ACK:\n  ACK to Class x06 (CFG) ID x24 (NAV5)"));
  const std::string text = ask({"-p", "CFG-RATE", "-p", "CFG-NAV5"}, "2");
  EXPECT_THAT(text, HasSubstr("measRate 200 navRate 1"));
  EXPECT_THAT(text, HasSubstr("dynModel 4"));
  EXPECT_GE(sentences_, 8 * 8) << "eight sentences an epoch, five epochs a second";
}

TEST_F(Ubxtool, SwitchesSentencesOffAndMessagesOn) {
  LiveReceiver receiver(settings(), wires_.gnss());
  ASSERT_TRUE(receiver.awake());
  static_cast<void>(ask({"-d", "NMEA", "-e", "BINARY"}, "1"));
  const auto found = answers(ask({}, "1.5"));
  EXPECT_EQ(sentences_, 0);
  for (const char* name : {"UBX-NAV-SOL", "UBX-NAV-SVINFO", "UBX-NAV-DOP", "UBX-NAV-TIMEGPS"}) {
    EXPECT_TRUE(found.contains(name)) << name;
  }
  static_cast<void>(ask({"-d", "BINARY", "-e", "NMEA"}, "1"));
  EXPECT_FALSE(answers(ask({}, "1.5")).contains("UBX-NAV-SOL"));
  EXPECT_GE(sentences_, 8);
}

TEST_F(Ubxtool, ChangesTheSpeed) {
  LiveReceiver receiver(settings(), wires_.gnss());
  ASSERT_TRUE(receiver.awake());
  static_cast<void>(ask({"-S", "38400"}, "1"));
  EXPECT_EQ(receiver.state().baud, 38'400U);
  EXPECT_THAT(ask({"-p", "CFG-PRT"}, "1.5", 38'400), HasSubstr("baudRate 38400"));
  EXPECT_GE(sentences_, 4);
}

TEST_F(Ubxtool, AColdBootBeginsWithTheBanner) {
  LiveReceiver receiver(settings(), wires_.gnss());
  ASSERT_TRUE(receiver.awake());
  ChildProcess tool({"ubxtool", "-f", wires_.gnss(), "-s", std::to_string(kBaud), "-P", "14", "-v",
                     "2", "-w", "3", "-p", "COLDBOOT"},
                    file("cold.log"));
  ASSERT_EQ(tool.wait(10s), 0);
  EXPECT_THAT(tool.output(), HasSubstr("$GPTXT,01,01,02,u-blox ag - www.u-blox.com*50"));
  EXPECT_THAT(tool.output(), HasSubstr("$GPTXT,01,01,02,MOD NEO-7P-0*38"));
  EXPECT_THAT(tool.output(), HasSubstr("$GPRMC,,V,,,,,,,,,,N*53"));
  EXPECT_EQ(receiver.state().counters.resets, 1U);
}

TEST_F(Ubxtool, SetsAndReadsItemsOfTheF9p) {
  emulators::UbloxSettings precise = settings();
  precise.profile = &emulators::ublox_zed_f9p();
  LiveReceiver receiver(precise, wires_.gnss());
  ASSERT_TRUE(receiver.awake());
  const std::string set = ask({"-z", "CFG-RATE-MEAS,200"}, "1", kBaud, "27.50");
  EXPECT_THAT(set, HasSubstr("UBX-ACK-ACK"));
  EXPECT_THAT(set, Not(HasSubstr("UBX-ACK-NAK")));
  const std::string read = ask({"-g", "CFG-RATE-MEAS"}, "1.5", kBaud, "27.50");
  EXPECT_THAT(read, HasSubstr("UBX-CFG-VALGET"));
  EXPECT_THAT(read, HasSubstr("CFG-RATE-MEAS"));
  EXPECT_THAT(read, HasSubstr("200"));
  EXPECT_THAT(ask({"-p", "MON-VER"}, "1", kBaud, "27.50"), HasSubstr("PROTVER=27.50"));
}

TEST_F(Ubxtool, PollsThroughTheDaemon) {
  LiveReceiver receiver(settings(), wires_.gnss());
  ASSERT_TRUE(receiver.awake());
  const std::string port = std::to_string(test::free_port(SOCK_STREAM));
  ChildProcess gpsd({"gpsd", "-N", "-n", "-s", std::to_string(kBaud), "-S", port, wires_.gnss()},
                    file("gpsd.log"));
  ASSERT_TRUE(test::eventually([&] { return receiver.state().counters.acknowledged > 20; }, 15s))
      << "the daemon has not configured the receiver: " << gpsd.output();
  const std::string text = run({"ubxtool", "-P", "14", "-v", "2", "-w", "2", "-p", "CFG-RATE", "-p",
                                "MON-VER", "localhost:" + port + ":" + wires_.gnss()});
  const auto found = answers(text);
  EXPECT_TRUE(found.contains("UBX-CFG-RATE")) << text;
  EXPECT_TRUE(found.contains("UBX-MON-VER")) << text;
  EXPECT_TRUE(found.contains("UBX-NAV-SOL")) << text;
}

}  // namespace
}  // namespace rigwire
