#include "emulators/can/can_bus_faults.h"

#include <stdexcept>

#include "fields/check.h"
#include "protocols/can/frame_text.h"
#include "protocols/can/wire_frame.h"

namespace rigwire::emulators {

namespace can = protocols::can;
using fields::in;
using fields::IntegerRule;

void visit(fields::Visitor& v, BitErrorsFault& p) {
  v.number("bit_error_rate", p.bit_error_rate, in("1").above(0).at_most(0.1),
           "Probability with which each bit is turned over.");
}

void visit(fields::Visitor& v, DisturbanceFault& p) {
  constexpr unsigned kBits = can::kMostStuffedBits + can::kTrailerBits;
  v.integer("bit", p.bit, IntegerRule{-1, kBits - 1},
            "Number of the bit, start of frame = 0, stuff bits counted; -1 = another one in every "
            "frame.");
}

void visit(fields::Visitor& v, WrongRateFault& p) {
  v.required("device");
  v.text("device", p.device, "Device whose node it is; client = the client's controller.");
  v.required("bitrate");
  v.integer("bitrate", p.bit_rate_bps, IntegerRule{10'000, 1'000'000, fields::unit("bit/s")},
            "Bit rate at which the node works.");
}

void visit(fields::Visitor& v, DisconnectedFault& p) {
  v.required("device");
  v.text("device", p.device, "Device whose node it is; client = the client's controller.");
}

void visit(fields::Visitor& v, IntruderFault& p) {
  v.required("frame");
  v.text("frame", p.frame, "The frame as candump writes it: 18EAFFFE#00EE00.");
  v.duration("period", p.period, {10'000, 3'600'000'000'000}, "Time from frame to frame.");
}

void visit(fields::Visitor& v, DuplicateAddressFault& p) {
  v.required("address");
  v.integer("address", p.address, IntegerRule{0, 253}, "J1939 source address that is claimed.");
  v.integer("name", p.name, IntegerRule{0},
            "NAME of the other node; the lower NAME wins the address.");
  v.duration("period", p.period, {10'000, 3'600'000'000'000}, "Time from claim to claim.");
}

void visit(fields::Visitor& v, CanFault& p) {
  visit_fault(v, p);
}

std::string node_of(const CanFault& fault) {
  return std::visit(
      [](const auto& what) -> std::string {
        if constexpr (requires { what.device; }) {
          return what.device;
        } else {
          return {};
        }
      },
      fault.what);
}

bool is_of_wire(const CanFault& fault) {
  return std::holds_alternative<BitErrorsFault>(fault.what) ||
         std::holds_alternative<DisturbanceFault>(fault.what) ||
         std::holds_alternative<ShortCircuitFault>(fault.what);
}

can::Frame frame_of(const IntruderFault& fault) {
  return can::parse_frame_text(fault.frame).value_or(can::Frame{});
}

can::Frame frame_of(const DuplicateAddressFault& fault) {
  constexpr std::uint32_t kAddressClaimed = 0x18EEFF00;
  can::Frame frame{kAddressClaimed | fault.address, true, false, 8, {}};
  std::uint64_t name = fault.name;
  for (std::uint8_t& byte : frame.data) {
    byte = static_cast<std::uint8_t>(name);
    name >>= 8U;
  }
  return frame;
}

void validate(const CanFault& fault) {
  fields::check(fault);
  const auto* const intruder = std::get_if<IntruderFault>(&fault.what);
  fields::require(intruder == nullptr || can::parse_frame_text(intruder->frame).has_value(),
                  "frame", intruder == nullptr ? "" : "\"" + intruder->frame + "\"",
                  "18EAFFFE#00EE00, 123#, 123#R4");
}

void validate(const CanBusFaults& faults) {
  for (const CanFault& fault : faults.list) {
    validate(fault);
  }
}

}  // namespace rigwire::emulators
