// Modbus RTU: the units of one serial line, with the line's time.
//
// - A request is carried out when its last silence is over, 3.5 characters after its last byte
//   (rtu_framer.h says how bytes get their times); the answer begins a response delay later, and
//   never before 3.5 characters after whatever was last on the line. Each of its bytes is due when
//   its stop bit ends.
// - Frames for units that are not on this line, frames with a wrong check, and bytes that are no
//   frame are passed over in silence. A broadcast (address 0) that writes is carried out by every
//   unit and not answered. There is no 0 or 255 for "the device itself" on a serial line.
// - The turnaround after a broadcast is the master's affair: a request that comes sooner is served.
// - A client that is set to another speed is not understood; nor is one of another parity, which a
//   pseudo-terminal does not report, so that only a fault can simulate it (modbus_faults.h).
// - Functions 7, 8 and 11 exist here beside those of TCP, with the counters of each unit; a unit in
//   listen-only mode does nothing else until its communication is restarted.
//
// Source: MODBUS over Serial Line V1.02, sections 2.4, 2.5, 2.6, 6.1.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "emulators/device.h"
#include "emulators/modbus/modbus_faults.h"
#include "emulators/modbus/modbus_service.h"
#include "emulators/modbus/response_delay.h"
#include "emulators/modbus/rtu_framer.h"
#include "sim/samples/time.h"

namespace rigwire::emulators {

struct ModbusRtuSettings {
  RtuFramerSettings line{};
  ResponseDelaySettings response_delay{};
  std::vector<ModbusFault> faults{};
  std::uint64_t seed = 1;  ///< Seed of delays and faults.
};
/// Throws std::invalid_argument.
void validate(const ModbusRtuSettings& settings);

class ModbusRtuServer final : public SerialDevice, private RtuListener {
 public:
  static constexpr ModbusWire kWire = ModbusWire::rtu;

  /// `output` must outlive the server. Throws std::invalid_argument.
  ModbusRtuServer(const ModbusRtuSettings& settings, ByteOutput& output);

  /// `unit` must outlive the server. Throws std::invalid_argument when the number is not 1 .. 247
  /// or is taken.
  void add_unit(std::uint8_t number, ModbusUnit& unit) { service_.add_unit(number, unit); }
  /// What goes wrong on the line.
  [[nodiscard]] ModbusFaultSchedule& faults() { return service_.faults(); }

  void set_client(SimTime now, const SerialClient& client) override;
  void receive(SimTime now, std::span<const std::uint8_t> bytes) override;
  void advance(SimTime now) override { framer_.advance(now); }
  [[nodiscard]] SimTime next_event() const override { return framer_.next_event(); }
  [[nodiscard]] SamplePlan sample_plan() const override { return {}; }
  /// accepted: carried out without an exception. ignored: refused with one, other units' frames,
  /// unheard. malformed: bytes that were no frame (one for each run of them), PDU of a wrong
  /// length.
  [[nodiscard]] ReceiveCounters received() const override { return service_.received(); }
  [[nodiscard]] double nominal_rate_hz() const override { return 0.0; }
  [[nodiscard]] std::span<const Quantity> quantities() const override { return {}; }
  [[nodiscard]] std::uint64_t messages_sent() const override { return answers_sent_; }
  [[nodiscard]] std::uint32_t baud() const override { return settings_.line.timing.baud; }

 private:
  void frame(SimTime now, const protocols::modbus::RtuFrame& frame) override;
  void communication_error(SimTime now) override;
  void transmit(SimTime begin, std::uint8_t address);
  /// Without a gap from `begin` on; returns the end of the last byte.
  SimTime put(SimTime begin, std::span<std::uint8_t> bytes);

  ModbusRtuSettings settings_;
  ByteOutput& output_;
  ModbusService service_;
  ResponseDelay delay_;
  RtuFramer framer_;
  ModbusAnswer answer_;
  std::uint32_t client_baud_ = 0;  ///< 0: not known, taken as the server's.
  std::uint64_t answers_sent_ = 0;
};

}  // namespace rigwire::emulators
