// Decodes what passes on a Modbus line, by the names of its registers: each message with its
// fields, and for each register its value as a client last read it, and who last wrote it. What
// passed before the first viewer is unknown.
//
// Requests and answers are matched as clients match them: by transaction on TCP, by turns on a
// serial line. What a request writes counts when it has been answered without an exception;
// broadcasts, which no device answers, are shown and do not count.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "emulators/valve_driver/register_image.h"
#include "emulators/valve_driver/valve_map.h"
#include "hil/stream/wire_reading.h"
#include "protocols/modbus/pdu.h"
#include "sim/samples/time.h"

namespace rigwire::hil {

/// A unit of a line.
struct NamedUnit {
  std::string device;
  std::uint8_t number = 1;
  std::vector<std::string> sections;  ///< Their names, in the order of the map's rows.
  emulators::ValveMap map;
};

class ModbusReader {
 public:
  /// Limits of the connections whose messages are put together, and of requests without answer.
  static constexpr std::size_t kMostConnections = 64;
  static constexpr std::size_t kMostPending = 256;

  enum class Line : std::uint8_t { tcp, rtu };
  ModbusReader(Line line, std::vector<NamedUnit> units);

  using Use = std::function<void(std::span<const std::uint8_t> message, const WireReading&)>;
  /// Takes the next bytes of a connection (a serial line has one), in either direction; calls `use`
  /// for each message that they complete.
  void take(SimTime at, std::uint64_t connection, bool of_client,
            std::span<const std::uint8_t> bytes, const Use& use);

  /// Returns {"registers": [{device, table, address, name, unit, signal, text, section, value,
  /// seen_ns, by, written_ns}]}; keys from `section` on are left out where there is none, or
  /// nothing is known.
  [[nodiscard]] std::string registers() const;

 private:
  struct Unit {
    explicit Unit(NamedUnit named) : about(std::move(named)), image(about.map) {}
    NamedUnit about;
    emulators::RegisterImage image;
    std::map<std::pair<const emulators::ValveRegister*, std::size_t>, std::size_t> rows;
  };
  struct Row {
    const Unit* unit;
    const emulators::ValveRegister* entry;
    std::uint16_t address;
    std::size_t section;  ///< Section of its valve block, if it has one.
    std::string name;
    std::optional<double> value;
    SimTime seen{};
    std::string by;
    SimTime written{};
  };
  /// A connection and a direction.
  using Stream = std::pair<std::uint64_t, bool>;
  /// A connection and a transaction on it.
  using Exchange = std::pair<std::uint64_t, std::uint16_t>;

  void add_rows(Unit& unit);
  [[nodiscard]] Unit* find(std::uint8_t number);
  /// Returns the number of bytes that are done with, as a message or as none; 0: more are needed.
  std::size_t take_tcp(SimTime at, std::uint64_t connection, bool of_client,
                       std::span<const std::uint8_t> bytes, const Use& use);
  std::size_t take_rtu(SimTime at, bool of_client, std::span<const std::uint8_t> bytes,
                       const Use& use);
  /// `pdu` begins at byte `from` of the message.
  void read(SimTime at, Exchange exchange, bool of_client, std::uint8_t number,
            std::span<const std::uint8_t> pdu, std::size_t from, WireReading& reading);
  void read_request(Exchange exchange, Unit* unit, std::span<const std::uint8_t> pdu,
                    std::size_t from, WireReading& reading);
  void read_answer(SimTime at, Exchange exchange, Unit* unit, std::span<const std::uint8_t> pdu,
                   std::size_t from, WireReading& reading);
  /// Reads registers, or packed bits, at `from` of the message. `seen`: enters their values.
  struct Span {
    emulators::ModbusTable table;
    std::size_t address = 0;
    std::size_t count = 0;
  };
  void read_values(Unit* unit, Span span, std::span<const std::uint8_t> data, std::size_t from,
                   std::optional<SimTime> seen, WireReading& reading);
  void note_written(SimTime at, Exchange exchange, Unit& unit,
                    const protocols::modbus::Request& request);

  Line line_;
  std::deque<Unit> units_;
  std::vector<Row> rows_;
  std::map<Stream, std::vector<std::uint8_t>> kept_;
  std::map<Exchange, protocols::modbus::Request> pending_;
};

}  // namespace rigwire::hil
