#include "emulators/modbus/modbus_server.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "emulators/modbus/modbus_dispatch.h"

namespace rigwire::emulators {

using namespace protocols::modbus;

void validate(const ModbusServerSettings& settings) {
  if (settings.processing_delay < Duration{0} ||
      settings.processing_delay > std::chrono::seconds(1)) {
    throw std::invalid_argument("modbus processing_delay: found " +
                                std::to_string(to_seconds(settings.processing_delay)) +
                                " s, allowed 0 .. 1 s");
  }
  if (settings.transactions_max < 1 || settings.transactions_max > 16) {
    throw std::invalid_argument("modbus transactions_max: found " +
                                std::to_string(settings.transactions_max) + ", allowed 1 .. 16");
  }
}

ModbusServer::ModbusServer(const ModbusServerSettings& settings, StreamOutput& output)
    : settings_(settings), output_(output) {
  validate(settings);
}

void ModbusServer::add_unit(std::uint8_t number, ModbusUnit& unit) {
  if (number < 1 || number > 247) {
    throw std::invalid_argument("modbus unit: found " + std::to_string(number) +
                                ", allowed 1 .. 247");
  }
  if (std::ranges::find(units_, number, &Unit::number) != units_.end()) {
    throw std::invalid_argument("modbus unit " + std::to_string(number) + " is there twice");
  }
  units_.push_back({number, &unit});
}

void ModbusServer::connected(SimTime /*now*/, ConnectionId connection) {
  if (find(connection) == nullptr) {
    Connection fresh;
    fresh.id = connection;
    fresh.answers_due.fill(SimTime::min());
    connections_.push_back(fresh);
  }
}

void ModbusServer::disconnected(SimTime /*now*/, ConnectionId connection) {
  std::erase_if(connections_, [&](const Connection& c) { return c.id == connection; });
}

void ModbusServer::receive(SimTime now, ConnectionId id, std::span<const std::uint8_t> bytes) {
  counters_.bytes += bytes.size();
  Connection* connection = find(id);
  while (connection != nullptr && !connection->closing && !bytes.empty()) {
    const std::size_t taken = std::min(bytes.size(), connection->buffer.size() - connection->used);
    std::ranges::copy(bytes.first(taken),
                      std::span(connection->buffer).subspan(connection->used).begin());
    connection->used += taken;
    bytes = bytes.subspan(taken);
    consume_frames(now, *connection);
  }
}

void ModbusServer::consume_frames(SimTime now, Connection& connection) {
  std::size_t start = 0;
  while (!connection.closing) {
    const auto offered = std::span(connection.buffer).first(connection.used).subspan(start);
    const auto adu = decode_adu(offered);
    if (adu.incomplete()) {
      break;
    }
    if (adu.malformed()) {
      ++counters_.malformed;
      connection.closing = true;
      output_.close(connection.id, now + settings_.processing_delay);
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

void ModbusServer::handle(SimTime now, Connection& connection, const Adu& adu) {
  if (adu.header.protocol != kModbusProtocol) {
    ++counters_.ignored;
    return;
  }
  const Pdu pdu = encode_response(answer(now, connection, adu));
  const SimTime due = now + settings_.processing_delay;
  connection.answers_due[connection.next_answer] = due;
  connection.next_answer = (connection.next_answer + 1) % settings_.transactions_max;
  output_.send(connection.id, due, encode_adu(adu.header, pdu.view()).view());
}

Response ModbusServer::answer(SimTime now, Connection& connection, const Adu& adu) {
  const auto function = static_cast<std::uint8_t>(adu.pdu[0] & ~kExceptionFlag);
  // The slot about to be used holds the oldest of the latest transactions_max answers.
  if (connection.answers_due[connection.next_answer] > now) {
    ++counters_.ignored;
    return ExceptionResponse{function, ExceptionCode::server_device_busy};
  }
  ModbusUnit* unit = find_unit(adu.header.unit);
  if (unit == nullptr) {
    ++counters_.ignored;
    return ExceptionResponse{function, ExceptionCode::gateway_target_failed};
  }
  return serve(now, *unit, adu.pdu);
}

Response ModbusServer::serve(SimTime now, ModbusUnit& unit, std::span<const std::uint8_t> pdu) {
  unit.advance(now);
  unit.received().bytes += pdu.size();
  const auto decoded = decode_request(pdu);
  if (const auto* refusal = std::get_if<Refusal>(&decoded)) {
    for (ReceiveCounters* counters : {&counters_, &unit.received()}) {
      ++(refusal->wrong_length ? counters->malformed : counters->ignored);
    }
    return ExceptionResponse{refusal->function, refusal->code};
  }
  const Response response = dispatch(now, unit, std::get<Request>(decoded));
  if (std::holds_alternative<ExceptionResponse>(response)) {
    ++counters_.ignored;
    ++unit.received().ignored;
  } else {
    ++counters_.accepted;
    ++unit.received().accepted;
    unit.served(now);
  }
  return response;
}

ModbusServer::Connection* ModbusServer::find(ConnectionId connection) {
  const auto found = std::ranges::find(connections_, connection, &Connection::id);
  return found == connections_.end() ? nullptr : &*found;
}

ModbusUnit* ModbusServer::find_unit(std::uint8_t number) {
  constexpr std::uint8_t kDeviceItself = 255;
  if (!units_.empty() && (number == 0 || number == kDeviceItself)) {
    return units_.front().unit;
  }
  const auto found = std::ranges::find(units_, number, &Unit::number);
  return found == units_.end() ? nullptr : found->unit;
}

}  // namespace rigwire::emulators
