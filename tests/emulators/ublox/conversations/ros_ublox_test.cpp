// The ROS driver's start (KumarRobotics/ublox, node.cpp and gps.cpp): it sets the host's speed
// without listening, and then every step must be acknowledged within 1.0 s or the node dies.
#include <gtest/gtest.h>

#include <chrono>
#include <ostream>
#include <set>
#include <string>
#include <vector>

#include "driver.h"
#include "receiver_types.h"

namespace rigwire::emulators::conversation {
namespace {

using namespace std::chrono_literals;

/// The driver with the parameters that it has when the user sets none but the line's speed.
class RosUblox final : public Driver {
 public:
  RosUblox(SerialLine& line, std::uint32_t baud) : Driver(line), baud_(baud) {}

  [[nodiscard]] bool start() {
    step_host_speed();
    return configure_port() && read_version() && configure() && configure_systems() && subscribe();
  }

  /// Fixes as the node publishes them; false when their rate leaves the 15 % that its diagnostics
  /// allow around 4 Hz.
  [[nodiscard]] bool publish_for(Duration time) {
    const SimTime end = now() + time;
    int fixes = 0;
    std::uint32_t last_tow_ms = 0;
    while (const auto frame = next_frame(end)) {
      if (frame->is(0x01, 0x07)) {
        const std::size_t expected = protocol_ < 15 ? 84 : 92;
        if (frame->payload.size() != expected) {
          return give_up("NAV-PVT of " + std::to_string(frame->payload.size()) + " bytes");
        }
        ++fixes;
        if (frame->u8(20) != 3 || (frame->u8(21) & 1) == 0) {
          return give_up("no fix");
        }
        if (last_tow_ms != 0 && frame->u32(0) != last_tow_ms + 250) {
          return give_up("an epoch is missing after " + std::to_string(last_tow_ms));
        }
        last_tow_ms = frame->u32(0);
      }
      if (frame->kind == 0x05 && frame->id == 0x00) {
        return give_up("a NAK of data that was not requested");
      }
    }
    const double rate_hz = fixes / to_seconds(time);
    return rate_hz > 4.0 * 0.85 && rate_hz < 4.0 * 1.15 ? true : give_up("fixes at a wrong rate");
  }

  [[nodiscard]] const std::set<std::string>& systems() const { return systems_; }
  [[nodiscard]] double protocol() const { return protocol_; }

 private:
  static constexpr auto kLimit = 1000ms;
  static constexpr std::uint32_t kSteps[] = {4800,  9600,   19200,  38400,
                                             57600, 115200, 230400, 460800};

  void step_host_speed() {
    std::uint32_t current = 38400;  // What a terminal is set to before anybody sets it.
    line_.set_baud(current);
    for (const std::uint32_t step : kSteps) {
      if (current == baud_) {
        break;
      }
      if (current > step && baud_ > step) {
        continue;
      }
      current = step;
      line_.set_baud(current);
      line_.wait_until(now() + 500ms);
    }
  }

  bool acknowledged(std::uint8_t id, const Bytes& payload, const std::string& what) {
    send(0x06, id, payload);
    switch (wait_for_reply(0x06, id, kLimit)) {
      case Reply::acknowledged:
        return true;
      case Reply::refused:
        return give_up(what + ": refused");
      case Reply::silence:
        break;
    }
    return give_up(what + ": no answer");
  }

  bool configure_port() {
    return acknowledged(0x00,
                        Payload()
                            .u8(1)
                            .u8(0)
                            .u16(0)
                            .u32(0x08D0)
                            .u32(baud_)
                            .u16(0x0007)  // UBX, NMEA, RTCM.
                            .u16(0x0001)  // UBX.
                            .u16(0)
                            .u16(0)
                            .bytes,
                        "serial baud rate");
  }

  bool read_version() {
    send(0x0A, 0x04);
    const auto version = wait_for_message(0x0A, 0x04, kLimit);
    if (!version || version->payload.size() < 40 || (version->payload.size() - 40) % 30 != 0) {
      return give_up("MON-VER");
    }
    std::vector<std::string> extensions;
    for (std::size_t at = 40; at < version->payload.size(); at += 30) {
      extensions.push_back(version->text(at, 30));
    }
    for (const std::string& extension : extensions) {
      if (extension.find("PROTVER") != std::string::npos) {
        protocol_ = std::stod(extension.substr(8));
        break;
      }
    }
    // Below protocol 18 the last one lists the systems, from there on the last two do.
    const std::size_t lists = protocol_ < 18 ? 1 : 2;
    for (std::size_t i = extensions.size() - std::min(lists, extensions.size());
         i < extensions.size(); ++i) {
      std::istringstream list(extensions[i]);
      for (std::string system; std::getline(list, system, ';');) {
        systems_.insert(system);
      }
    }
    return protocol_ > 0.0 ? true : give_up("no protocol version");
  }

  bool configure() {
    const auto nav5 = [this](std::uint16_t mask, std::uint8_t model, std::uint8_t mode) {
      return acknowledged(0x24, Payload().u16(mask).u8(model).u8(mode).zeros(32).bytes,
                          "CFG-NAV5 mask " + std::to_string(mask));
    };
    const std::uint32_t expert_version = protocol_ >= 18 ? 2 : 0;
    return acknowledged(0x08, Payload().u16(250).u16(1).u16(1).bytes, "measurement rate") &&
           (!systems_.contains("SBAS") ||
            acknowledged(0x16, Payload().zeros(8).bytes, "disable SBAS")) &&
           acknowledged(0x23, Payload().u16(expert_version).u16(0x2000).zeros(36).bytes,
                        "disable PPP") &&
           nav5(0x0001, 0, 0) && nav5(0x0004, 0, 3) && nav5(0x0008, 0, 0);
  }

