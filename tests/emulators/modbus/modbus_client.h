// A client of a ModbusServer or device under test: sends requests, records what comes back and
// when.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "emulators/device.h"
#include "protocols/modbus/mbap.h"
#include "protocols/modbus/pdu.h"

namespace rigwire::emulators {

using Bytes = std::vector<std::uint8_t>;

/// Records everything a device sends.
struct RecordedStream final : StreamOutput {
  struct Sent {
    ConnectionId connection;
    SimTime due;
    Bytes bytes;
  };
  struct Closed {
    ConnectionId connection;
    SimTime due;
  };
  void send(ConnectionId connection, SimTime due, std::span<const std::uint8_t> bytes) override {
    ++pieces;
    for (;;) {
      const auto adu = protocols::modbus::decode_adu(bytes);
      const auto one = adu.ok() ? bytes.first(adu.consumed()) : bytes;
      sent.push_back({connection, due, {one.begin(), one.end()}});
      bytes = bytes.subspan(one.size());
      if (bytes.empty()) {
        return;
      }
    }
  }
  void close(ConnectionId connection, SimTime due) override { closed.push_back({connection, due}); }

  /// The PDU of the latest answer, decoded.
  protocols::modbus::Response latest() const {
    const auto adu = protocols::modbus::decode_adu(sent.back().bytes);
    return *protocols::modbus::decode_response(adu->pdu);
  }

  std::vector<Sent> sent;  ///< Data unit by data unit.
  std::size_t pieces = 0;  ///< Pieces in which the data units were handed over.
  std::vector<Closed> closed;
};

inline Bytes adu_of(const Bytes& pdu, std::uint16_t transaction = 1, std::uint8_t unit = 1,
                    std::uint16_t protocol = 0) {
  const auto adu = protocols::modbus::encode_adu({transaction, protocol, unit}, pdu);
  return {adu.view().begin(), adu.view().end()};
}

inline Bytes adu_of(const protocols::modbus::Request& request, std::uint16_t transaction = 1,
                    std::uint8_t unit = 1) {
  const auto pdu = protocols::modbus::encode_request(request);
  return adu_of(Bytes(pdu.view().begin(), pdu.view().end()), transaction, unit);
}

inline Bytes operator+(Bytes a, const Bytes& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

}  // namespace rigwire::emulators
