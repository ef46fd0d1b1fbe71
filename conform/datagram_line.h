// A client's UDP ports on this machine, with deadlines: what a device sends to them by itself, or
// what one that is asked answers. One thread, blocking; IPv4.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace rigwire::conform {

class DatagramLine {
 public:
  using Clock = std::chrono::steady_clock;

  struct Peer {
    std::string address;  ///< Dotted.
    std::uint16_t port = 0;

    friend bool operator==(const Peer&, const Peer&) = default;
  };
  struct Datagram {
    std::size_t at_port = 0;  ///< Index of the own port, from 0.
    Peer from;
    Clock::time_point at;
    std::vector<std::uint8_t> bytes;
  };

  virtual ~DatagramLine() = default;
  DatagramLine(const DatagramLine&) = delete;
  DatagramLine& operator=(const DatagramLine&) = delete;

  /// From one of our ports. False when the system takes nothing.
  [[nodiscard]] virtual bool send(std::size_t from_port, const Peer& to,
                                  std::span<const std::uint8_t> bytes) = 0;
  /// The next one at any of our ports; nothing by the deadline.
  [[nodiscard]] virtual std::optional<Datagram> receive(Clock::time_point deadline) = 0;
  /// The address and number of one of our ports.
  [[nodiscard]] virtual Peer own(std::size_t port) const = 0;
  /// How many have come to our ports and were lost there, because we did not take them in time.
  [[nodiscard]] virtual std::uint64_t lost_here() const { return 0; }
  /// In which deadlines are (ByteLine::now).
  [[nodiscard]] virtual Clock::time_point now() const { return Clock::now(); }

 protected:
  DatagramLine() = default;
};

/// Ports at an address of this machine; empty: at all of them, 0: of the system's choice. Throws
/// Unreachable: no such address, or the port is taken.
[[nodiscard]] std::unique_ptr<DatagramLine> open_datagrams(const std::string& address,
                                                           std::span<const std::uint16_t> ports);

/// Our address on the way to `peer`. Throws Unreachable: no such address, or no way.
[[nodiscard]] std::string own_address_towards(const DatagramLine::Peer& peer);

}  // namespace rigwire::conform
