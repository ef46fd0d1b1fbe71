// PX4's driver (PX4-GPSDrivers, ubx.cpp): hunts for the speed, asks first by CFG-VALSET, then by
// the old messages, expects nearly every acknowledgement within 250 ms and a fix every 500 ms after
// that.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <map>
#include <ostream>
#include <string>
#include <vector>

#include "driver.h"
#include "receiver_types.h"

namespace rigwire::emulators::conversation {
namespace {

using namespace std::chrono_literals;

struct KeyValue {
  std::uint32_t key = 0;
  std::uint32_t value = 0;
};

/// Keys of UBX messages on UART1; on USB two more.
namespace message_key {
constexpr std::uint32_t kPvt = 0x20910007;
constexpr std::uint32_t kHighPrecisionPosition = 0x20910034;
constexpr std::uint32_t kRelativePosition = 0x2091008e;
constexpr std::uint32_t kDop = 0x20910039;
constexpr std::uint32_t kSat = 0x20910016;
constexpr std::uint32_t kStatus = 0x2091001b;
constexpr std::uint32_t kRadio = 0x2091035a;
constexpr std::uint32_t kRtcm = 0x20910269;
}  // namespace message_key

class Px4 final : public Driver {
 public:
  explicit Px4(SerialLine& line) : Driver(line) {}

  /// configure(), once.
  [[nodiscard]] bool start() { return find_receiver() && read_board() && configure(); }

  /// The main loop: position and velocity at least every 500 ms. What it did not ask for is
  /// switched off, one message a second.
  [[nodiscard]] bool run_for(Duration time) {
    const SimTime end = now() + time;
    SimTime last_fix = now();
    SimTime last_disable = now() - 2s;
    while (now() < end) {
      const auto frame = next_frame(std::min(end, last_fix + 500ms));
      if (!frame) {
        if (now() >= last_fix + 500ms) {
          return give_up("no position for 500 ms");
        }
        continue;
      }
      if (!length_is_right(*frame)) {
        return give_up("message " + std::to_string(frame->kind) + " " + std::to_string(frame->id) +
                       " of " + std::to_string(frame->payload.size()) + " bytes");
      }
      if (frame->is(0x01, 0x07)) {
        last_fix = now();
      }
      ++seen_[{frame->kind, frame->id}];
      if (!expected(*frame) && now() > last_disable + 1s) {
        last_disable = now();
        send(0x06, 0x01, {frame->kind, frame->id, 0});
      }
    }
    return true;
  }

  void forget() { seen_.clear(); }
  [[nodiscard]] int seen(std::uint8_t kind, std::uint8_t id) const {
    const auto found = seen_.find({kind, id});
    return found == seen_.end() ? 0 : found->second;
  }
  [[nodiscard]] bool key_values() const { return key_values_; }
  [[nodiscard]] std::uint32_t host_baud() const { return line_.baud(); }

 private:
  static constexpr auto kLimit = 250ms;
  enum class Board { unknown, seven, eight, nine, nine_f9p };

  [[nodiscard]] Reply ask(std::uint8_t id, const Bytes& payload, Duration limit = kLimit) {
    send(0x06, id, payload);
    return wait_for_reply(0x06, id, limit);
  }
  bool must(std::uint8_t id, const Bytes& payload, const std::string& what) {
    switch (ask(id, payload)) {
      case Reply::acknowledged:
        return true;
      case Reply::refused:
        return give_up(what + ": refused");
      case Reply::silence:
        break;
    }
    return give_up(what + ": no answer within 250 ms");
  }

  [[nodiscard]] static Bytes key_value_set(const std::vector<KeyValue>& pairs) {
    Payload payload;
    payload.u8(0).u8(1).u16(0);  // Version 0, into RAM.
    for (const auto& [key, value] : pairs) {
      payload.u32(key);
      switch (key >> 28 & 7U) {
        case 3:
          payload.u16(value);
          break;
        case 4:
          payload.u32(value);
          break;
        default:
          payload.u8(value);
      }
    }
    return payload.bytes;
  }
  /// UART1 and USB in one message.
  [[nodiscard]] static Bytes ports(std::uint32_t baud) {
    Payload payload;
    for (const std::uint32_t port : {1U, 3U}) {
      payload.u8(port).u8(0).u16(0).u32(0x08D0).u32(baud).u16(0x0021).u16(0x0001).u32(0);
    }
    return payload.bytes;
  }

  void set_host_baud(std::uint32_t baud) {
    line_.set_baud(baud);
    line_.wait_until(now() + 20ms);
    static_cast<void>(line_.take());
    reader_.reset();
  }

