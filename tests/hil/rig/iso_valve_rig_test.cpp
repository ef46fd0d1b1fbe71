// The excavator whose valves are on CAN, in one process, free-running on private wires, with a
// controller on its implement bus.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "hil/configuration/problems.h"
#include "hil/rig/rig.h"
#include "private_wires.h"
#include "protocols/iso11783/auxiliary_valve.h"

namespace rigwire::hil {
namespace {

namespace iso = protocols::iso11783;
using namespace std::chrono_literals;

constexpr const char* kIsoValveRigRigFile = RIGWIRE_SOURCE_DIR "/configs/rigs/excavator_can.yaml";
constexpr unsigned kBoomValve = 2;  // first_valve 1, section 2

std::vector<std::string> private_sets(const rigwire::test::PrivateWires& wires) {
  return {"devices.gnss.path=" + wires.gnss(), "buses.can.path=" + wires.can(),
          "buses.can.wire=slcan", "buses.valves.path=" + (wires.folder / "valves").string(),
          "buses.valves.wire=slcan"};
}

/// Sends a command to the boom every 100 ms of simulated time: neutral, from 0.6 s on
/// extend, from 1.2 s on nothing.
class Controller final : public EventSource {
 public:
  explicit Controller(const std::string& path)
      : line_(::open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK)) {
    write_line("O\r");
  }
  ~Controller() override { ::close(line_); }
  Controller(const Controller&) = delete;
  Controller& operator=(const Controller&) = delete;

  [[nodiscard]] bool is_open() const { return line_ >= 0; }
  [[nodiscard]] SimTime next_event() const override { return next_; }
  [[nodiscard]] SimTime next_wakeup() const override { return next_; }
  void advance(SimTime now) override {
    while (next_ <= now && next_ < kSilent) {
      iso::AuxiliaryValveCommand command;
      const bool moves = next_ >= kStart + 600ms;
      command.flow_share = moves ? 0.5 : 0.0;
      command.resolution = 0;
      command.state =
          static_cast<std::uint8_t>(moves ? iso::ValveState::extend : iso::ValveState::neutral);
      command.fail_safe = 0;
      send(iso::encode(kBoomValve, command, 0x26));
      next_ += 100ms;
    }
    next_ = next_ >= kSilent ? kNever : next_;
    std::array<char, 4096> ignored{};
    while (::read(line_, ignored.data(), ignored.size()) > 0) {
    }
  }

 private:
  void send(const protocols::can::Frame& frame) {
    char text[32];
    int used = std::snprintf(text, sizeof text, "T%08X8", frame.id);
    for (const std::uint8_t byte : frame.data) {
      used +=
          std::snprintf(text + used, sizeof text - static_cast<std::size_t>(used), "%02X", byte);
    }
    write_line(std::string(text) + "\r");
  }
  void write_line(const std::string& text) {
    EXPECT_EQ(::write(line_, text.data(), text.size()), static_cast<ssize_t>(text.size()));
  }

  static constexpr SimTime kSilent = kStart + 1200ms;

  int line_;
  SimTime next_ = kStart + 500ms;
};

/// Lines of the truth file: joint angles and spools every 10 ms.
std::vector<nlohmann::json> iso_valve_rig_run(Duration duration) {
  const rigwire::test::PrivateWires wires;
  const LoadedRig loaded = load_rig(kIsoValveRigRigFile, private_sets(wires));
  const auto truth = wires.folder / "truth.jsonl";
  {
    boost::asio::io_context io;
    Rig rig(loaded.configuration, io, {truth, {}});
    Controller controller((wires.folder / "valves").string());
    EXPECT_TRUE(controller.is_open());
    rig.executive().add(controller);
    const RunOutcome outcome = rig.executive().run_paced({}, kStart + duration);
    EXPECT_FALSE(outcome.fault.has_value()) << *outcome.fault;
  }
  std::vector<nlohmann::json> lines;
  std::ifstream file(truth);
  for (std::string line; std::getline(file, line);) {
    lines.push_back(nlohmann::json::parse(line));
  }
  return lines;
}

TEST(IsoValveRig, CommandsOnTheBusMoveTheBoomAndItsSilenceStopsIt) {
  const auto lines = iso_valve_rig_run(1800ms);
  ASSERT_EQ(lines.size(), 180U);
  const auto boom_rad = [&](std::size_t line) { return lines[line]["joint_rad"][1].get<double>(); };
  const auto spool = [&](std::size_t line) { return lines[line]["spool"][1].get<double>(); };
  EXPECT_EQ(spool(55), 0.0);
  EXPECT_NEAR(spool(110), 0.5, 0.002);
  EXPECT_GT(std::abs(boom_rad(110) - boom_rad(55)), 0.02);
  EXPECT_NEAR(spool(179), 0.0, 1e-4) << "400 ms after the time-out";
}

TEST(IsoValveRig, ALeverForASectionThatIsNotThereIsRefused) {
  const rigwire::test::PrivateWires wires;
  std::vector<std::string> sets = private_sets(wires);
  sets.push_back("devices.valves.joysticks.x1=arm");
  try {
    (void)load_rig(kIsoValveRigRigFile, sets);
    ADD_FAILURE() << "a lever for a section that is not there was taken";
  } catch (const ConfigurationError& error) {
    EXPECT_NE(std::string(error.what()).find("joysticks"), std::string::npos);
  }
}

}  // namespace
}  // namespace rigwire::hil
