// A node's end of a CAN bus, with deadlines: an interface of the kernel, or an adapter that speaks
// slcan on a serial line. One thread, blocking.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <vector>

#include "conform/endpoint.h"
#include "protocols/can/frame.h"

namespace rigwire::conform {

class CanLine {
 public:
  using Clock = std::chrono::steady_clock;

  virtual ~CanLine() = default;
  CanLine(const CanLine&) = delete;
  CanLine& operator=(const CanLine&) = delete;

  /// False when the bus takes nothing: it is down, or full for a second.
  [[nodiscard]] virtual bool send(const protocols::can::Frame& frame) = 0;
  /// The next data or remote frame of others; nothing by the deadline.
  [[nodiscard]] virtual std::optional<protocols::can::Frame> receive(
      Clock::time_point deadline) = 0;
  /// Returns the present time of the clock that deadlines refer to (ByteLine::now).
  [[nodiscard]] virtual Clock::time_point now() const { return Clock::now(); }

 protected:
  CanLine() = default;
};

/// Opens an endpoint on CAN (precondition); slcan without a bit rate is opened with 250 kbit/s.
/// Throws Unreachable.
[[nodiscard]] std::unique_ptr<CanLine> open_can(const Endpoint& endpoint);

/// Returns a frame as stored in a step of a case and in captures: the kernel's struct can_frame.
[[nodiscard]] std::vector<std::uint8_t> step_bytes(const protocols::can::Frame& frame);
/// "620 40 00 10 00", "18EEFF80x ...".
[[nodiscard]] std::string frame_text(const protocols::can::Frame& frame);

}  // namespace rigwire::conform
