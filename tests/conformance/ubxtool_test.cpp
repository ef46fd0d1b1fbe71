// ubxtool (Debian's gpsd-clients) on the receiver's line: every poll that a u-blox 7 answers is
// decoded by it, what it sets is in force, and the same through the daemon.
//
// The program is a required dependency: without it these tests fail. Every wait is bounded.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <functional>
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
  /// What the tool prints of requests and answers until `enough`; sentences are counted, and left
  /// out.
  struct Heard {
    std::string text;
    std::set<std::string> answers;  ///< Names of the messages that were decoded, requests left out.
    int sentences = 0;
  };
  using Enough = std::function<bool(const Heard&)>;
  [[nodiscard]] static Heard heard(const std::string& output) {
    Heard all;
    std::istringstream lines(output);
    std::string title;
    for (std::string line; std::getline(lines, line);) {
      if (line.starts_with("$G")) {
        ++all.sentences;
        continue;
      }
      all.text += line + "\n";
      if (!title.empty() && !line.empty() && line.find("Poll request") == std::string::npos) {
        all.answers.insert(title);
      }
      title = line.starts_with("UBX-") ? line.substr(0, line.find(':')) : "";
    }
    return all;
  }
  [[nodiscard]] Heard run(const std::vector<std::string>& words, const Enough& enough) {
    std::vector<std::string> command{"env", "PYTHONUNBUFFERED=1"};
    command.insert(command.end(), words.begin(), words.end());
    ChildProcess tool(command, file("ubxtool.log"));
    EXPECT_TRUE(test::eventually([&] { return enough(heard(tool.output())); })) << tool.output();
    tool.signal(SIGKILL);
    tool.wait();
    const Heard all = heard(tool.output());
    EXPECT_THAT(all.text, Not(HasSubstr("Traceback")));
    EXPECT_THAT(all.text, Not(HasSubstr("Bad Length")));
    EXPECT_THAT(all.text, Not(HasSubstr("invalid")));
    return all;
  }
  [[nodiscard]] Heard ask(const std::vector<std::string>& more, const Enough& enough,
                          std::uint32_t baud = kBaud, const std::string& protocol = "14") {
    std::vector<std::string> words{"ubxtool", "-f",     wires_.gnss(), "-s", std::to_string(baud),
                                   "-P",      protocol, "-v",          "2",  "-w",
                                   kLong};
    words.insert(words.end(), more.begin(), more.end());
    return run(words, enough);
  }
  /// Polls them all at once and expects each to be decoded.
  void expect_answers(const std::vector<std::string>& names) {
    std::vector<std::string> words;
    for (const std::string& name : names) {
      words.push_back("-p");
      words.push_back(name);
    }
    const Heard all = ask(words, [&](const Heard& so_far) {
      return std::ranges::all_of(
          names, [&](const std::string& name) { return so_far.answers.contains("UBX-" + name); });
    });
    for (const std::string& name : names) {
      if (name.starts_with("CFG-")) {
        EXPECT_THAT(all.text, HasSubstr("(" + name.substr(4) + ")"));
      }
    }
    EXPECT_THAT(all.text, Not(HasSubstr("ACK-NAK")));
  }
  /// Enough is a line that holds it.
  [[nodiscard]] static Enough says(const std::string& what) {
    return [what](const Heard& so_far) { return so_far.text.find(what) != std::string::npos; };
  }
  [[nodiscard]] static Enough sentences(int count) {
    return [count](const Heard& so_far) { return so_far.sentences >= count; };
  }

  static constexpr const char* kLong = "1000";  ///< Seconds: it is ended.
  test::PrivateWires wires_;
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
  const std::string version = ask({"-p", "MON-VER"}, says("extension GPS;SBAS;GLO;QZSS")).text;
  for (const char* line : {"swVersion 1.00 (71863)", "hwVersion 00070000",
                           "extension PROTVER 14.00", "extension MOD NEO-7P-0"}) {
    EXPECT_THAT(version, HasSubstr(line));
  }
}

TEST_F(Ubxtool, WhatCameWithLaterProtocolsIsRefused) {
  LiveReceiver receiver(settings(), wires_.gnss());
  ASSERT_TRUE(receiver.awake());
  (void)ask({"-p", "CFG-TMODE2", "-p", "CFG-ODO"}, [](const Heard& so_far) {
    return says("UBX-ACK-NAK:\n  NAK to Class x06 (CFG) ID x3d (TMODE2)")(so_far) &&
           says("UBX-ACK-NAK:\n  NAK to Class x06 (CFG) ID x1e (ODO)")(so_far);
  });
}

TEST_F(Ubxtool, SetsRateAndModelAndBothAreInForce) {
  LiveReceiver receiver(settings(), wires_.gnss());
  ASSERT_TRUE(receiver.awake());
  (void)ask({"-p", "CFG-RATE,200"}, says("UBX-ACK-ACK:\n  ACK to Class x06 (CFG) ID x08 (RATE)"));
  (void)ask({"-p", "MODEL,4"}, says("UBX-ACK-ACK:\n  ACK to Class x06 (CFG) ID x24 (NAV5)"));
  const std::string text = ask({"-p", "CFG-RATE", "-p", "CFG-NAV5"}, [](const Heard& so_far) {
                             return says("measRate ")(so_far) && says("dynModel ")(so_far);
                           }).text;
  EXPECT_THAT(text, HasSubstr("measRate 200 navRate 1"));
  EXPECT_THAT(text, HasSubstr("dynModel 4"));
  const LiveReceiver::State before = receiver.state();
  ASSERT_TRUE(test::eventually(
      [&] { return receiver.state().counters.epochs >= before.counters.epochs + 10; }));
  const LiveReceiver::State after = receiver.state();
  EXPECT_NEAR(to_seconds(after.time - before.time),
              0.2 * static_cast<double>(after.counters.epochs - before.counters.epochs), 0.3)
      << "five epochs a second, of the receiver's time";
}

