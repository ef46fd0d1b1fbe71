// A client's end of a byte stream to the device under test, with deadlines: TCP or a serial line.
// One thread, blocking; the time is the wall's, since devices answer in it.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "conform/endpoint.h"

namespace rigwire::conform {

class ByteLine {
 public:
  using Clock = std::chrono::steady_clock;

  virtual ~ByteLine() = default;
  ByteLine(const ByteLine&) = delete;
  ByteLine& operator=(const ByteLine&) = delete;

  /// False when the other side has closed, or takes nothing for a second.
  [[nodiscard]] virtual bool send(std::span<const std::uint8_t> bytes) = 0;
  /// Appends what has come by `deadline`, at least one byte, to `bytes`. False when nothing has
  /// come.
  [[nodiscard]] virtual bool receive(std::vector<std::uint8_t>& bytes,
                                     Clock::time_point deadline) = 0;
  /// The other side has closed, as far as receive() has seen.
  [[nodiscard]] virtual bool closed() const = 0;
  /// Clock of the deadlines: the wall clock, or, in a test, an emulated device's own.
  [[nodiscard]] virtual Clock::time_point now() const { return Clock::now(); }

 protected:
  ByteLine() = default;
};

/// A connection to a server, or a serial line. Throws Unreachable; std::logic_error for an endpoint
/// that is neither.
[[nodiscard]] std::unique_ptr<ByteLine> open_bytes(const Endpoint& endpoint);

}  // namespace rigwire::conform
