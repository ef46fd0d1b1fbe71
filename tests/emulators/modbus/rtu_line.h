// A master's end of a ModbusRtuServer under test: writes frames, records every byte that comes back
// with its instant.
#pragma once

#include <vector>

#include "emulators/modbus/modbus_rtu_server.h"
#include "modbus_client.h"
#include "protocols/modbus/rtu.h"

namespace rigwire::emulators {

struct RecordedLine final : ByteOutput {
  struct Sent {
    SimTime due;
    std::uint8_t byte;
  };
  void send(SimTime due, std::span<const std::uint8_t> bytes) override {
    for (const std::uint8_t byte : bytes) {
      sent.push_back({due, byte});
    }
  }
  [[nodiscard]] Bytes bytes() const {
    Bytes result;
    for (const Sent& one : sent) {
      result.push_back(one.byte);
    }
    return result;
  }
  std::vector<Sent> sent;
};

inline Bytes frame_of(std::uint8_t address, const Bytes& pdu) {
  const auto frame = protocols::modbus::encode_rtu(address, pdu);
  return {frame.view().begin(), frame.view().end()};
}
inline Bytes frame_of(std::uint8_t address, const protocols::modbus::Request& request) {
  const auto pdu = protocols::modbus::encode_request(request);
  return frame_of(address, Bytes(pdu.view().begin(), pdu.view().end()));
}

}  // namespace rigwire::emulators
