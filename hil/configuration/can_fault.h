// Faults of a CAN bus: a list in the bus's section, each fault with its own keys.
//
//   faults:
//     - {type: bit_errors, at: 10 s, for: 5 s, probability: 0.001}
//     - {type: wrong_rate, at: 20 s, for: 5 s, device: imu_boom, bitrate: 500000}
//     - {type: duplicate_address, at: 30 s, for: 5 s, address: 0x81}
//
// They change levels, rates and who is connected; error frames, counters and bus-off follow from
// the nodes' own error handling (emulators/can/can_bus_faults.h).
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "emulators/can/can_bus_faults.h"
#include "fields/visitor.h"
#include "protocols/can/wire_frame.h"

namespace rigwire::hil {

struct BitErrorsFault {
  static constexpr fields::Named kNamed{"bit_errors", "Bits are turned over for all nodes."};

  double probability = 1e-3;
};
struct DisturbanceFault {
  static constexpr fields::Named kNamed{"disturbance", "One bit of every frame is turned over."};

  int bit = -1;
};
struct ShortCircuitFault {
  static constexpr fields::Named kNamed{
      "short_circuit", "CAN_H on CAN_L: whatever is sent, every node reads recessive."};
};
struct WrongRateFault {
  static constexpr fields::Named kNamed{"wrong_rate", "One node works at another bit rate."};

  std::string device;
  std::uint32_t bit_rate_bps = 500'000;
};
struct DisconnectedFault {
  static constexpr fields::Named kNamed{"disconnected", "One node is alone on its stub."};

  std::string device;
};
struct IntruderFault {
  static constexpr fields::Named kNamed{"intruder", "Somebody sends a frame again and again."};

  std::string frame = "000#";
  Duration period = std::chrono::milliseconds{10};
};
struct DuplicateAddressFault {
  static constexpr fields::Named kNamed{"duplicate_address",
                                        "Somebody claims a J1939 address that is taken."};

  unsigned address = 0x80;
  std::uint64_t name = 1;
  Duration period = std::chrono::milliseconds{250};
};

using CanFaultSettings =
    std::variant<BitErrorsFault, DisturbanceFault, ShortCircuitFault, WrongRateFault,
                 DisconnectedFault, IntruderFault, DuplicateAddressFault>;

struct CanFaultConfiguration {
  Duration at{0};  ///< From the start of the run.
  Duration length = std::chrono::seconds{10};
  CanFaultSettings settings;

  [[nodiscard]] std::string_view type() const { return fields::chosen_name(settings); }
};

/// The device that the fault is about, as it is written; empty for those of the whole bus.
[[nodiscard]] std::string device_of(const CanFaultConfiguration& fault);

/// As the bus model takes them.
[[nodiscard]] emulators::CanBusFaults can_bus_faults(
    const std::vector<CanFaultConfiguration>& faults, std::uint64_t seed);

/// The name by which a fault means the client's own controller.
inline constexpr std::string_view kClientNode = "client";

inline void visit(fields::Visitor& v, BitErrorsFault& p) {
  v.number("probability", p.probability, fields::in("1").above(0).at_most(0.1),
           "Probability with which each bit is turned over.");
}
inline void visit(fields::Visitor& v, DisturbanceFault& p) {
  constexpr unsigned kBits = protocols::can::kMostStuffedBits + protocols::can::kTrailerBits;
  v.integer("bit", p.bit, fields::IntegerRule{-1, kBits - 1},
            "Number of the bit, start of frame = 0, stuff bits counted; -1 = another one in every "
            "frame.");
}
inline void visit(fields::Visitor&, ShortCircuitFault&) {}
inline void visit(fields::Visitor& v, WrongRateFault& p) {
  v.required("device");
  v.text("device", p.device, "Device whose node it is; client = the client's controller.");
  v.required("bitrate");
  v.integer("bitrate", p.bit_rate_bps,
            fields::IntegerRule{10'000, 1'000'000, fields::unit("bit/s")},
            "Bit rate at which the node works.");
}
inline void visit(fields::Visitor& v, DisconnectedFault& p) {
  v.required("device");
  v.text("device", p.device, "Device whose node it is; client = the client's controller.");
}
inline void visit(fields::Visitor& v, IntruderFault& p) {
  v.required("frame");
  v.text("frame", p.frame, "The frame as candump writes it: 18EAFFFE#00EE00.");
  v.duration("period", p.period, {10'000, 3'600'000'000'000}, "Time from frame to frame.");
}
inline void visit(fields::Visitor& v, DuplicateAddressFault& p) {
  v.required("address");
  v.integer("address", p.address, fields::IntegerRule{0, 253},
            "J1939 source address that is claimed.");
  v.integer("name", p.name, fields::IntegerRule{0},
            "NAME of the other node; the lower NAME wins the address.");
  v.duration("period", p.period, {10'000, 3'600'000'000'000}, "Time from claim to claim.");
}

inline void visit(fields::Visitor& v, CanFaultConfiguration& p) {
  v.required("at");
  v.duration("at", p.at, {0, fields::kYear_ns}, "When it begins, from the start of the run.");
  v.duration("for", p.length, {1'000'000, fields::kYear_ns}, "How long the fault lasts.");
  v.required("type");
  v.variant("type", p.settings, "Which fault it is.");
}

}  // namespace rigwire::hil
