#include "emulators/modbus/modbus_server.h"

#include <algorithm>
#include <cassert>
#include <tuple>

#include "fields/check.h"
#include "fields/visitor.h"

namespace rigwire::emulators {

using namespace protocols::modbus;

AnswerQueue::AnswerQueue(std::size_t capacity) : capacity_(capacity) {
  items_.reserve(capacity);
  heap_.reserve(capacity);
  free_.reserve(capacity);
}

bool AnswerQueue::later(std::uint32_t a, std::uint32_t b) const {
  const Item& first = items_[a];
  const Item& second = items_[b];
  return std::tie(first.due, first.order) > std::tie(second.due, second.order);
}

bool AnswerQueue::push(SimTime due, ConnectionId connection, std::span<const std::uint8_t> bytes,
                       bool close) {
  if (free_.empty()) {
    if (items_.size() >= capacity_ && !close) {
      return false;
    }
    free_.push_back(static_cast<std::uint32_t>(items_.size()));
    items_.emplace_back();
  }
  const std::uint32_t index = free_.back();
  free_.pop_back();
  Item& item = items_[index];
  assert(bytes.size() <= item.bytes.size());
  item.due = due;
  item.order = next_order_++;
  item.connection = connection;
  item.close = close;
  item.size = bytes.size();
  std::ranges::copy(bytes, item.bytes.begin());
  heap_.push_back(index);
  std::ranges::push_heap(heap_, [this](auto a, auto b) { return later(a, b); });
  return true;
}

SimTime AnswerQueue::next_due() const {
  return heap_.empty() ? kNever : front().due;
}

void AnswerQueue::pop() {
  std::ranges::pop_heap(heap_, [this](auto a, auto b) { return later(a, b); });
  free_.push_back(heap_.back());
  heap_.pop_back();
}

void visit(fields::Visitor& v, ModbusServerSettings& p) {
  v.integer("transactions_max", p.transactions_max, fields::IntegerRule{1, 16},
            "Unanswered requests per client; more get exception 06.");
  v.duration("idle_timeout", p.idle_timeout, {0, 86'400'000'000'000},
             "Closes a client that is silent for this long; 0 = never, else at least 1 s.");
  v.check(p.idle_timeout == Duration{0} || p.idle_timeout >= std::chrono::seconds(1),
          "idle_timeout", "too short", fields::print_duration(p.idle_timeout.count()),
          "0 or at least 1 s");
}

void validate(const ModbusServerSettings& settings) {
  fields::check(settings);
  validate(settings.response_delay);
}

ModbusServer::ModbusServer(const ModbusServerSettings& settings, StreamOutput& output)
    : settings_(settings),
      output_(output),
      service_(kWire, settings.faults, settings.seed),
      delay_(settings.response_delay, ~settings.seed) {
  validate(settings);
}

void ModbusServer::connected(SimTime now, ConnectionId connection) {
  if (find(connection) == nullptr) {
    Connection& fresh = connections_.emplace_back();
    fresh.id = connection;
    fresh.heard = now;
    fresh.last_due = now;
    fresh.answers_due.fill(SimTime::min());
  }
}

void ModbusServer::disconnected(SimTime /*now*/, ConnectionId connection) {
  std::erase_if(connections_, [&](const Connection& c) { return c.id == connection; });
}

void ModbusServer::receive(SimTime now, ConnectionId id, std::span<const std::uint8_t> bytes) {
  service_.received().bytes += bytes.size();
  nothing_before_ = now + delay_.minimum();
  Connection* connection = find(id);
  if (connection != nullptr) {
    connection->heard = now;
  }
  while (connection != nullptr && !connection->closing && !bytes.empty()) {
    const std::size_t taken = std::min(bytes.size(), connection->buffer.size() - connection->used);
    std::ranges::copy(bytes.first(taken),
                      std::span(connection->buffer).subspan(connection->used).begin());
    connection->used += taken;
    bytes = bytes.subspan(taken);
    consume_frames(now, *connection);
  }
  release(now);
}

void ModbusServer::consume_frames(SimTime now, Connection& connection) {
  std::size_t start = 0;
  while (!connection.closing && start < connection.used) {
    const auto offered = std::span(connection.buffer).first(connection.used).subspan(start);
    const auto adu = decode_adu(offered);
    if (adu.incomplete()) {
      break;
    }
    if (adu.malformed()) {
      ++service_.received().malformed;
      close(now, connection);
      break;
    }
    handle(now, connection, *adu);
    start += adu.consumed();
  }
  std::copy(connection.buffer.begin() + static_cast<std::ptrdiff_t>(start),
            connection.buffer.begin() + static_cast<std::ptrdiff_t>(connection.used),
            connection.buffer.begin());
  connection.used -= start;
}

void ModbusServer::close(SimTime now, Connection& connection) {
  close_at(now + delay_.draw(), connection);
}

void ModbusServer::close_at(SimTime due, Connection& connection) {
  connection.closing = true;
  connection.last_due = std::max(connection.last_due, due);
  give(connection.last_due, connection.id, {}, true);
}

void ModbusServer::half_closed(SimTime now, ConnectionId id) {
  nothing_before_ = now + delay_.minimum();
  Connection* connection = find(id);
  if (connection != nullptr && !connection->closing) {
    close_at(nothing_before_, *connection);
  }
  release(now);
}

void ModbusServer::handle(SimTime now, Connection& connection, const Adu& adu) {
  if (adu.header.protocol != kModbusProtocol) {
    ++service_.received().ignored;
    return;
  }
  if (!serve(now, connection, adu)) {
    ++service_.received().ignored;
  }
  if (answer_.effects.disconnect) {
    close(now, connection);
    return;
  }
  if (answer_.silent) {
    return;
  }
  const SimTime due = std::max(connection.last_due, now + delay_.draw() + answer_.effects.delay);
  answer(connection, due, adu.header);
}

bool ModbusServer::serve(SimTime now, const Connection& connection, const Adu& adu) {
  constexpr std::uint8_t kDeviceItself = 255;
  const auto refuse = [&](ExceptionCode code) {
    const auto function = static_cast<std::uint8_t>(adu.pdu[0] & ~kExceptionFlag);
    answer_.silent = false;
    answer_.effects = {};
    answer_.pdu = encode_response(ExceptionResponse{function, code});
    return false;
  };
  // The slot about to be used holds the oldest of the latest transactions_max answers.
  if (connection.answers_due[connection.next_answer] > now) {
    return refuse(ExceptionCode::server_device_busy);
  }
  const bool device_itself = adu.header.unit == 0 || adu.header.unit == kDeviceItself;
  const std::uint8_t unit = device_itself ? service_.first() : adu.header.unit;
  if (!service_.has(unit)) {
    return refuse(ExceptionCode::gateway_target_failed);
  }
  service_.serve(now, unit, adu.pdu, answer_);
  return true;
}

void ModbusServer::answer(Connection& connection, SimTime due, MbapHeader header) {
  const ModbusFaultEffects& effects = answer_.effects;
  connection.last_due = due;
  if (effects.wrong_transaction) {
    ++header.transaction;
  }
  if (effects.junk_bytes > 0) {
    std::array<std::uint8_t, ModbusFaultSchedule::kJunkMaximum> junk{};
    const auto bytes = std::span(junk).first(effects.junk_bytes);
    service_.faults().fill_junk(bytes);
    give(due, connection.id, bytes, false);
  }
  const AduBytes adu = encode_adu(header, answer_.pdu.view());
  give_pieces(connection, adu.view().first(adu.size - std::min(adu.size, effects.missing_bytes)),
              effects);
  connection.answers_due[connection.next_answer] = connection.last_due;
  connection.next_answer = (connection.next_answer + 1) % settings_.transactions_max;
}

void ModbusServer::give_pieces(Connection& connection, std::span<const std::uint8_t> bytes,
                               const ModbusFaultEffects& effects) {
  const std::size_t pieces = std::min(effects.pieces, bytes.size());
  for (std::size_t piece = 0; piece < pieces; ++piece) {
    const std::size_t begin = bytes.size() * piece / pieces;
    const std::size_t end = bytes.size() * (piece + 1) / pieces;
    if (piece > 0) {
      connection.last_due += effects.pause;
    }
    give(connection.last_due, connection.id, bytes.subspan(begin, end - begin), false);
  }
}

void ModbusServer::give(SimTime due, ConnectionId connection, std::span<const std::uint8_t> bytes,
                        bool close) {
  if (waiting_.empty() && due <= nothing_before_) {
    if (close) {
      flush();
      output_.close(connection, due);
    } else {
      append(due, connection, bytes);
    }
  } else if (!bytes.empty() || close) {
    (void)waiting_.push(due, connection, bytes, close);  // an answer lost, as by a full device
  }
}

void ModbusServer::append(SimTime due, ConnectionId connection,
                          std::span<const std::uint8_t> bytes) {
  if (batch_.size > 0 && (batch_.connection != connection || batch_.due != due ||
                          batch_.size + bytes.size() > batch_.bytes.size())) {
    flush();
  }
  batch_.connection = connection;
  batch_.due = due;
  std::ranges::copy(bytes, std::span(batch_.bytes).subspan(batch_.size).begin());
  batch_.size += bytes.size();
}

void ModbusServer::flush() {
  if (batch_.size > 0) {
    output_.send(batch_.connection, batch_.due, std::span(batch_.bytes).first(batch_.size));
    batch_.size = 0;
  }
}

void ModbusServer::release(SimTime now) {
  nothing_before_ = now + delay_.minimum();
  while (waiting_.next_due() <= nothing_before_) {
    const AnswerQueue::Item& item = waiting_.front();
    if (item.close) {
      flush();
      output_.close(item.connection, item.due);
    } else {
      append(item.due, item.connection, item.view());
    }
    waiting_.pop();
  }
  flush();
}

void ModbusServer::advance(SimTime now) {
  if (settings_.idle_timeout > Duration{0}) {
    for (Connection& connection : connections_) {
      if (!connection.closing && connection.heard + settings_.idle_timeout <= now) {
        close(now, connection);
      }
    }
  }
  release(now);
}

SimTime ModbusServer::next_event() const {
  SimTime next = waiting_.empty() ? kNever : waiting_.next_due() - delay_.minimum();
  if (settings_.idle_timeout > Duration{0}) {
    for (const Connection& connection : connections_) {
      if (!connection.closing) {
        next = std::min(next, connection.heard + settings_.idle_timeout);
      }
    }
  }
  return next;
}

ModbusServer::Connection* ModbusServer::find(ConnectionId connection) {
  const auto found = std::ranges::find(connections_, connection, &Connection::id);
  return found == connections_.end() ? nullptr : &*found;
}

}  // namespace rigwire::emulators
