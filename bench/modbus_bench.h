// Cost of a Modbus TCP transaction: transactions per second on loopback, latency compared with a
// bare echo server in the same run, and the server alone.
//
// One client sends a request of 12 bytes (function 3, 10 registers of a valve driver), waits for
// the answer of 29 bytes, and sends the next. The bare server is a thread that blocks in recv() and
// answers with 29 bytes. Clients and servers share one processor: on two, the scheduler's placement
// of the threads matters more than their work (waking an idle processor of a virtual machine takes
// 20 us). The two take turns, round by round, so that the host's load affects both.
#pragma once

#include <cstddef>
#include <cstdint>

namespace rigwire::bench {

struct ModbusBenchSettings {
  std::size_t rounds = 10;
  std::size_t transactions = 2000;  ///< Transactions of each server in each round.
  std::size_t pipelined = 16;       ///< Requests in one write, for the rate with batches.
};

struct LatencyFigures {
  double p50_us = 0.0;
  double p99_us = 0.0;
};

struct ModbusBench {
  double per_second = 0.0;            ///< One client, one request at a time.
  double pipelined_per_second = 0.0;  ///< One client, several requests in a write.
  LatencyFigures modbus;
  LatencyFigures echo;
  double ratio_p50 = 0.0;  ///< Modbus to echo.
  double ratio_p99 = 0.0;
  double nanoseconds_alone = 0.0;  ///< CPU time of a request through the server, without sockets.
  std::uint64_t wrong_answers = 0;
};

/// Throws std::runtime_error when loopback does not work.
[[nodiscard]] ModbusBench measure_modbus(const ModbusBenchSettings& settings);

}  // namespace rigwire::bench