  bool find_receiver() {
    for (const std::uint32_t baud : {38400U, 57600U, 9600U, 115200U, 230400U, 460800U, 921600U}) {
      set_host_baud(baud);
      const Bytes probe = key_value_set({{0x20520002, 1},
                                         {0x20520003, 0},
                                         {0x20520004, 0},
                                         {0x10730001, 1},
                                         {0x10730002, 0},
                                         {0x10740001, 1},
                                         {0x10740002, 0}});
      std::uint32_t wanted = 115200;
      key_values_ = ask(0x8A, probe, 2000ms) == Reply::acknowledged;
      if (key_values_) {
        static_cast<void>(ask(0x8A, key_value_set({{0x40520001, wanted}})));
      } else {
        if (ask(0x00, ports(baud)) != Reply::acknowledged) {
          continue;
        }
        wanted = 38400;
        static_cast<void>(ask(0x00, ports(wanted)));
      }
      if (wanted != baud) {
        set_host_baud(wanted);
      }
      return true;
    }
    return give_up("no receiver at any speed");
  }

  bool read_board() {
    send(0x0A, 0x04);
    const auto version = wait_for_message(0x0A, 0x04, kLimit);
    if (!version || version->payload.size() < 40) {
      return give_up("MON-VER");
    }
    const std::string hardware = version->text(30, 10);
    if (hardware == "00070000") {
      board_ = Board::seven;
    } else if (hardware == "00080000") {
      board_ = Board::eight;
    } else if (hardware == "00190000") {
      board_ = Board::nine;
      for (std::size_t at = 40; at + 30 <= version->payload.size(); at += 30) {
        const std::string extension = version->text(at, 30);
        if (extension.find("MOD=") != std::string::npos &&
            extension.find("F9P") != std::string::npos) {
          board_ = Board::nine_f9p;
        }
      }
    } else {
      return give_up("unknown board " + hardware);
    }
    if (board_ == Board::eight) {
      static_cast<void>(ask(0x00, ports(115200)));
      set_host_baud(115200);
    }
    return true;
  }

  bool configure() { return key_values_ ? configure_by_keys() : configure_by_messages(); }

  bool configure_by_messages() {
    if (!must(0x08, Payload().u16(200).u16(1).u16(0).bytes, "CFG-RATE") ||
        !must(0x24, Payload().u16(0x0005).u8(7).u8(2).zeros(32).bytes, "CFG-NAV5")) {
      return false;
    }
    struct Rate {
      std::uint8_t kind, id, rate;
    };
    for (const Rate& rate : {Rate{0x01, 0x07, 1},
                             {0x01, 0x03, 1},
                             {0x01, 0x04, 1},
                             {0x01, 0x30, 5},
                             {0x0A, 0x09, 1}}) {
      if (!must(0x01, {rate.kind, rate.id, rate.rate}, "CFG-MSG " + std::to_string(rate.id))) {
        return false;
      }
    }
    return true;
  }

  bool configure_by_keys() {
    const auto messages = [](std::initializer_list<KeyValue> uart1) {
      std::vector<KeyValue> both;
      for (const KeyValue& pair : uart1) {
        both.push_back(pair);
        both.push_back({pair.key + 2, pair.value});
      }
      return both;
    };
    const bool f9p = board_ == Board::nine_f9p;
    if (!must(0x8A,
              key_value_set({{0x10730004, 1},
                             {0x10770001, 1},
                             {0x10770004, 1},
                             {0x10770002, 0},
                             {0x10780001, 1},
                             {0x10780002, 0}}),
              "protocols") ||
        !must(0x8A,
              key_value_set({{0x20110011, 3},
                             {0x2011001c, 3},
                             {0x20110021, 7},
                             {0x10220001, 0},
                             {0x10220002, 0},
                             {0x10220003, 0},
                             {0x10220004, 0},
                             {0x30210001, f9p ? 200U : 125U},
                             {0x30210002, 1},
                             {0x20210003, 0}}),
              "navigation and rate")) {
      return false;
    }
    // These may be refused.
    static_cast<void>(ask(0x8A, key_value_set({{0x20140011, 3}})));
    static_cast<void>(ask(0x8A, key_value_set({{0x1041000d, 1}})));
    static_cast<void>(ask(0x8A, key_value_set({{0x10f60051, 0}})));
    namespace key = message_key;
    return must(0x8A,
                key_value_set(messages({{key::kPvt, 1},
                                        {key::kHighPrecisionPosition, 1},
                                        {key::kRelativePosition, 0},
                                        {key::kDop, 1},
                                        {key::kSat, 10},
                                        {key::kStatus, 1},
                                        {key::kRadio, 1},
                                        {key::kRtcm, 1}})),
                "messages") &&
           must(0x8A,
                key_value_set({{0x10710001, 0},
                               {0x10710002, 0},
                               {0x10710004, 0},
                               {0x10720001, 0},
                               {0x10720002, 0},
                               {0x10720004, 0}}),
                "I2C protocols");
  }

