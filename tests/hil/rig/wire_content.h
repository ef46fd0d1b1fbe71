// What the devices of a rig say, decoded: numbers by name over a time, to be compared with those of
// another run; and clients of the rigs of tests/hil/streams/ that ask and command them.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <map>
#include <numeric>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "hil/rig/rig_configuration.h"
#include "protocols/bytes.h"
#include "protocols/can/message.h"
#include "protocols/canopen/identifiers.h"
#include "protocols/canopen/sdo.h"
#include "protocols/iso11783/auxiliary_valve.h"
#include "protocols/j1939/message.h"
#include "protocols/modbus/rtu.h"
#include "protocols/openimu/settings.h"
#include "protocols/vehicle/diagnostics.h"
#include "protocols/velodyne/data_packet.h"
#include "wire_clients.h"

namespace rigwire::hil::test {

using namespace std::chrono_literals;

/// Values in their order, by what they are of.
using Content = std::map<std::string, std::vector<double>>;

inline void add_frame(Content& content, const std::string& bus,
                      const std::vector<protocols::can::OwnedMessage>& layouts,
                      const protocols::can::Frame& frame) {
  for (const protocols::can::OwnedMessage& layout : layouts) {
    if (layout.id != frame.id || layout.extended != frame.extended || layout.sender.empty()) {
      continue;
    }
    for (std::size_t i = 0; i < layout.signals.size(); ++i) {
      const auto reading = protocols::can::get(layout, i, frame.payload());
      const std::string name = bus + ": " + layout.name + " " + layout.signals[i].name;
      content[reading.valid() ? name : name + " not available"].push_back(
          reading.valid() ? reading.value : 0.0);
    }
  }
}

/// Returns that a Velodyne data packet has, and how far they are on the average.
inline void add_points(Content& content, const std::string& device,
                       const protocols::velodyne::DataPacket& packet) {
  double sum = 0.0;
  double count = 0.0;
  for (const auto& block : packet.blocks) {
    for (const auto& channel : block.channels) {
      sum += channel.distance_counts;
      count += channel.distance_counts > 0 ? 1.0 : 0.0;
    }
  }
  content[device + ": returns"].push_back(count);
  content[device + ": distance"].push_back(count > 0.0 ? sum / count : 0.0);
}

/// GGA: place, kind of fix and satellites.
inline void add_sentences(Content& content, const std::string& device, const std::string& line) {
  for (std::size_t at = line.find("GGA,"); at != std::string::npos;
       at = line.find("GGA,", at + 1)) {
    std::istringstream text(line.substr(at, line.find('\r', at) - at));
    std::vector<std::string> fields;
    for (std::string field; std::getline(text, field, ',');) {
      fields.push_back(field);
    }
    if (fields.size() < 10) {
      continue;  // cut by the time that is looked at
    }
    const auto number = [&](std::size_t i) { return std::atof(fields[i].c_str()); };
    content[device + ": GGA latitude"].push_back(number(2));
    content[device + ": GGA longitude"].push_back(number(4));
    content[device + ": GGA quality"].push_back(number(6));
    content[device + ": GGA satellites"].push_back(number(7));
    content[device + ": GGA altitude"].push_back(number(9));
  }
}

/// Input registers 0 .. 22 in answers to function 4; pressures and what counts are not among them.
inline constexpr std::size_t kReadRegisters = 23;
inline void add_registers(Content& content, const std::string& line,
                          std::span<const std::uint8_t> values) {
  for (std::size_t i = 0; i < kReadRegisters && 2 * i + 1 < values.size(); ++i) {
    content[line + ": register " + std::to_string(i)].push_back(
        static_cast<std::int16_t>(values[2 * i] << 8U | values[2 * i + 1]));
  }
}
inline void add_tcp(Content& content, const std::string& line,
                    std::span<const std::uint8_t> bytes) {
  if (bytes.size() == 9 + 2 * kReadRegisters && bytes[7] == 4) {
    add_registers(content, line, bytes.subspan(9));
  }
}
inline void add_rtu(Content& content, const std::string& line,
                    const std::vector<std::uint8_t>& bytes) {
  constexpr std::uint8_t kUnit = 3;
  constexpr std::size_t kAnswer = 3 + 2 * kReadRegisters + 2;
  for (std::size_t i = 0; i + kAnswer <= bytes.size(); ++i) {
    const std::span<const std::uint8_t> answer = std::span(bytes).subspan(i, kAnswer);
    if (answer[0] == kUnit && answer[1] == 4 && answer[2] == 2 * kReadRegisters &&
        protocols::modbus::crc16(answer) == 0) {
      add_registers(content, line, answer.subspan(3, 2 * kReadRegisters));
    }
  }
}

/// What was on the rig's wires in [from, to).
[[nodiscard]] inline Content content_of(const RigConfiguration& rig, const WireClients& clients,
                                        SimTime from, SimTime to) {
  Content content;
  for (const std::string& wire : clients.wires()) {
    const auto layouts = bus_messages(rig, wire);
    std::vector<std::uint8_t> line;
    for (const WireClients::Unit& unit : clients.heard(wire)) {
      if (unit.at < from || unit.at >= to) {
        continue;
      }
      if (!layouts.empty()) {
        add_frame(content, wire, layouts, unit.frame);
      } else if (const auto packet = protocols::velodyne::decode_data_packet(unit.bytes);
                 packet.ok()) {
        add_points(content, wire, *packet);
      } else {
        add_tcp(content, wire, unit.bytes);
        line.insert(line.end(), unit.bytes.begin(), unit.bytes.end());
      }
    }
    add_sentences(content, wire, std::string(line.begin(), line.end()));
    add_rtu(content, wire, line);
  }
  return content;
}

/// How far apart the averages of the same thing may be that was measured in another noise: four
/// deviations, and half a percent of it; more where something was acquired again.
inline double tolerance_of(const std::string& name, double mean, double deviation) {
  const auto is = [&](const char* what) { return name.find(what) != std::string::npos; };
  if (is("GGA latitude") || is("GGA longitude")) {
    return 0.006;  // of a minute: 11 m
  }
  if (is("latitude") || is("longitude")) {
    return 1e-4;  // degrees: 11 m
  }
  if (is("altitude")) {
    return 15.0;
  }
  if (is("satellites")) {
    return 2.0;
  }
  if (is("quality")) {
    return 1.0;  // float or fixed, with or without corrections
  }
  if (is("register 19")) {
    return 10.0;  // a degree: the driver cools down
  }
  if (is("returns") || is("distance")) {
    return 0.02 * mean;
  }
  return 4.0 * deviation + 5e-3 * std::abs(mean) + 1e-9;
}

inline void expect_alike(const Content& content, const Content& usual) {
  for (const auto& [name, values] : usual) {
    const auto found = content.find(name);
    const std::string known = name.substr(0, name.find(" not available"));
    if (found == content.end() && known != name && content.contains(known)) {
      continue;  // a course, known since something moved
    }
    ASSERT_NE(found, content.end()) << name << " is not said any more";
    const auto n = static_cast<double>(values.size());
    EXPECT_NEAR(static_cast<double>(found->second.size()), n, std::max(2.0, 0.1 * n)) << name;
    // What counts on counts on from where it has begun again.
    if (name.find("GGA") == std::string::npos && values.size() > 3 &&
        values.front() < values.back() && std::ranges::is_sorted(values)) {
      EXPECT_TRUE(std::ranges::is_sorted(found->second)) << name;
      continue;
    }
    const auto mean_of = [](const std::vector<double>& of) {
      return std::accumulate(of.begin(), of.end(), 0.0) / static_cast<double>(of.size());
    };
    const double mean = mean_of(values);
    double squares = 0.0;
    for (const double value : values) {
      squares += (value - mean) * (value - mean);
    }
    EXPECT_NEAR(mean_of(found->second), mean, tolerance_of(name, mean, std::sqrt(squares / n)))
        << name;
  }
}

// Clients.

/// On the buses of can.yaml: an encoder is written to, an inertial unit is told to save, and a
/// gateway to forget its trouble codes. None of it changes anything.
inline void ask_nodes(WireClients& clients, SimTime at) {
  constexpr std::uint8_t kTester = 0x55;
  for (const char* bus : {"can", "motion"}) {
    clients.say(bus, kStart + 500ms, drivers::CanClient{.open = true});
  }
  const std::array<std::uint8_t, 2> heartbeat{100, 0};
  clients.say("motion", at,
              protocols::canopen::make_frame(
                  0x600 + 0x20, protocols::canopen::make_download({0x1017, 0}, heartbeat)));
  clients.say("can", at,
              protocols::openimu::make_setting(
                  {protocols::openimu::Command::save_configuration, 0x80, 0, 0, 0}, kTester));
  clients.say("can", at + 20ms,
              protocols::j1939::make_request(kTester, 0x27, protocols::vehicle::kDm3Pgn));
}

/// On the line of gnss.yaml: CFG-RATE of the rig's own 5 Hz.
inline void ask_receiver(WireClients& clients, SimTime at) {
  clients.say("gnss", kStart + 500ms, drivers::LineClient{true, 115200});
  WireClients::Bytes bytes{0xB5, 0x62, 0x06, 0x08, 6, 0, 200, 0, 1, 0, 1, 0};
  std::uint8_t a = 0;
  std::uint8_t b = 0;
  for (std::size_t i = 2; i < bytes.size(); ++i) {
    a = static_cast<std::uint8_t>(a + bytes[i]);
    b = static_cast<std::uint8_t>(b + a);
  }
  bytes.push_back(a);
  bytes.push_back(b);
  clients.say("gnss", at, SerialPiece{}, bytes);
}

/// The drivers of modbus.yaml: ten times a second they are commanded, and as often read. Spools
/// move while a fault may hold, those on Modbus back as long; then their faults are reset. A block
/// on CAN resets by the neutral that it is told.
inline void work_valves(WireClients& clients, SimTime fault, Duration length, SimTime to) {
  std::uint16_t transaction = 0;
  std::uint64_t connection = 0;
  const auto put = [](WireClients::Bytes& bytes, int value) {
    bytes.push_back(static_cast<std::uint8_t>(value >> 8));
    bytes.push_back(static_cast<std::uint8_t>(value));
  };
  const auto ask = [&](SimTime at, const WireClients::Bytes& request) {
    WireClients::Bytes tcp;
    put(tcp, ++transaction);
    put(tcp, 0);
    put(tcp, static_cast<int>(request.size()) + 1);
    tcp.push_back(1);
    tcp.insert(tcp.end(), request.begin(), request.end());
    clients.say("tcp", at, StreamPiece{{}, connection, StreamPiece::What::bytes, {}}, tcp);
    WireClients::Bytes rtu{3};
    rtu.insert(rtu.end(), request.begin(), request.end());
    const std::uint16_t check = protocols::modbus::crc16(rtu);
    rtu.push_back(static_cast<std::uint8_t>(check));
    rtu.push_back(static_cast<std::uint8_t>(check >> 8U));
    clients.say("rtu", at, SerialPiece{}, rtu);
  };
  clients.say("rtu", kStart + 500ms, drivers::LineClient{true, 19200});
  clients.say("valves", kStart + 500ms, drivers::CanClient{.open = true});
  const SimTime reset = fault + 2 * length + 1s;
  int tick = 0;
  for (SimTime at = kStart + 500ms; at < to; at += 100ms, ++tick) {
    if (tick % 10 == 0) {  // whoever was thrown out comes again
      clients.say("tcp", at, StreamPiece{{}, ++connection, StreamPiece::What::opened, {}}, {});
    }
    const bool out = at >= fault + 400ms && at < fault + length;
    const bool back = at >= fault + length + 200ms && at < fault + 2 * length;
    const bool resets = at >= reset && at < reset + 1s && tick % 2 == 0;
    WireClients::Bytes write{16, 0, 0, 0, 5, 10};
    put(write, resets ? 2 : 1);
    for (int section = 0; section < 4; ++section) {
      put(write, out ? 300 : back ? -300 : 0);
    }
    ask(at, write);
    if (tick % 2 == 1) {
      ask(at + 50ms, {4, 0, 0, 0, static_cast<std::uint8_t>(kReadRegisters)});
    } else if (tick % 4 == 2) {
      ask(at + 50ms, {3, 0, 0, 0, 5});  // what has been written
    }
    for (unsigned valve = 1; valve <= 4; ++valve) {
      protocols::iso11783::AuxiliaryValveCommand command;
      using State = protocols::iso11783::ValveState;
      command.flow_share = out ? 0.3 : 0.0;
      command.resolution = 0;
      command.state = static_cast<std::uint8_t>(out ? State::extend : State::neutral);
      command.fail_safe = 0;
      clients.say("valves", at, protocols::iso11783::encode(valve, command, 0x26));
    }
  }
}

}  // namespace rigwire::hil::test
