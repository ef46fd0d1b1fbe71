// Devices that send without end: every suite ends, and keeps a bounded part of what came. Time is
// the line's own, but of the real sockets and terminals at the end.
#include "conform/bounds.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <deque>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "conform/canopen/canopen_suite.h"
#include "conform/gige_vision/gige_vision_suite.h"
#include "conform/iso_valves/iso_valves_suite.h"
#include "conform/j1939/j1939_suite.h"
#include "conform/modbus/modbus_suite.h"
#include "conform/nmea/nmea_suite.h"
#include "conform/reports.h"
#include "conform/ubx/ubx_suite.h"
#include "conform/velodyne/velodyne_suite.h"

namespace rigwire::conform {
namespace {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;
using std::chrono::seconds;
using testing::HasSubstr;
using Octets = std::vector<std::uint8_t>;
using Instant = Bounds::Instant;

/// The clock of a device that sends without end.
using SharedClock = std::shared_ptr<Instant>;

SharedClock clock_at_zero() {
  return std::make_shared<Instant>(seconds{1000});
}

/// Says the same over and over, as fast as its line carries it, and takes everything.
class EndlessBytes final : public ByteLine {
 public:
  EndlessBytes(SharedClock clock, Octets said, std::size_t bytes_per_s)
      : clock_(std::move(clock)), said_(std::move(said)), bytes_per_s_(bytes_per_s) {}

