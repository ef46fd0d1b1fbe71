// Modbus on TCP: framing per connection, requests to units, answers in order.
//
// What it does with what arrives (Implementation Guide V1.0b, sections 3.1.3 and 4.4; V1.1b3):
//   - Requests may be split anywhere and may follow each other in one segment; each connection has
//     a buffer of one data unit. There is no time-out inside a data unit.
//   - Protocol identifier other than 0: that data unit is dropped, the next one is served.
//   - Length field outside 2 .. 254: nothing behind it can be trusted; the connection is closed
//     after the answers that are still due, and what it sends until then is ignored.
//   - Unit identifier: the units of the line, and 0 and 255 for the device itself (the first unit),
//     because masters on TCP use all three. Any other unit is answered with exception 0B (gateway
//     target failed): nothing else is behind this server, and a master learns so at once instead
//     of by its time-out.
//   - Every PDU that is not understood or not allowed is answered with its exception, without
//     delay beyond the ordinary one.
// A request acts at the instant of its arrival; the answer is due a response delay later. The
// answers of one connection leave in the order of its requests, whatever the delays drawn; answers
// of one connection that are due together leave as one piece. A connection that has
// `transactions_max` answers outstanding gets exception 06 (busy) for more. A connection that says
// nothing for `idle_timeout` is closed.
//
// Answers go to the output as soon as none can come before them, so that their due times never
// decrease.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "emulators/device.h"
#include "emulators/modbus/modbus_faults.h"
#include "emulators/modbus/modbus_service.h"
#include "emulators/modbus/modbus_unit.h"
#include "emulators/modbus/response_delay.h"
#include "fields/rules.h"
#include "protocols/modbus/constants.h"
#include "protocols/modbus/mbap.h"
#include "sim/samples/time.h"

namespace rigwire::emulators {

struct ModbusServerSettings {
  ResponseDelaySettings response_delay{};
  std::size_t transactions_max = 16;  ///< Unanswered requests per connection, 1 .. 16.
  Duration idle_timeout{0};           ///< 0 = never, 1 s .. 24 h.
  std::vector<ModbusFault> faults{};
  std::uint64_t seed = 1;  ///< Seed of delays and faults.
};
/// Without the response delay, which both kinds of line have.
void visit(fields::Visitor& v, ModbusServerSettings& p);
/// Throws std::invalid_argument.
void validate(const ModbusServerSettings& settings);

/// Answers of a Modbus TCP server that wait for their instants, over all connections, in order of
/// time. The memory of answers is reserved at construction; an answer that does not fit is refused.
/// The end of a connection, which comes once for each, is never.
class AnswerQueue {
 public:
  struct Item {
    SimTime due{};
    std::uint64_t order = 0;  ///< Number of entry; at equal times the lowest leaves first.
    ConnectionId connection = 0;
    bool close = false;  ///< Ends the connection; has no bytes.
    std::size_t size = 0;
    std::array<std::uint8_t, protocols::modbus::kTcpAduMaximum> bytes{};

    [[nodiscard]] std::span<const std::uint8_t> view() const {
      return std::span(bytes).first(size);
    }
  };

  explicit AnswerQueue(std::size_t capacity);

  /// At most one data unit of bytes. False when the queue is full of answers.
  bool push(SimTime due, ConnectionId connection, std::span<const std::uint8_t> bytes, bool close);
  [[nodiscard]] bool empty() const { return heap_.empty(); }
  /// kNever when empty.
  [[nodiscard]] SimTime next_due() const;
  /// Precondition: not empty. Valid until push() or pop().
  [[nodiscard]] const Item& front() const { return items_[heap_.front()]; }
  void pop();

 private:
  [[nodiscard]] bool later(std::uint32_t a, std::uint32_t b) const;

  std::size_t capacity_;
  std::vector<Item> items_;
  std::vector<std::uint32_t> heap_;  ///< Indices of waiting items, the earliest in front.
  std::vector<std::uint32_t> free_;  ///< Indices of the others.
  std::uint64_t next_order_ = 0;
};

class ModbusServer {
 public:
  static constexpr ModbusWire kWire = ModbusWire::tcp;

  /// `output` must outlive the server. Throws std::invalid_argument.
  ModbusServer(const ModbusServerSettings& settings, StreamOutput& output);

  /// The first unit added is also the device itself (units 0 and 255). `unit` must outlive the
  /// server. Throws std::invalid_argument when the number is not 1 .. 247 or is taken.
  void add_unit(std::uint8_t number, ModbusUnit& unit) { service_.add_unit(number, unit); }
  /// What goes wrong on the line.
  [[nodiscard]] ModbusFaultSchedule& faults() { return service_.faults(); }

  void connected(SimTime now, ConnectionId connection);
  void receive(SimTime now, ConnectionId connection, std::span<const std::uint8_t> bytes);
  void disconnected(SimTime now, ConnectionId connection);
  /// The client sends nothing more: it is given the answers that are still due, then the connection
  /// is closed.
  void half_closed(SimTime now, ConnectionId connection);

  /// Hands over what is due until `now`, and closes idle connections.
  void advance(SimTime now);
  [[nodiscard]] SimTime next_event() const;

  /// accepted: answered without an exception. ignored: other protocol, other unit, unheard, and
  /// refused with an exception. malformed: bad length field, PDU of a wrong length.
  [[nodiscard]] const ReceiveCounters& received() const { return service_.received(); }

 private:
  static constexpr std::size_t kTransactionsLimit = 16;
  static constexpr std::size_t kWaitingLimit = 2048;

  struct Connection {
    ConnectionId id = 0;
    bool closing = false;
    SimTime heard{};
    SimTime last_due{};
    std::size_t used = 0;  ///< Bytes of `buffer`.
    std::size_t next_answer = 0;
    std::array<SimTime, kTransactionsLimit> answers_due{};  ///< Ring of the latest.
    std::array<std::uint8_t, protocols::modbus::kTcpAduMaximum> buffer{};
  };

  Connection* find(ConnectionId connection);
  void consume_frames(SimTime now, Connection& connection);
  void handle(SimTime now, Connection& connection, const protocols::modbus::Adu& adu);
  /// False when the unit is not one of this line, or the connection has too much outstanding.
  bool serve(SimTime now, const Connection& connection, const protocols::modbus::Adu& adu);
  void answer(Connection& connection, SimTime due, protocols::modbus::MbapHeader header);
  void give_pieces(Connection& connection, std::span<const std::uint8_t> bytes,
                   const ModbusFaultEffects& effects);
  void close(SimTime now, Connection& connection);
  void close_at(SimTime due, Connection& connection);

  // The way out: straight into the batch where nothing can come before, else by the queue.
  void give(SimTime due, ConnectionId connection, std::span<const std::uint8_t> bytes, bool close);
  void append(SimTime due, ConnectionId connection, std::span<const std::uint8_t> bytes);
  void release(SimTime now);
  void flush();

  ModbusServerSettings settings_;
  StreamOutput& output_;
  ModbusService service_;
  ResponseDelay delay_;
  std::vector<Connection> connections_;
  AnswerQueue waiting_{kWaitingLimit};
  ModbusAnswer answer_;
  SimTime nothing_before_{};  ///< No answer to come is due earlier.

  /// Answers of one connection with one due time, not yet given to the output.
  struct Batch {
    ConnectionId connection = 0;
    SimTime due{};
    std::size_t size = 0;
    std::array<std::uint8_t, kTransactionsLimit * protocols::modbus::kTcpAduMaximum> bytes{};
  };
  Batch batch_;
};

}  // namespace rigwire::emulators
