#include "emulators/can/can_bus_faults.h"

#include <stdexcept>

#include "protocols/can/wire_frame.h"

namespace rigwire::emulators {
namespace {

[[noreturn]] void refuse(const char* quantity, const std::string& found, const char* allowed) {
  throw std::invalid_argument(std::string("CAN bus fault: ") + quantity + " is " + found +
                              ", allowed is " + allowed);
}

void require_rate(std::uint32_t bit_rate_bps) {
  if (bit_rate_bps < 10'000 || bit_rate_bps > 1'000'000) {
    refuse("bit_rate_bps", std::to_string(bit_rate_bps), "10000 .. 1000000");
  }
}

void require_frame(const protocols::can::Frame& frame) {
  if (frame.id > (frame.extended ? 0x1FFF'FFFFU : 0x7FFU)) {
    refuse("frame.id", std::to_string(frame.id), frame.extended ? "29 bits" : "11 bits");
  }
  if (frame.length > 8) {
    refuse("frame.length", std::to_string(frame.length), "0 .. 8");
  }
}

void require(const CanBusFault& fault) {
  if (fault.begin < Duration{0} || fault.end <= fault.begin) {
    refuse("end", std::to_string(fault.end.count()) + " ns",
           "later than begin, which is not negative");
  }
  switch (fault.kind) {
    case CanBusFaultKind::bit_errors:
      if (!(fault.probability > 0.0 && fault.probability <= 0.1)) {
        refuse("probability", std::to_string(fault.probability), "above 0 .. 0.1");
      }
      break;
    case CanBusFaultKind::disturbance:
      if (fault.bit &&
          *fault.bit >= protocols::can::kMostStuffedBits + protocols::can::kTrailerBits) {
        refuse("bit", std::to_string(*fault.bit), "0 .. 156");
      }
      break;
    case CanBusFaultKind::short_circuit:
      break;
    case CanBusFaultKind::wrong_rate:
      require_rate(fault.bit_rate_bps);
      break;
    case CanBusFaultKind::disconnected:
      break;
    case CanBusFaultKind::intruder:
      require_frame(fault.frame);
      if (fault.period < std::chrono::microseconds{10} || fault.period > std::chrono::hours{1}) {
        refuse("period", std::to_string(fault.period.count()) + " ns", "10 us .. 1 h");
      }
      break;
  }
}

}  // namespace

void validate(const CanBusFaults& faults) {
  for (const CanBusFault& fault : faults.list) {
    require(fault);
  }
}

}  // namespace rigwire::emulators
