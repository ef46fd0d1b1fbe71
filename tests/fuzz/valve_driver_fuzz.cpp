// The valve driver fed with any bytes in any pieces, with time going on in between: it answers
// whole data units, its outputs stay within travel, and without an enable nothing moves.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <variant>

#include "emulators/modbus/modbus_server.h"
#include "emulators/valve_driver/valve_driver.h"
#include "protocols/modbus/mbap.h"

namespace {

using namespace rigwire;

void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

struct CheckedOutput final : emulators::StreamOutput {
  void send(emulators::ConnectionId /*connection*/, SimTime due,
            std::span<const std::uint8_t> bytes) override {
    require(due >= latest);
    latest = due;
    while (!bytes.empty()) {
      const auto adu = protocols::modbus::decode_adu(bytes);
      require(adu.ok());
      const auto response = protocols::modbus::decode_response(adu->pdu);
      require(response.ok() && response.consumed() == adu->pdu.size());
      bytes = bytes.subspan(adu.consumed());
    }
  }
  void close(emulators::ConnectionId /*connection*/, SimTime due) override {
    require(due >= latest);
    closed = true;
  }
  SimTime latest = kStart;
  bool closed = false;
};

}  // namespace

/// Each chunk is (length, wait in ms, bytes).
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const emulators::ValveDriverSettings settings;
  CheckedOutput output;
  emulators::ValveDriver driver(settings);
  emulators::ModbusServer server({}, output);
  server.add_unit(1, driver.unit());
  emulators::ConnectionId connection = 1;
  SimTime now = kStart;
  server.connected(now, connection);
  std::span rest(data, size);
  while (rest.size() > 2) {
    const std::size_t length = std::min<std::size_t>(rest[0], rest.size() - 2);
    now += std::chrono::milliseconds(rest[1]);
    server.receive(now, connection, rest.subspan(2, length));
    driver.advance(now);
    rest = rest.subspan(2 + length);
    require(driver.next_event() > now);
    for (const double opening : driver.command().opening) {
      require(std::abs(opening) <= 1.0);
      require(opening == 0.0 || driver.received().accepted > 0);
    }
    require(driver.command().time <= now);
    if (output.closed) {
      output.closed = false;
      server.disconnected(now, connection++);
      server.connected(now, connection);
    }
  }
  return 0;
}
