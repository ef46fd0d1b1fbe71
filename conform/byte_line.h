// A client's end of a byte stream to the device under test, with deadlines: TCP or a serial line.
// One thread, blocking; the time is the wall's, since devices answer in it.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace rigwire::conform {

/// The way to the device, not the device: nobody listens, no permission, no such path.
class Unreachable : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class ByteLine {
 public:
  using Clock = std::chrono::steady_clock;

  virtual ~ByteLine() = default;
  ByteLine(const ByteLine&) = delete;
  ByteLine& operator=(const ByteLine&) = delete;

  /// False when the other side has closed, or takes nothing for a second.
  [[nodiscard]] virtual bool send(std::span<const std::uint8_t> bytes) = 0;
  /// Appends what has come by then, at least a byte of it, to `bytes`. False when nothing has.
  [[nodiscard]] virtual bool receive(std::vector<std::uint8_t>& bytes,
                                     Clock::time_point deadline) = 0;
  /// The other side has closed, as far as receive() has seen.
  [[nodiscard]] virtual bool closed() const = 0;

 protected:
  ByteLine() = default;
};

/// Where the device is, and how lines to it are opened.
struct ByteEndpoint {
  enum class Kind : std::uint8_t { tcp, serial };
  Kind kind = Kind::tcp;
  std::string address;  ///< Numeric of TCP; path of a serial line.
  std::uint16_t port = 0;
  std::uint32_t baud = 0;

  [[nodiscard]] std::string text() const;
  /// On this machine.
  [[nodiscard]] bool local() const;
  /// Throws Unreachable.
  [[nodiscard]] std::unique_ptr<ByteLine> open() const;
};

/// "tcp:127.0.0.1:1502", "tcp:[::1]:1502", "serial:/dev/ttyUSB0@19200"; without a port or a speed
/// those given. Empty when it is none of these.
[[nodiscard]] std::optional<ByteEndpoint> parse_byte_endpoint(const std::string& text,
                                                              std::uint16_t port,
                                                              std::uint32_t baud);

}  // namespace rigwire::conform
