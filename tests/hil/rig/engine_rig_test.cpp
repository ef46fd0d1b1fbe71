// The excavator's engine in one process, free-running on private wires: its controller on the bus,
// a field controller that asks for a speed, and the load of the pumps.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "hil/configuration/problems.h"
#include "hil/rig/rig.h"
#include "private_wires.h"
#include "protocols/iso11783/auxiliary_valve.h"
#include "protocols/vehicle/engine.h"

namespace rigwire::hil {
namespace {

namespace iso = protocols::iso11783;
namespace vehicle = protocols::vehicle;
using namespace std::chrono_literals;

constexpr const char* kEngineRigRigFile = RIGWIRE_SOURCE_DIR "/configs/rigs/excavator_can.yaml";
constexpr double kRpm = vehicle::kRevolutionPerMinute_radps;

/// A serial-line adapter on one of the rig's buses.
class Adapter {
 public:
  explicit Adapter(const std::string& path)
      : line_(::open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK)) {
    EXPECT_GE(line_, 0) << path;
    write_line("O\r");
  }
  ~Adapter() { ::close(line_); }
  Adapter(const Adapter&) = delete;
  Adapter& operator=(const Adapter&) = delete;

  void send(const protocols::can::Frame& frame) {
    char text[32];
    int used = std::snprintf(text, sizeof text, "T%08X8", frame.id);
    for (const std::uint8_t byte : frame.data) {
      used +=
          std::snprintf(text + used, sizeof text - static_cast<std::size_t>(used), "%02X", byte);
    }
    write_line(std::string(text) + "\r");
  }
  /// Everything heard since the start.
  const std::string& heard() {
    std::array<char, 4096> bytes{};
    for (ssize_t got = 0; (got = ::read(line_, bytes.data(), bytes.size())) > 0;) {
      heard_.append(bytes.data(), static_cast<std::size_t>(got));
    }
    return heard_;
  }

 private:
  void write_line(const std::string& text) {
    EXPECT_EQ(::write(line_, text.data(), text.size()), static_cast<ssize_t>(text.size()));
  }
  int line_;
  std::string heard_;
};

/// From 1 s to 2.5 s asks every 10 ms for 1200 rpm; from 5 s to 7 s lifts the boom.
class Field final : public EventSource {
 public:
  explicit Field(const rigwire::test::PrivateWires& wires)
      : machine_(wires.can()), implements_((wires.folder / "valves").string()) {}

  [[nodiscard]] SimTime next_event() const override { return next_; }
  [[nodiscard]] SimTime next_wakeup() const override { return next_; }
  void advance(SimTime now) override {
    for (; next_ <= now; next_ += 10ms) {
      const Duration at = next_ - kStart;
      if (at >= 1s && at < 2500ms) {
        vehicle::Tsc1 request;
        request.override_mode = static_cast<std::uint8_t>(vehicle::OverrideMode::speed);
        request.speed_radps = 1200.0 * kRpm;
        machine_.send(vehicle::encode(request, 0x27, 0x00));
      }
      if (at >= 4900ms && at < 7s && at % 100ms == Duration{0}) {
        iso::AuxiliaryValveCommand command;
        const bool lifts = at >= 5s;
        command.flow_share = lifts ? 1.0 : 0.0;
        command.resolution = 0;
        command.fail_safe = 0;
        command.state =
            static_cast<std::uint8_t>(lifts ? iso::ValveState::extend : iso::ValveState::neutral);
        constexpr unsigned kBoomValve = 2;
        implements_.send(iso::encode(kBoomValve, command, 0x26));
      }
      (void)machine_.heard();
      (void)implements_.heard();
    }
  }
  [[nodiscard]] const std::string& heard() { return machine_.heard(); }

 private:
  Adapter machine_;
  Adapter implements_;
  SimTime next_ = kStart + 10ms;
};

struct Outcome {
  std::vector<double> engine_rpm;  ///< Every 10 ms.
  std::string heard;
};

Outcome run(Duration duration) {
  const rigwire::test::PrivateWires wires;
  const LoadedRig loaded = load_rig(
      kEngineRigRigFile,
      {"devices.gnss.path=" + wires.gnss(), "buses.can.path=" + wires.can(), "buses.can.wire=slcan",
       "buses.valves.wire=slcan", "buses.valves.path=" + (wires.folder / "valves").string()});
  const auto truth = wires.folder / "truth.jsonl";
  Outcome outcome;
  {
    boost::asio::io_context io;
    Rig rig(loaded.configuration, io, {truth, {}});
    Field field(wires);
    rig.executive().add(field);
    const RunOutcome ended = rig.executive().run_free(kStart + duration);
    EXPECT_FALSE(ended.fault.has_value()) << *ended.fault;
    outcome.heard = field.heard();
  }
  std::ifstream file(truth);
  for (std::string line; std::getline(file, line);) {
    outcome.engine_rpm.push_back(nlohmann::json::parse(line)["engine_radps"].get<double>() / kRpm);
  }
  return outcome;
}

/// Speed of every EEC1 that was heard, rpm.
std::vector<double> reported_rpm(const std::string& heard) {
  constexpr std::string_view kEec1 = "T0CF004008";
  std::vector<double> result;
  for (std::size_t at = heard.find(kEec1); at != std::string::npos && at + 26 <= heard.size();
       at = heard.find(kEec1, at + 1)) {
    const std::string data = heard.substr(at + kEec1.size(), 16);
    const unsigned low = static_cast<unsigned>(std::stoul(data.substr(6, 2), nullptr, 16));
    const unsigned high = static_cast<unsigned>(std::stoul(data.substr(8, 2), nullptr, 16));
    result.push_back(0.125 * static_cast<double>(low + 256 * high));
  }
  return result;
}

TEST(EngineRig, ASpeedRequestIsObeyedItsSilenceEndsItAndLoadCostsSpeed) {
  const Outcome outcome = run(8s);
  const std::vector<double>& rpm = outcome.engine_rpm;
  ASSERT_EQ(rpm.size(), 800U);
  const double idle = rpm[95];
  EXPECT_GT(idle, 1930.0) << "without load above the dial's 1900 by the droop";
  EXPECT_LT(idle, 1977.0);
  EXPECT_NEAR(rpm[249], 1200.0 + (idle - 1900.0) * 0.6, 20.0) << "1200 rpm were asked for";
  EXPECT_NEAR(rpm[480], idle, 5.0) << "the dial's again, 2.3 s after the last request";
  double least = idle;
  for (std::size_t i = 510; i < 700; ++i) {
    least = std::min(least, rpm[i]);
  }
  EXPECT_LT(least, idle - 20.0) << "the boom goes up on the engine's account";
  EXPECT_GT(least, 1700.0) << "the pumps leave it alive";

  const std::vector<double> reported = reported_rpm(outcome.heard);
  ASSERT_GT(reported.size(), 300U) << "50 a second";
  // A reader beside a free run may lose any frames, so the ends are compared.
  const auto told = std::ranges::minmax(reported);
  const auto was = std::ranges::minmax(rpm);
  EXPECT_NEAR(told.min, was.min, 5.0);
  EXPECT_NEAR(told.max, was.max, 5.0);
}

}  // namespace
}  // namespace rigwire::hil
