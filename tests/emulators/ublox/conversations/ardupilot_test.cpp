// ArduPilot's driver (libraries/AP_GPS: AP_GPS.cpp, AP_GPS_UBLOX.cpp): blobs at eight speeds until
// a frame is heard at 230400, then one configuration question at a time, each read back; dropped
// after 4.0 s without position and velocity of one epoch.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "driver.h"
#include "receiver_types.h"

namespace rigwire::emulators::conversation {
namespace {

using namespace std::chrono_literals;

class ArduPilot final : public Driver {
 public:
  explicit ArduPilot(SerialLine& line) : Driver(line) {}

  /// Ticks at 50 Hz, as the flight code does; false when the receiver was dropped.
  [[nodiscard]] bool run_until(SimTime end) {
    while (now() < end) {
      line_.wait_until(now() + 20ms);
      if (!detected_) {
        detect();
      } else if (!update()) {
        return give_up("no complete position and velocity for 4 s");
      }
    }
    return true;
  }

  [[nodiscard]] bool detected() const { return detected_; }
  [[nodiscard]] SimTime detected_at() const { return detected_at_; }
  [[nodiscard]] bool configured() const { return unconfigured_.empty(); }
  [[nodiscard]] SimTime configured_at() const { return configured_at_; }
  [[nodiscard]] const std::set<std::string>& unconfigured() const { return unconfigured_; }
  [[nodiscard]] bool saved() const { return saved_; }
  [[nodiscard]] bool has_version() const { return has_version_; }
  [[nodiscard]] int hardware_generation() const { return hardware_generation_; }
  [[nodiscard]] std::uint32_t week() const { return week_; }
  [[nodiscard]] std::uint32_t fix_type() const { return fix_type_; }
  [[nodiscard]] int positions() const { return positions_; }
  [[nodiscard]] Duration longest_gap() const { return longest_gap_; }
  void forget() { positions_ = 0, longest_gap_ = Duration{0}; }

 private:
  static constexpr std::uint32_t kSpeeds[] = {9600,  115200, 4800,   19200,
                                              38400, 57600,  230400, 460800};
  static constexpr std::size_t kPorts = 6;
  static constexpr int kGeneration9 = 0x80;
  static constexpr std::uint32_t kTimeMode = 0x20030001;

  struct RateWish {
    std::string name;
    std::uint8_t kind = 0;
    std::uint8_t id = 0;
    std::uint8_t rate = 0;
    std::uint8_t rate_with_pvt = 0;
  };
  [[nodiscard]] static const std::vector<RateWish>& rates() {
    static const std::vector<RateWish> all{
        {"PVT", 0x01, 0x07, 1, 1},    {"SOL", 0x01, 0x06, 1, 0},    {"STATUS", 0x01, 0x03, 1, 0},
        {"POSLLH", 0x01, 0x02, 1, 0}, {"VELNED", 0x01, 0x12, 1, 0}, {"TIMEGPS", 0x01, 0x20, 5, 5},
        {"DOP", 0x01, 0x04, 1, 1},    {"MON-HW", 0x0A, 0x09, 5, 5}, {"MON-HW2", 0x0A, 0x0B, 5, 5},
    };
    return all;
  }

  void detect() {
    if (now() - last_speed_change_ > 1200ms) {
      speed_ = (speed_ + 1) % std::size(kSpeeds);
      line_.set_baud(kSpeeds[speed_]);
      last_speed_change_ = now();
      Bytes blob = make_frame(0x06, 0x01, {0x01, 0x06, 0x01});
      const std::string command = "$PUBX,41,1,0023,0001,230400,0*1E\r\n";
      blob.insert(blob.end(), command.begin(), command.end());
      line_.write(blob);
    }
    const Bytes bytes = line_.take();
    if (kSpeeds[speed_] != 230400) {
      return;
    }
    reader_.put(bytes);
    if (reader_.next()) {
      detected_ = true;
      detected_at_ = now();
      last_position_ = now();
      last_question_ = now() - 10s;
    }
  }

  bool update() {
    if (now() - last_question_ >= pause_) {
      ask_next();
      last_question_ = now();
      const bool first = unconfigured_.contains("RATE") || unconfigured_.contains("POSLLH") ||
                         unconfigured_.contains("STATUS") || unconfigured_.contains("VELNED");
      pause_ = unconfigured_.empty() ? 2000ms : (!has_pvt_ && first) ? 300ms : 750ms;
    }
    if (unconfigured_.empty()) {
      if (configured_at_ == kNever) {
        configured_at_ = now();
      }
      if (!saved_ && save_tries_ < 5 && now() - last_save_ > 5s && must_save_) {
        send(0x06, 0x09, Payload().u32(0).u32(0x061F).u32(0).bytes);
        last_save_ = now();
        ++save_tries_;
      }
    }
    reader_.put(line_.take());
    while (const auto frame = reader_.next()) {
      handle(*frame);
    }
    return now() - last_position_ <= 4000ms;
  }

