// What is known of one device's traffic: the source of the status table and of the report.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "hil/wires/latency_histogram.h"
#include "sim/samples/time.h"

namespace rigwire::hil {

/// The fingerprint of everything a device has emitted: due time, length and bytes of each unit of
/// output. FNV-1a, 64 bit. Two runs with the same configuration and seed must agree in it; it is no
/// protection against a forger.
class StreamHash {
 public:
  void add(SimTime due, std::span<const std::uint8_t> bytes) {
    add_word(static_cast<std::uint64_t>(due.time_since_epoch().count()));
    add_word(bytes.size());
    for (const std::uint8_t byte : bytes) {
      add_byte(byte);
    }
  }
  [[nodiscard]] std::uint64_t value() const { return hash_; }

 private:
  void add_byte(std::uint8_t byte) { hash_ = (hash_ ^ byte) * 0x100000001B3ULL; }
  void add_word(std::uint64_t word) {
    for (unsigned i = 0; i < 8; ++i) {
      add_byte(static_cast<std::uint8_t>(word >> (8U * i)));
    }
  }
  std::uint64_t hash_ = 0xCBF29CE484222325ULL;
};

/// What a client asked last, in the words of its wire.
struct ClientRequest {
  SimTime at{};
  std::string text;  ///< May hold what a client sent: not yet printable.

  friend bool operator==(const ClientRequest&, const ClientRequest&) = default;
};

/// Something that a device counts for itself: "skipped_pictures".
struct NamedCount {
  std::string_view name;
  std::uint64_t count = 0;
};

struct WireStatistics {
  /// Units of output handed to the wire: datagrams, CAN frames, answers, UART chunks.
  std::uint64_t units = 0;
  std::uint64_t bytes = 0;    ///< In those units.
  std::uint64_t dropped = 0;  ///< Units that the queue or the endpoint refused, whole or in part.
  LatencyHistogram
      lateness;     ///< Wall time of the write after the due time; empty when free-running.
  StreamHash hash;  ///< Hash of every unit with its due time, dropped ones included.
  std::optional<SimTime> last_client_activity;  ///< When a client last sent something.
};

}  // namespace rigwire::hil