  bool send(std::span<const std::uint8_t> /*bytes*/) override { return true; }
  bool receive(Octets& bytes, Clock::time_point /*deadline*/) override {
    constexpr std::size_t kChunk = 1024;
    for (std::size_t i = 0; i < kChunk; ++i) {
      bytes.push_back(said_[at_++ % said_.size()]);
    }
    *clock_ += nanoseconds{static_cast<std::int64_t>(kChunk * 1'000'000'000ULL / bytes_per_s_)};
    return true;
  }
  [[nodiscard]] bool closed() const override { return false; }
  [[nodiscard]] Clock::time_point now() const override { return *clock_; }

 private:
  SharedClock clock_;
  Octets said_;
  std::size_t bytes_per_s_;
  std::size_t at_ = 0;
};

/// Noise of a fixed generator: the same numbers each time.
Octets noise(std::size_t size) {
  Octets bytes(size);
  std::uint32_t state = 1;
  for (std::uint8_t& byte : bytes) {
    state = state * 1'664'525U + 1'013'904'223U;
    byte = static_cast<std::uint8_t>(state >> 24U);
  }
  return bytes;
}

std::size_t kept_bytes(const CaseResult& result) {
  std::size_t bytes = 0;
  for (const Step& step : result.steps) {
    bytes += step.bytes.size();
  }
  return bytes;
}

/// All cases are told, none has passed, some were not reached, and little of what came is kept.
void expect_bounded(const SuiteResult& result, std::size_t cases) {
  EXPECT_EQ(result.cases.size(), cases);
  EXPECT_GT(result.count(Verdict::not_reached), 0U);
  for (const CaseResult& each : result.cases) {
    EXPECT_LE(kept_bytes(each), Trial::kKeptBytes + Trial::kKeptStepBytes) << each.identity.id;
    EXPECT_LE(each.steps.size(), Trial::kKeptSteps + 1) << each.identity.id;
  }
}

// --- the bounds themselves ---

TEST(Bounds, NoiseDoesNotProlongAQuestion) {
  const SharedClock clock = clock_at_zero();
  const auto bounds = std::make_shared<Bounds>();
  const auto line = bounded(std::make_unique<EndlessBytes>(clock, Octets{0}, 100'000), bounds);
  const Instant deadline = line->now() + seconds{1};
  Octets bytes;
  while (line->receive(bytes, deadline)) {
  }
  // What may have waited in the system's queue is taken behind it.
  EXPECT_LE(line->now(), deadline + seconds{1});
  EXPECT_LE(bytes.size(), 100'000 + kByteLimits.behind + 2048);
}

TEST(Bounds, WhatComesBetweenTwoQuestionsHasALimit) {
  const auto bounds = std::make_shared<Bounds>();
  const auto line =
      bounded(std::make_unique<EndlessBytes>(clock_at_zero(), Octets{0}, 1U << 30U), bounds);
  Octets bytes;
  const auto hear_everything = [&] {
    while (line->receive(bytes, line->now() + seconds{60})) {
      bytes.clear();
    }
  };
  EXPECT_THROW(hear_everything(), TooMuch);
  // A question begins the count anew.
  std::size_t came = 0;
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(line->send(Octets{1}));
    for (came = 0; came < kByteLimits.question / 2; came += bytes.size()) {
      bytes.clear();
      ASSERT_TRUE(line->receive(bytes, line->now() + seconds{60}));
    }
  }
}

TEST(Bounds, ACaseThatRunsAtTheLimitIsCutOffBehindTheGrace) {
  const SharedClock clock = clock_at_zero();
  const auto bounds = std::make_shared<Bounds>(seconds{5});
  const auto line = bounded(std::make_unique<EndlessBytes>(clock, Octets{0}, 10'000), bounds);
  Octets bytes;
  ASSERT_TRUE(line->receive(bytes, line->now() + seconds{1}));
  *clock += seconds{7};
  ASSERT_TRUE(line->receive(bytes, line->now() + seconds{1})) << "within the grace";
  EXPECT_TRUE(bounds->passed());
  *clock += Bounds::kGrace;
  EXPECT_THROW(static_cast<void>(line->receive(bytes, line->now() + seconds{1})), TimeIsUp);
  EXPECT_THROW(static_cast<void>(line->send(bytes)), TimeIsUp);
  bounds->begin();
  EXPECT_FALSE(bounds->passed());
}

TEST(Bounds, AFloodFailsItsCaseAndNotTheNext) {
  Bounds bounds;
  const CaseIdentity identity{"suite/1/1", "", "", Strength::must, Danger::none};
  const CaseResult flooded = try_case(
      identity, bounds, [&] { return Trial(identity); },
      [](Trial&) { throw TooMuch("at most 4096 KiB", "more than 4096 KiB"); });
  EXPECT_EQ(flooded.verdict, Verdict::fail);
  EXPECT_EQ(flooded.expected, "at most 4096 KiB");
  const CaseResult next = try_case(
      identity, bounds, [&] { return Trial(identity); }, [](Trial&) {});
  EXPECT_EQ(next.verdict, Verdict::pass);
}

/// A silent line whose machine wakes the suite up late after a deadline.
class LateBytes final : public ByteLine {
 public:
  explicit LateBytes(std::deque<milliseconds> late) : late_(std::move(late)) {}

  bool send(std::span<const std::uint8_t> /*bytes*/) override { return true; }
  bool receive(Octets& /*bytes*/, Clock::time_point deadline) override {
    now_ = std::max(now_, deadline) + late_.front();
    late_.pop_front();
    return false;
  }
  [[nodiscard]] bool closed() const override { return false; }
  [[nodiscard]] Clock::time_point now() const override { return now_; }

 private:
  std::deque<milliseconds> late_;
  Instant now_{seconds{1000}};
};

/// A case that asks once and gets no answer, on a machine that is that late in its tries.
CaseResult unanswered(const std::deque<milliseconds>& late, std::size_t& tries) {
  const auto bounds = std::make_shared<Bounds>();
  const auto line = bounded(std::make_unique<LateBytes>(late), bounds);
  const CaseIdentity identity{"suite/1/1", "", "", Strength::must, Danger::none};
  return try_case(
      identity, *bounds, [&] { return Trial(identity, [&] { return line->now(); }); },
      [&](Trial& trial) {
        ++tries;
        Octets bytes;
        trial.expect(line->receive(bytes, line->now() + milliseconds{100}), "an answer", "none");
      });
}

TEST(Bounds, ACaseThatFailsWhileThisMachineIsLateIsTriedAgain) {
  std::size_t tries = 0;
  const CaseResult again = unanswered({milliseconds{150}, milliseconds{2}}, tries);
  EXPECT_EQ(tries, 2U);
  EXPECT_EQ(again.verdict, Verdict::fail) << "the second try was in time";
  ASSERT_FALSE(again.steps.empty());
  EXPECT_EQ(again.steps.front().words,
            "try 2: in the one before this machine held the suite up for 150 ms");
}

TEST(Bounds, ACaseThatFailsInTimeOrTooOftenIsNotTriedAgain) {
  std::size_t tries = 0;
  EXPECT_EQ(unanswered({milliseconds{2}}, tries).verdict, Verdict::fail);
  EXPECT_EQ(tries, 1U);
  tries = 0;
  const milliseconds late{150};
  EXPECT_EQ(unanswered({late, late, late, late}, tries).verdict, Verdict::fail);
  EXPECT_EQ(tries, 3U);
}

TEST(Trial, KeepsABoundedPartOfWhatCame) {
  Trial trial({"suite/1/1", "", "", Strength::must, Danger::none});
  const Octets much(1U << 20U);
  for (int i = 0; i < 200; ++i) {
    trial.received(much, "much");
  }
  const CaseResult result = trial.result();
  EXPECT_LE(kept_bytes(result), Trial::kKeptBytes + Trial::kKeptStepBytes);
  EXPECT_THAT(result.steps.front().words, HasSubstr("of 1048576 bytes"));
  EXPECT_EQ(result.steps.back().words, "further exchanges are not kept");
}

TEST(Reports, ACaseThatWasNotReachedIsAnErrorForCiAndReadBack) {
  const Bounds bounds(seconds{60});
  SuiteResult result{"suite", "tcp:127.0.0.1:1", "0123", {}};
  result.cases.push_back(
      not_reached({"suite/1/1", "A title", "A document", Strength::must, Danger::none}, bounds));
  EXPECT_EQ(result.cases[0].got, "the suite's limit of 60 s has passed");
  EXPECT_THAT(junit_text(result), HasSubstr("errors=\"1\""));
  EXPECT_THAT(junit_text(result), HasSubstr("<error message=\"the suite"));
  EXPECT_THAT(summary(result), HasSubstr("1 not reached"));
  EXPECT_EQ(from_json(to_json(result)).cases.at(0).verdict, Verdict::not_reached);
}

// --- each suite ---

struct Said {
  const char* name;
  Octets bytes;
};
void PrintTo(const Said& said, std::ostream* out) {
  *out << said.name;
}

class UbxEndless : public testing::TestWithParam<Said> {};

TEST_P(UbxEndless, TheSuiteEndsAtItsLimit) {
  const SharedClock clock = clock_at_zero();
  const Instant begin = *clock;
  UbxDevice device;
  device.open = [&] { return std::make_unique<EndlessBytes>(clock, GetParam().bytes, 100'000); };
  device.claims.messages = {"MON-VER", "NAV-PVT", "CFG-RATE"};
  device.bounds = std::make_shared<Bounds>(seconds{10});
  const SuiteResult result = run_ubx_suite(device, {});
  expect_bounded(result, ubx_cases().size());
  EXPECT_EQ(result.count(Verdict::pass), 0U);
  EXPECT_LE(*clock, begin + seconds{10} + Bounds::kGrace + seconds{1});
}

INSTANTIATE_TEST_SUITE_P(
    , UbxEndless,
    testing::Values(Said{"zeros", {0}}, Said{"noise", noise(65'537)},
                    Said{"sentences_without_end", {'$', 'G', 'P', 'G', 'G', 'A', ','}},
                    Said{"frames_of_8192", {0xB5, 0x62, 0x01, 0x07, 0x00, 0x20}},
                    Said{"frames_of_65535", {0xB5, 0x62, 0x01, 0x07, 0xFF, 0xFF}}),
    [](const auto& said) { return std::string(said.param.name); });

/// A bus that is full of frames of one node.
class EndlessFrames final : public CanLine {
 public:
  EndlessFrames(SharedClock clock, protocols::can::Frame said)
      : clock_(std::move(clock)), said_(said) {}
  bool send(const protocols::can::Frame& /*frame*/) override { return true; }
  std::optional<protocols::can::Frame> receive(Clock::time_point /*deadline*/) override {
    *clock_ += std::chrono::microseconds{500};
    return said_;
  }
  [[nodiscard]] Clock::time_point now() const override { return *clock_; }

 private:
  SharedClock clock_;
  protocols::can::Frame said_;
};

protocols::can::Frame frame_of(std::uint32_t id, bool extended) {
  protocols::can::Frame frame;
  frame.id = id;
  frame.extended = extended;
  frame.length = 8;
  return frame;
}

TEST(CanopenEndless, TheSuiteEndsAtItsLimit) {
  for (const std::uint32_t id : {0x123U, 0x581U, 0x701U}) {
    const SharedClock clock = clock_at_zero();
    const Instant begin = *clock;
    CanopenDevice device;
    device.open = [&] { return std::make_unique<EndlessFrames>(clock, frame_of(id, false)); };
    for (const CanopenCase& each : canopen_cases()) {
      device.claims.objects.insert(device.claims.objects.end(), each.needs.begin(),
                                   each.needs.end());
    }
    device.bounds = std::make_shared<Bounds>(seconds{10});
    const SuiteResult result = run_canopen_suite(device, {{}, true, true, true});
    expect_bounded(result, canopen_cases().size());
    EXPECT_LE(*clock, begin + seconds{10} + Bounds::kGrace + seconds{3}) << id;
  }
}

TEST(J1939Endless, TheSuiteEndsAtItsLimit) {
  const SharedClock clock = clock_at_zero();
  const Instant begin = *clock;
  J1939Device device;
  // A control message of transport to everybody, over and over.
  device.open = [&] { return std::make_unique<EndlessFrames>(clock, frame_of(0x18ECFF00, true)); };
  device.claims.requested = groups_to_ask_for();
  device.bounds = std::make_shared<Bounds>(seconds{20});
  const SuiteResult result = run_j1939_suite(device, {{}, true, true, true});
  expect_bounded(result, j1939_cases().size());
  EXPECT_LE(*clock, begin + seconds{20} + Bounds::kGrace + seconds{3});
}

TEST(IsoValvesEndless, TheSuiteEndsAtItsLimit) {
  const SharedClock clock = clock_at_zero();
  const Instant begin = *clock;
  IsoValveDevice device;
  device.open = [&] { return std::make_unique<EndlessFrames>(clock, frame_of(0x18ECFF80, true)); };
  device.bounds = std::make_shared<Bounds>(seconds{10});
  const SuiteResult result = run_iso_valve_suite(device, {{}, true, true, true});
  expect_bounded(result, iso_valve_cases().size());
  EXPECT_LE(*clock, begin + seconds{10} + Bounds::kGrace + seconds{3});
}

/// A camera that says yes to everything, and floods the port of the stream.
class FloodingCamera final : public DatagramLine {
 public:
  explicit FloodingCamera(SharedClock clock) : clock_(std::move(clock)) {}

  static inline const Peer kCamera{"127.0.0.2", 3956};

  bool send(std::size_t from_port, const Peer& /*to*/,
            std::span<const std::uint8_t> bytes) override {
    if (bytes.size() >= 8) {
      answers_.push_back({from_port,
                          kCamera,
                          *clock_,
                          {0, 0, bytes[2], static_cast<std::uint8_t>(bytes[3] + 1), 0, 4, bytes[6],
                           bytes[7], 0xFF, 0xFF, 0xFF, 0xFF}});
    }
    return true;
  }
  std::optional<Datagram> receive(Clock::time_point /*deadline*/) override {
    *clock_ += std::chrono::microseconds{100};
    if (!answers_.empty()) {
      Datagram first = std::move(answers_.front());
      answers_.pop_front();
      return first;
    }
    return Datagram{2, kCamera, *clock_, Octets(1400)};
  }
  [[nodiscard]] Peer own(std::size_t port) const override {
    return {"127.0.0.1", static_cast<std::uint16_t>(40'000 + port)};
  }
  [[nodiscard]] Clock::time_point now() const override { return *clock_; }

 private:
  SharedClock clock_;
  std::deque<Datagram> answers_;
};

TEST(GigeVisionEndless, TheSuiteEndsAtItsLimit) {
  const SharedClock clock = clock_at_zero();
  const Instant begin = *clock;
  GigeVisionDevice device;
  device.open = [&] { return std::make_unique<FloodingCamera>(clock); };
  device.camera = FloodingCamera::kCamera;
  device.own_address = "127.0.0.1";
  device.claims.start = GigeRegister{0xA104, 1};
  device.claims.stop = GigeRegister{0xA104, 0};
  device.bounds = std::make_shared<Bounds>(seconds{5});
  const SuiteResult result = run_gige_vision_suite(device, {{}, true, true, true});
  expect_bounded(result, gige_vision_cases().size());
  EXPECT_LE(*clock, begin + seconds{5} + Bounds::kGrace + seconds{3});
  EXPECT_LE(device.waiting_bytes, kDatagramLimits.question);
}

TEST(NmeaEndless, ListeningEndsWithTheBytesThatAreKept) {
  const Octets sentence{'$', 'G', 'P', 'G', 'G', 'A', ',', '*', '0', '0', '\r', '\n'};
  for (const Octets& said : {Octets{0}, sentence, noise(65'537)}) {
    EndlessBytes line(clock_at_zero(), said, 100U << 20U);
    const NmeaLog log = listen_nmea(line, seconds{2});
    EXPECT_FALSE(log.overflow().empty());
    const SuiteResult result = run_nmea_suite(log, {}, {});
    EXPECT_EQ(result.cases.size(), nmea_cases().size());
    EXPECT_EQ(result.count(Verdict::fail), result.cases.size());
    EXPECT_THROW(static_cast<void>(survey_nmea(log)), Unreachable);
  }
}

TEST(VelodyneEndless, ListeningEndsWithTheBytesThatAreKept) {
  const SharedClock clock = clock_at_zero();
  /// A flood like the camera's stream, but faster than any lidar sends.
  class Flood final : public DatagramLine {
   public:
    explicit Flood(SharedClock at) : clock_(std::move(at)) {}
    bool send(std::size_t /*port*/, const Peer& /*to*/,
              std::span<const std::uint8_t> /*bytes*/) override {
      return true;
    }
    std::optional<Datagram> receive(Clock::time_point /*deadline*/) override {
      *clock_ += std::chrono::microseconds{10};
      return Datagram{0, {"127.0.0.1", 2368}, *clock_, Octets(1206)};
    }
    [[nodiscard]] Peer own(std::size_t /*port*/) const override { return {"127.0.0.1", 2368}; }
    [[nodiscard]] Clock::time_point now() const override { return *clock_; }

   private:
    SharedClock clock_;
  };
  Flood line(clock);
  const VelodyneClaims claims;
  const VelodyneLog log = listen_velodyne(line, seconds{1}, claims);
  EXPECT_FALSE(log.overflow().empty());
  EXPECT_LE(log.data_datagrams().size() * 1206, std::size_t{64} << 20U);
  const SuiteResult result = run_velodyne_suite(log, claims, {});
  EXPECT_EQ(result.count(Verdict::fail), result.cases.size());
  EXPECT_THROW(static_cast<void>(survey_velodyne(log)), Unreachable);
}

// --- real transports ---

/// A server on TCP whose every connection is sent the same bytes without end.
class EndlessServer {
 public:
  explicit EndlessServer(Octets said) : said_(std::move(said)) {
    listener_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    EXPECT_EQ(::bind(listener_, reinterpret_cast<sockaddr*>(&address), size), 0);
    EXPECT_EQ(::listen(listener_, 64), 0);
    ::getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size);
    port_ = ntohs(address.sin_port);
    thread_ = std::thread([this] { serve(); });
  }
  ~EndlessServer() {
    stopped_ = true;
    thread_.join();
    for (const int client : clients_) {
      ::close(client);
    }
    ::close(listener_);
  }
  EndlessServer(const EndlessServer&) = delete;
  EndlessServer& operator=(const EndlessServer&) = delete;

  [[nodiscard]] std::uint16_t port() const { return port_; }

 private:
  void serve() {
    Octets block;
    while (block.size() < 65'536) {
      block.insert(block.end(), said_.begin(), said_.end());
    }
    while (!stopped_) {
      const int fresh = ::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
      if (fresh >= 0) {
        clients_.push_back(fresh);
      }
      bool sent = false;
      std::erase_if(clients_, [&](int client) {
        const ssize_t count = ::send(client, block.data(), block.size(), MSG_NOSIGNAL);
        sent = sent || count > 0;
        const bool gone = count < 0 && errno != EAGAIN && errno != EINTR;
        if (gone) {
          ::close(client);
        }
        return gone;
      });
      if (!sent) {
        ::poll(nullptr, 0, 1);
      }
    }
  }

  Octets said_;
  int listener_ = -1;
  std::uint16_t port_ = 0;
  std::vector<int> clients_;
  std::atomic<bool> stopped_{false};
  std::thread thread_;
};

ModbusDevice modbus_device(Endpoint::Kind kind, const std::string& address, std::uint16_t port) {
  ModbusDevice device;
  device.endpoint = {kind, address, port, kind == Endpoint::Kind::serial ? 115'200U : 0U};
  device.claims.functions = {3};
  device.claims.tables[2] = {{0, 9}};
  device.claims.patience = milliseconds{200};
  return device;
}

TEST(ModbusEndless, AnAnswerOnTcpThatDoesNotEndFailsItsCase) {
  // Right headers of an answer that nobody asked for; what is none; a length that never comes
  // whole.
  for (const Octets& said : {Octets{0, 1, 0, 0, 0, 3, 1, 0x83, 2}, Octets{0xFF}, noise(65'537)}) {
    const EndlessServer server(said);
    ModbusDevice device = modbus_device(Endpoint::Kind::tcp, "127.0.0.1", server.port());
    const SuiteResult result = run_modbus_suite(device, {{"modbus/6.3", "modbus-tcp/3.1.3"}});
    EXPECT_GT(result.cases.size(), 5U);
    EXPECT_GT(result.count(Verdict::fail), 0U);
    for (const CaseResult& each : result.cases) {
      EXPECT_LE(kept_bytes(each), Trial::kKeptBytes + Trial::kKeptStepBytes) << each.identity.id;
    }
  }
}

TEST(ModbusEndless, NoiseOnASerialLineEndsTheSuiteAtItsLimit) {
  const int terminal = ::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC | O_NONBLOCK);
  ASSERT_GE(terminal, 0);
  ASSERT_EQ(::grantpt(terminal), 0);
  ASSERT_EQ(::unlockpt(terminal), 0);
  std::array<char, 64> name{};
  ASSERT_EQ(::ptsname_r(terminal, name.data(), name.size()), 0);
  std::atomic<bool> stopped{false};
  std::thread talker([&] {
    const Octets said = noise(4096);
    while (!stopped) {
      if (::write(terminal, said.data(), said.size()) <= 0) {
        ::poll(nullptr, 0, 1);
      }
      Octets ignored(4096);
      static_cast<void>(::read(terminal, ignored.data(), ignored.size()));
    }
  });
  ModbusDevice device = modbus_device(Endpoint::Kind::serial, name.data(), 0);
  device.bounds = std::make_shared<Bounds>(seconds{2});
  const SuiteResult result = run_modbus_suite(device, {{}, true, true});
  stopped = true;
  talker.join();
  ::close(terminal);
  EXPECT_EQ(result.cases.size(), modbus_cases().size());
  EXPECT_EQ(result.count(Verdict::pass), 0U);
  EXPECT_GT(result.count(Verdict::not_reached), 0U);
}

TEST(AdapterEndless, NoiseFromAnAdapterDoesNotProlongAQuestion) {
  const int terminal = ::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC | O_NONBLOCK);
  ASSERT_GE(terminal, 0);
  ASSERT_EQ(::grantpt(terminal), 0);
  ASSERT_EQ(::unlockpt(terminal), 0);
  std::array<char, 64> name{};
  ASSERT_EQ(::ptsname_r(terminal, name.data(), name.size()), 0);
  std::atomic<bool> stopped{false};
  std::thread talker([&] {
    const Octets said(4096, 'x');
    while (!stopped) {
      if (::write(terminal, said.data(), said.size()) <= 0) {
        ::poll(nullptr, 0, 1);
      }
      Octets ignored(4096);
      static_cast<void>(::read(terminal, ignored.data(), ignored.size()));
    }
  });
  {
    const auto line = open_can({Endpoint::Kind::slcan, name.data(), 0, 250'000});
    EXPECT_FALSE(line->receive(CanLine::Clock::now() + milliseconds{50}).has_value());
  }
  stopped = true;
  talker.join();
  ::close(terminal);
}

}  // namespace
}  // namespace rigwire::conform
