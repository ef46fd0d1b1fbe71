// The Modbus TCP side of a device: framing per connection, dispatch to units, answers in order.
//
// What it does with what arrives (Implementation Guide V1.0b, sections 3.1.3 and 4.4; V1.1b3):
//   - Requests may be split anywhere and may follow each other in one segment; each connection has
//     a buffer of one data unit. There is no time-out inside a data unit.
//   - Protocol identifier other than 0: that data unit is dropped, the next one is served.
//   - Length field outside 2 .. 254: nothing behind it can be trusted; the connection is closed
//     after the answers that are still due, and what it sends until then is ignored.
//   - Unit identifier: the configured units, and 0 and 255 for the device itself (the first unit),
//     because masters on TCP use all three. Any other unit is answered with exception 0B (gateway
//     target failed): this device stands alone, nothing is behind it, and a master learns so at
//     once instead of by its time-out.
//   - Every PDU that is not understood or not allowed is answered with its exception, without
//     delay beyond the ordinary one.
// A request acts at the instant of its arrival; the answer is due `processing_delay` later. As the
// delay is the same for all, answers leave in the order of the requests, on every connection. A
// connection that has `transactions_max` answers outstanding gets exception 06 (busy) for more.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "emulators/device.h"
#include "emulators/modbus/modbus_unit.h"
#include "protocols/modbus/constants.h"
#include "protocols/modbus/mbap.h"
#include "protocols/modbus/pdu.h"
#include "sim/samples/time.h"

namespace rigwire::emulators {

struct ModbusServerSettings {
  Duration processing_delay = std::chrono::microseconds(300);  ///< Request to answer, 0 .. 1 s.
  std::size_t transactions_max = 16;  ///< Unanswered requests per connection, 1 .. 16.
};
/// Throws std::invalid_argument.
void validate(const ModbusServerSettings& settings);

class ModbusServer {
 public:
  /// `output` must outlive the server. Throws std::invalid_argument.
  ModbusServer(const ModbusServerSettings& settings, StreamOutput& output);

  /// The first unit added is also the device itself (units 0 and 255). `unit` must outlive the
  /// server. Throws std::invalid_argument when the number is not 1 .. 247 or is taken.
  void add_unit(std::uint8_t number, ModbusUnit& unit);

  void connected(SimTime now, ConnectionId connection);
  void receive(SimTime now, ConnectionId connection, std::span<const std::uint8_t> bytes);
  void disconnected(SimTime now, ConnectionId connection);

  /// accepted: answered without an exception. ignored: other protocol, other unit, and requests
  /// refused with an exception. malformed: bad length field, PDU of a wrong length, bytes on a
  /// connection that is being closed.
  [[nodiscard]] const ReceiveCounters& received() const { return counters_; }

 private:
  static constexpr std::size_t kTransactionsLimit = 16;

  struct Connection {
    ConnectionId id = 0;
    bool closing = false;
    std::array<std::uint8_t, protocols::modbus::kTcpAduMaximum> buffer{};
    std::size_t used = 0;
    std::array<SimTime, kTransactionsLimit> answers_due{};  ///< Ring of the latest.
    std::size_t next_answer = 0;
  };
  struct Unit {
    std::uint8_t number = 0;
    ModbusUnit* unit = nullptr;
  };

  Connection* find(ConnectionId connection);
  ModbusUnit* find_unit(std::uint8_t number);
  void consume_frames(SimTime now, Connection& connection);
  void handle(SimTime now, Connection& connection, const protocols::modbus::Adu& adu);
  protocols::modbus::Response serve(SimTime now, ModbusUnit& unit,
                                    std::span<const std::uint8_t> pdu);
  protocols::modbus::Response answer(SimTime now, Connection& connection,
                                     const protocols::modbus::Adu& adu);

  ModbusServerSettings settings_;
  StreamOutput& output_;
  std::vector<Unit> units_;
  std::vector<Connection> connections_;
  ReceiveCounters counters_;
};

}  // namespace rigwire::emulators