  /// One system at a time (firmware 7): what the user did not ask for is switched off.
  bool configure_systems() {
    send(0x06, 0x3E);
    const auto present = wait_for_message(0x06, 0x3E, kLimit);
    if (!present || present->payload.size() < 4 ||
        present->payload.size() != 4 + 8 * present->u8(3)) {
      return give_up("read the GNSS config");
    }
    struct System {
      const char* name;
      std::uint8_t id, reserved, maximum;
    };
    for (const System& system : {System{"GLO", 6, 8, 14}, {"QZSS", 5, 0, 3}, {"SBAS", 1, 0, 3}}) {
      const Bytes payload = Payload()
                                .u8(0)
                                .u8(present->u8(1))
                                .u8(present->u8(2))
                                .u8(1)
                                .u8(system.id)
                                .u8(system.reserved)
                                .u8(system.maximum)
                                .u8(0)
                                .u32(0)
                                .bytes;
      if (systems_.contains(system.name) &&
          !acknowledged(0x3E, payload, std::string("disable ") + system.name)) {
        return false;
      }
    }
    return true;
  }

  /// With publish/all: a refused rate only loses its topic, but the fix needs NAV-PVT.
  bool subscribe() {
    struct Topic {
      std::uint8_t kind, id, rate;
    };
    for (const Topic& topic : {Topic{0x01, 0x03, 1},
                               {0x01, 0x01, 1},
                               {0x01, 0x22, 1},
                               {0x01, 0x30, 20},
                               {0x0A, 0x09, 1}}) {
      if (!acknowledged(0x01, {topic.kind, topic.id, topic.rate}, "a topic's rate")) {
        return false;
      }
    }
    if (!acknowledged(0x01, {0x01, 0x07, 1}, "NAV-PVT")) {
      return false;
    }
    Payload information;
    for (const std::uint32_t protocol : {0U, 1U}) {
      information.u8(protocol).zeros(3);
      for (int port = 0; port < 6; ++port) {
        information.u8(0x0F);
      }
    }
    return acknowledged(0x02, information.bytes, "CFG-INF");
  }

  std::uint32_t baud_;
  double protocol_ = 0.0;
  std::set<std::string> systems_;
};

struct RosUbloxCase {
  ReceiverType type;
  std::uint32_t baud;
  std::chrono::milliseconds begin;  ///< The node starts when the receiver has lived so long.
};

void PrintTo(const RosUbloxCase& c, std::ostream* out) {
  *out << name_of(c.type) << " at " << c.baud << " Bd after " << c.begin.count() << " ms";
}

class RosUbloxStarts : public testing::TestWithParam<RosUbloxCase> {};

TEST_P(RosUbloxStarts, EveryStepIsAnsweredInTimeAndFixesFlow) {
  SerialLine line;
  UbloxSettings settings = GetParam().type.settings;
  settings.baud = GetParam().baud;
  UbloxReceiver receiver(settings, Calendar(UtcTime{2026, 6, 1, 8, 0, 0, 0}), line);
  line.attach(receiver);
  line.wait_until(kStart + GetParam().begin);
  static_cast<void>(line.take());
  RosUblox node(line, GetParam().baud);
  ASSERT_TRUE(node.start()) << node.reason();
  EXPECT_TRUE(node.publish_for(10s)) << node.reason();
  EXPECT_EQ(receiver.counters().messages_lost, 0U);
  RecordProperty("slowest_reply_ms", std::to_string(to_seconds(node.slowest_reply()) * 1e3));
}

std::vector<RosUbloxCase> ros_ublox_cases() {
  std::vector<RosUbloxCase> all;
  for (const ReceiverType& type : receiver_types()) {
    if (type.generation != 7) {
      continue;
    }
    // At 9600 Bd the first acknowledgement waits behind whatever the receiver is saying.
    for (const auto begin : {3000ms, 3050ms, 3100ms, 3300ms, 3600ms, 3900ms}) {
      all.push_back({type, 9600, begin});
    }
    all.push_back({type, 38400, 3100ms});
    all.push_back({type, 115200, 3100ms});
  }
  return all;
}

INSTANTIATE_TEST_SUITE_P(Receivers, RosUbloxStarts, testing::ValuesIn(ros_ublox_cases()),
                         [](const testing::TestParamInfo<RosUbloxCase>& at) {
                           return name_of(at.param.type) + "_" + std::to_string(at.param.baud) +
                                  "_" + std::to_string(at.param.begin.count());
                         });

TEST(RosUblox, ReadsTheSystemsFromTheLastExtension) {
  SerialLine line;
  const ReceiverType type = receiver_types().front();
  UbloxReceiver receiver(type.settings, Calendar(UtcTime{2026, 6, 1, 8, 0, 0, 0}), line);
  line.attach(receiver);
  line.wait_until(kStart + 3s);
  RosUblox node(line, type.settings.baud);
  ASSERT_TRUE(node.start()) << node.reason();
  EXPECT_EQ(node.systems(), (std::set<std::string>{"GPS", "SBAS", "GLO", "QZSS"}));
  EXPECT_DOUBLE_EQ(node.protocol(), 14.0);
}

}  // namespace
}  // namespace rigwire::emulators::conversation