  [[nodiscard]] static bool length_is_right(const Frame& frame) {
    const std::size_t n = frame.payload.size();
    if (frame.kind == 0x01) {
      switch (frame.id) {
        case 0x07:
          return n == 84 || n == 92;
        case 0x03:
          return n == 16;
        case 0x04:
          return n == 18;
        case 0x14:
          return n == 36;
        case 0x30:
        case 0x35:
          return n >= 8 && (n - 8) % 12 == 0;
        default:
          return true;
      }
    }
    if (frame.kind == 0x0A && frame.id == 0x09) {
      return n == 56 || n == 60 || n == 68;
    }
    if (frame.kind == 0x0A && frame.id == 0x38) {
      return n >= 28 && (n - 4) % 24 == 0;
    }
    return true;
  }
  [[nodiscard]] static bool expected(const Frame& frame) {
    switch (frame.kind) {
      case 0x01:
        return frame.id == 0x07 || frame.id == 0x03 || frame.id == 0x04 || frame.id == 0x14 ||
               frame.id == 0x30 || frame.id == 0x35;
      case 0x0A:
        return frame.id == 0x09 || frame.id == 0x04 || frame.id == 0x38;
      case 0x05:
        return true;
      default:
        return false;
    }
  }

  bool key_values_ = false;
  Board board_ = Board::unknown;
  std::map<std::pair<std::uint8_t, std::uint8_t>, int> seen_;
};

struct Case {
  ReceiverType type;
  std::chrono::milliseconds begin;  ///< The driver starts when the receiver has lived so long.
};

void PrintTo(const Case& c, std::ostream* out) {
  *out << name_of(c.type) << " after " << c.begin.count() << " ms";
}

class Px4Starts : public testing::TestWithParam<Case> {};

TEST_P(Px4Starts, FindsTheSpeedConfiguresAndStaysHealthy) {
  SerialLine line;
  const ReceiverType& type = GetParam().type;
  UbloxReceiver receiver(type.settings, Calendar(UtcTime{2026, 6, 1, 8, 0, 0, 0}), line);
  line.attach(receiver);
  line.wait_until(kStart + GetParam().begin);
  Px4 px4(line);
  ASSERT_TRUE(px4.start()) << px4.reason();
  EXPECT_EQ(px4.key_values(), type.generation >= 9);
  EXPECT_EQ(receiver.baud(), type.generation == 7 ? 38400U : 115200U);
  EXPECT_EQ(receiver.baud(), px4.host_baud());
  ASSERT_TRUE(px4.run_for(10s)) << px4.reason();
  px4.forget();
  ASSERT_TRUE(px4.run_for(20s)) << px4.reason();
  EXPECT_NEAR(px4.seen(0x01, 0x07), 100, 1);
  EXPECT_NEAR(px4.seen(0x01, 0x03), 100, 1);
  EXPECT_NEAR(px4.seen(0x01, 0x04), 100, 1);
  if (type.generation < 9) {
    EXPECT_NEAR(px4.seen(0x01, 0x30), 20, 1);
    EXPECT_NEAR(px4.seen(0x0A, 0x09), 100, 1);
  } else {
    EXPECT_NEAR(px4.seen(0x01, 0x14), 100, 1);
    EXPECT_NEAR(px4.seen(0x01, 0x35), 10, 1);
    EXPECT_NEAR(px4.seen(0x0A, 0x38), 100, 1);
  }
  EXPECT_EQ(receiver.counters().messages_lost, 0U);
}

std::vector<Case> cases() {
  std::vector<Case> all;
  for (const ReceiverType& type : receiver_types()) {
    for (const auto begin : {0ms, 130ms, 270ms, 490ms, 610ms, 830ms, 940ms}) {
      all.push_back({type, 3s + begin});
    }
  }
  return all;
}

INSTANTIATE_TEST_SUITE_P(Receivers, Px4Starts, testing::ValuesIn(cases()),
                         [](const testing::TestParamInfo<Case>& at) {
                           return name_of(at.param.type) + "_" +
                                  std::to_string(at.param.begin.count());
                         });

TEST(Px4, WhatItDidNotAskForFallsSilent) {
  SerialLine line;
  UbloxSettings settings = receiver_types().front().settings;
  settings.ubx_messages = {"NAV-SOL", "NAV-POSLLH", "NAV-CLOCK"};
  settings.baud = 38400;
  UbloxReceiver receiver(settings, Calendar(UtcTime{2026, 6, 1, 8, 0, 0, 0}), line);
  line.attach(receiver);
  line.wait_until(kStart + 3s);
  Px4 px4(line);
  ASSERT_TRUE(px4.start()) << px4.reason();
  ASSERT_TRUE(px4.run_for(8s)) << px4.reason();
  px4.forget();
  ASSERT_TRUE(px4.run_for(5s)) << px4.reason();
  EXPECT_EQ(px4.seen(0x01, 0x06), 0);
  EXPECT_EQ(px4.seen(0x01, 0x02), 0);
  EXPECT_EQ(px4.seen(0x01, 0x22), 0);
}

}  // namespace
}  // namespace rigwire::emulators::conversation