  void ask_rate(const std::string& name) {
    for (const RateWish& wish : rates()) {
      if (wish.name == name) {
        if (port_ >= kPorts) {
          send(0x06, 0x00);
          --step_;
        } else {
          send(0x06, 0x01, {wish.kind, wish.id});
        }
      }
    }
  }

  void ask_next() {
    static const std::vector<std::string> order{
        "PVT",    "RATE", "SOL",  "PORT",  "STATUS", "POSLLH", "VELNED",  "TIMEGPS",
        "SVINFO", "NAV5", "GNSS", "TMODE", "DOP",    "MON-HW", "MON-HW2", "VERSION"};
    if (unconfigured_ == std::set<std::string>{"SOL"} && has_pvt_) {
      unconfigured_.clear();  // Generation 9 has none.
    }
    const std::string what = order[step_++ % order.size()];
    if (what == "RATE") {
      send(0x06, 0x08);
    } else if (what == "PORT") {
      send(0x06, 0x00);
    } else if (what == "SVINFO") {
      if (hardware_generation_ < 0) {
        send(0x01, 0x30);
      }
    } else if (what == "NAV5") {
      send(0x06, 0x24);
    } else if (what == "GNSS") {
      if (hardware_generation_ != kGeneration9) {
        send(0x06, 0x3E);
      }
    } else if (what == "TMODE") {
      if (hardware_generation_ == kGeneration9) {
        send(0x06, 0x8B, Payload().u8(0).u8(0).u16(0).u32(kTimeMode).bytes);
      }
    } else if (what == "VERSION") {
      if (has_version_) {
        unconfigured_.erase("VERSION");
      } else {
        send(0x0A, 0x04);
      }
    } else {
      ask_rate(what);
    }
  }

  void handle(const Frame& frame) {
    switch (frame.kind) {
      case 0x05:
        if (frame.id == 0x01 && frame.payload.size() == 2 && frame.u8(0) == 0x06) {
          saved_ |= frame.u8(1) == 0x09;
          if (frame.u8(1) == 0x24 && model_is_sent_) {
            unconfigured_.erase("NAV5");
          }
        }
        break;
      case 0x06:
        handle_configuration(frame);
        break;
      case 0x0A:
        if (frame.id == 0x04 && frame.payload.size() >= 40) {
          has_version_ = true;
          if (frame.text(30, 10) == "00190000" && frame.text(0, 30).starts_with("EXT CORE 1") &&
              hardware_generation_ != kGeneration9) {
            hardware_generation_ = kGeneration9;
            unconfigured_.insert("TMODE");
            unconfigured_.erase("GNSS");
          }
        }
        break;
      case 0x01:
        handle_navigation(frame);
        break;
      default:
        break;
    }
  }

  void handle_configuration(const Frame& frame) {
    switch (frame.id) {
      case 0x00:
        port_ = frame.u8(0);
        break;
      case 0x01:
        if (frame.payload.size() == 8 && port_ >= kPorts) {
          send(0x06, 0x00);
          break;
        }
        verify(static_cast<std::uint8_t>(frame.u8(0)), static_cast<std::uint8_t>(frame.u8(1)),
               frame.u8(frame.payload.size() == 8 ? 2 + port_ : 2));
        break;
      case 0x08:
        if (frame.u16(0) == 200 && frame.u16(2) == 1 && frame.u16(4) == 0) {
          unconfigured_.erase("RATE");
        } else {
          send(0x06, 0x08, Payload().u16(200).u16(1).u16(0).bytes);
          unconfigured_.insert("RATE");
          must_save_ = true;
        }
        break;
      case 0x24:
        if (frame.payload.size() == 36 && frame.u8(2) != 8) {
          Bytes wish = frame.payload;
          wish[0] = 1;
          wish[1] = 0;
          wish[2] = 8;  // Airborne, 4 g.
          send(0x06, 0x24, wish);
          model_is_sent_ = true;
          must_save_ = true;
        } else {
          unconfigured_.erase("NAV5");
        }
        break;
      case 0x3E:
        unconfigured_.erase("GNSS");
        break;
      case 0x8B:
        if (frame.payload.size() >= 9 && frame.u32(4) == kTimeMode && frame.u8(8) == 0) {
          unconfigured_.erase("TMODE");
        }
        break;
      default:
        break;
    }
  }

  void verify(std::uint8_t kind, std::uint8_t id, std::uint32_t rate) {
    for (const RateWish& wish : rates()) {
      if (wish.kind == kind && wish.id == id) {
        const std::uint8_t wanted = has_pvt_ ? wish.rate_with_pvt : wish.rate;
        if (rate == wanted) {
          unconfigured_.erase(wish.name);
        } else {
          send(0x06, 0x01, {kind, id, wanted});
          unconfigured_.insert(wish.name);
          must_save_ = true;
        }
      }
    }
  }

