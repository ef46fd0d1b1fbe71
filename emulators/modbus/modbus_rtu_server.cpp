#include "emulators/modbus/modbus_rtu_server.h"

#include <algorithm>
#include <array>

#include "fields/check.h"

namespace rigwire::emulators {

using namespace protocols::modbus;

void validate(const ModbusRtuSettings& settings) {
  fields::check(settings.line);
  validate(settings.response_delay);
}

ModbusRtuServer::ModbusRtuServer(const ModbusRtuSettings& settings, ByteOutput& output)
    : settings_(settings),
      output_(output),
      service_(kWire, settings.faults, settings.seed),
      delay_(settings.response_delay, ~settings.seed),
      framer_(settings.line, *this) {
  validate(settings);
}

void ModbusRtuServer::set_client(SimTime now, const SerialClient& client) {
  advance(now);
  client_baud_ = client.baud;
}

void ModbusRtuServer::receive(SimTime now, std::span<const std::uint8_t> bytes) {
  advance(now);
  service_.received().bytes += bytes.size();
  const bool in_error =
      (client_baud_ != 0 && client_baud_ != baud()) || service_.faults().parity_mismatch(now);
  std::array<std::uint8_t, kRtuFrameMaximum> piece{};
  for (bool first = true; !bytes.empty(); first = false) {
    const std::size_t size = std::min(bytes.size(), piece.size());
    const auto disturbed = std::span(piece).first(size);
    std::ranges::copy(bytes.first(size), disturbed.begin());
    service_.faults().disturb(now, disturbed);
    if (framer_.receive(now, disturbed, in_error, first) < size) {
      ++service_.received().malformed;  // beyond what the client's side holds back
      break;
    }
    bytes = bytes.subspan(size);
  }
}

void ModbusRtuServer::communication_error(SimTime /*now*/) {
  ++service_.received().malformed;
  service_.communication_error();
}

void ModbusRtuServer::frame(SimTime now, const RtuFrame& frame) {
  service_.bus_message();
  if (frame.address == kBroadcastAddress) {
    service_.broadcast(now, frame.pdu);
    return;
  }
  if (!service_.has(frame.address)) {
    ++service_.received().ignored;
    return;
  }
  service_.serve(now, frame.address, frame.pdu, answer_);
  if (answer_.silent) {
    return;
  }
  const SimTime begin = std::max(now, framer_.line_free() + settings_.line.timing.frame_silence());
  transmit(begin + delay_.draw() + answer_.effects.delay, frame.address);
}

void ModbusRtuServer::transmit(SimTime begin, std::uint8_t address) {
  const ModbusFaultEffects& effects = answer_.effects;
  RtuBytes adu = encode_rtu(address, answer_.pdu.view());
  if (effects.wrong_check) {
    for (std::size_t i = adu.size - kRtuCheckSize; i < adu.size; ++i) {
      adu.bytes[i] = static_cast<std::uint8_t>(~adu.bytes[i]);
    }
  }
  SimTime end = begin;
  if (effects.junk_bytes > 0) {
    std::array<std::uint8_t, ModbusFaultSchedule::kJunkMaximum> junk{};
    const auto bytes = std::span(junk).first(effects.junk_bytes);
    service_.faults().fill_junk(bytes);
    end = put(end, bytes);
  }
  const auto bytes =
      std::span(adu.bytes).first(adu.size - std::min(adu.size, effects.missing_bytes));
  const std::size_t pieces = std::min(effects.pieces, bytes.size());
  for (std::size_t piece = 0; piece < pieces; ++piece) {
    const std::size_t first = bytes.size() * piece / pieces;
    const std::size_t last = bytes.size() * (piece + 1) / pieces;
    end = put(piece > 0 ? end + effects.pause : end, bytes.subspan(first, last - first));
  }
  framer_.occupy(end);
  ++answers_sent_;
}

SimTime ModbusRtuServer::put(SimTime begin, std::span<std::uint8_t> bytes) {
  service_.faults().disturb(begin, bytes);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    output_.send(begin + settings_.line.timing.characters(i + 1), bytes.subspan(i, 1));
  }
  return begin + settings_.line.timing.characters(bytes.size());
}

}  // namespace rigwire::emulators