TEST_F(Ubxtool, SwitchesSentencesOffAndMessagesOn) {
  LiveReceiver receiver(settings(), wires_.gnss());
  ASSERT_TRUE(receiver.awake());
  const auto binary = [](const Heard& so_far) {
    for (const char* name : {"UBX-NAV-SOL", "UBX-NAV-SVINFO", "UBX-NAV-DOP", "UBX-NAV-TIMEGPS"}) {
      if (!so_far.answers.contains(name)) {
        return false;
      }
    }
    return true;
  };
  (void)ask({"-d", "NMEA", "-e", "BINARY"}, binary);
  EXPECT_EQ(ask({}, binary).sentences, 0);
  (void)ask({"-d", "BINARY", "-e", "NMEA"}, sentences(8));
  EXPECT_FALSE(ask({}, sentences(16)).answers.contains("UBX-NAV-SOL"));
}

TEST_F(Ubxtool, ChangesTheSpeed) {
  LiveReceiver receiver(settings(), wires_.gnss());
  ASSERT_TRUE(receiver.awake());
  (void)ask({"-S", "38400"}, [&](const Heard&) { return receiver.state().baud == 38'400U; });
  (void)ask(
      {"-p", "CFG-PRT"},
      [](const Heard& so_far) { return says("baudRate 38400")(so_far) && so_far.sentences >= 4; },
      38'400);
}

TEST_F(Ubxtool, AColdBootBeginsWithTheBanner) {
  LiveReceiver receiver(settings(), wires_.gnss());
  ASSERT_TRUE(receiver.awake());
  ChildProcess tool({"env", "PYTHONUNBUFFERED=1", "ubxtool", "-f", wires_.gnss(), "-s",
                     std::to_string(kBaud), "-P", "14", "-v", "2", "-w", kLong, "-p", "COLDBOOT"},
                    file("cold.log"));
  for (const char* line : {"$GPTXT,01,01,02,u-blox ag - www.u-blox.com*50",
                           "$GPTXT,01,01,02,MOD NEO-7P-0*38", "$GPRMC,,V,,,,,,,,,,N*53"}) {
    EXPECT_TRUE(test::eventually([&] { return tool.output().find(line) != std::string::npos; }))
        << line << " is not in " << tool.output();
  }
  EXPECT_EQ(receiver.state().counters.resets, 1U);
}

TEST_F(Ubxtool, SetsAndReadsItemsOfTheF9p) {
  emulators::UbloxSettings precise = settings();
  precise.profile = &emulators::ublox_zed_f9p();
  LiveReceiver receiver(precise, wires_.gnss());
  ASSERT_TRUE(receiver.awake());
  const std::string set = ask({"-z", "CFG-RATE-MEAS,200"}, says("UBX-ACK-"), kBaud, "27.50").text;
  EXPECT_THAT(set, HasSubstr("UBX-ACK-ACK"));
  EXPECT_THAT(set, Not(HasSubstr("UBX-ACK-NAK")));
  const std::string read =
      ask(
          {"-g", "CFG-RATE-MEAS"},
          [](const Heard& so_far) {
            return so_far.answers.contains("UBX-CFG-VALGET") && says("UBX-ACK-ACK")(so_far);
          },
          kBaud, "27.50")
          .text;
  EXPECT_THAT(read, HasSubstr("CFG-RATE-MEAS"));
  EXPECT_THAT(read, HasSubstr("200"));
  (void)ask({"-p", "MON-VER"}, says("PROTVER=27.50"), kBaud, "27.50");
}

TEST_F(Ubxtool, PollsThroughTheDaemon) {
  LiveReceiver receiver(settings(), wires_.gnss());
  ASSERT_TRUE(receiver.awake());
  const std::string port = std::to_string(test::free_port(SOCK_STREAM));
  ChildProcess gpsd({"gpsd", "-N", "-n", "-s", std::to_string(kBaud), "-S", port, wires_.gnss()},
                    file("gpsd.log"));
  ASSERT_TRUE(test::eventually([&] { return receiver.state().counters.acknowledged > 20; }))
      << "the daemon has not configured the receiver: " << gpsd.output();
  (void)run({"ubxtool", "-P", "14", "-v", "2", "-w", kLong, "-p", "CFG-RATE", "-p", "MON-VER",
             "localhost:" + port + ":" + wires_.gnss()},
            [](const Heard& so_far) {
              return so_far.answers.contains("UBX-CFG-RATE") &&
                     so_far.answers.contains("UBX-MON-VER") &&
                     so_far.answers.contains("UBX-NAV-SOL");
            });
}

}  // namespace
}  // namespace rigwire