  void handle_navigation(const Frame& frame) {
    switch (frame.id) {
      case 0x02:
        if (!has_pvt_) {
          position_tow_ = frame.u32(0);
        }
        break;
      case 0x12:
        if (!has_pvt_) {
          velocity_tow_ = frame.u32(0);
        }
        break;
      case 0x06:
        week_ = frame.u16(8);
        if (!has_pvt_) {
          fix_type_ = (frame.u8(11) & 1) != 0 ? frame.u8(10) : 0;
        }
        break;
      case 0x07:
        has_pvt_ = true;
        position_tow_ = velocity_tow_ = frame.u32(0);
        fix_type_ = frame.u8(20);
        break;
      case 0x20:
        if ((frame.u8(11) & 2) != 0) {
          week_ = frame.u16(8);
        }
        break;
      case 0x30:
        hardware_generation_ = static_cast<int>(frame.u8(5) & 7);
        unconfigured_.erase("VERSION");
        send(0x06, 0x01, {0x01, 0x30, 0});
        break;
      default:
        break;
    }
    if (position_tow_ == velocity_tow_ && position_tow_ != used_tow_) {
      used_tow_ = position_tow_;
      longest_gap_ = std::max(longest_gap_, now() - last_position_);
      last_position_ = now();
      ++positions_;
    }
  }

  std::size_t speed_ = 0;
  SimTime last_speed_change_ = kStart;
  bool detected_ = false;
  SimTime detected_at_ = kNever;

  std::size_t step_ = 0;
  SimTime last_question_ = kStart;
  Duration pause_{0};
  std::uint32_t port_ = 255;
  std::set<std::string> unconfigured_{"RATE",   "POSLLH",  "STATUS",  "SOL",  "VELNED", "DOP",
                                      "MON-HW", "MON-HW2", "VERSION", "NAV5", "GNSS"};
  SimTime configured_at_ = kNever;
  bool model_is_sent_ = false;
  bool must_save_ = false;
  bool saved_ = false;
  int save_tries_ = 0;
  SimTime last_save_ = kStart;
  bool has_version_ = false;
  int hardware_generation_ = -1;

  bool has_pvt_ = false;
  std::uint32_t position_tow_ = 1;
  std::uint32_t velocity_tow_ = 2;
  std::uint32_t used_tow_ = 0;
  std::uint32_t week_ = 0;
  std::uint32_t fix_type_ = 0;
  SimTime last_position_ = kStart;
  int positions_ = 0;
  Duration longest_gap_{0};
};

class ArduPilotStarts : public testing::TestWithParam<ReceiverType> {};

TEST_P(ArduPilotStarts, DetectsAt230400ReadsEverythingBackAndIsNeverDropped) {
  SerialLine line;
  const Calendar calendar(UtcTime{2026, 6, 1, 8, 0, 0, 0});
  UbloxReceiver receiver(GetParam().settings, calendar, line);
  line.attach(receiver);
  line.set_baud(9600);
  ArduPilot autopilot(line);
  // Speed by speed, 1.2 s each: once around until 9600 is hit, then again to 230400.
  ASSERT_TRUE(autopilot.run_until(kStart + 25s)) << autopilot.reason();
  ASSERT_TRUE(autopilot.detected());
  EXPECT_EQ(receiver.baud(), 230400U);

  // Two rounds of 16 questions, 750 ms each, set and read back everything.
  ASSERT_TRUE(autopilot.run_until(kStart + 70s)) << autopilot.reason();
  EXPECT_TRUE(autopilot.configured()) << testing::PrintToString(autopilot.unconfigured());
  EXPECT_TRUE(autopilot.has_version());
  EXPECT_EQ(autopilot.hardware_generation(), GetParam().generation == 7   ? 3
                                             : GetParam().generation == 8 ? 4
                                                                          : 0x80);
  EXPECT_TRUE(autopilot.saved());

  autopilot.forget();
  ASSERT_TRUE(autopilot.run_until(kStart + 100s)) << autopilot.reason();
  EXPECT_NEAR(autopilot.positions(), 150, 1);
  EXPECT_LE(autopilot.longest_gap(), 245ms) << "the flight code counts such an epoch as delayed";
  EXPECT_EQ(autopilot.week(), static_cast<std::uint32_t>(calendar.gps(line.now()).week));
  EXPECT_EQ(autopilot.fix_type(), 3U);
  EXPECT_EQ(receiver.counters().messages_lost, 0U);
}

INSTANTIATE_TEST_SUITE_P(Receivers, ArduPilotStarts, testing::ValuesIn(receiver_types()),
                         [](const testing::TestParamInfo<ReceiverType>& at) {
                           return name_of(at.param);
                         });

}  // namespace
}  // namespace rigwire::emulators::conversation
