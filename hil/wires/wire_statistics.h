// What is known of one device's traffic: the source of the status table and of the report.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "hil/wires/latency_histogram.h"
#include "hil/wires/stream_hash.h"
#include "sim/samples/time.h"

namespace rigwire::hil {

/// What a client asked last, in the words of its wire.
struct ClientRequest {
  SimTime at{};
  std::string text;  ///< May hold what a client sent: not yet printable.

  friend bool operator==(const ClientRequest&, const ClientRequest&) = default;
};

struct WireStatistics {
  /// Units of output handed to the wire: datagrams, CAN frames, answers, UART chunks.
  std::uint64_t units = 0;
  std::uint64_t bytes = 0;    ///< In those units.
  std::uint64_t dropped = 0;  ///< Units that the queue or the endpoint refused, whole or in part.
  LatencyHistogram
      lateness;     ///< Wall time of the write after the due time; empty when free-running.
  StreamHash hash;  ///< Of every unit with its due time, dropped ones included.
  std::optional<SimTime> last_client_activity;  ///< When a client last sent something.
};

}  // namespace rigwire::hil
