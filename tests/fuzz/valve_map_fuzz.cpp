// A valve driver over a map with every format, fed with any writes and reads: what is refused has
// changed nothing, its openings stay within travel, and it never wants to live in the past.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "emulators/valve_driver/valve_driver.h"
#include "protocols/bytes.h"

namespace {

using namespace rigwire;
using namespace emulators;

void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

ValveMap fuzzed_map() {
  ValveMap map;
  map.watchdog_recovers = true;
  map.gaps_read_zero = true;
  map.input_mirror = 1000;
  std::uint16_t address = 0;
  for (const ValveSignalInfo& signal : valve_signals()) {
    ValveRegister row;
    row.name = signal.name;
    row.signal = signal.signal;
    row.unit = signal.unit;
    row.count = signal.per_section ? 8 : 1;
    row.address = address;
    row.writable = signal.commanded;
    row.table = signal.commanded ? protocols::modbus::Table::holding_registers
                                 : protocols::modbus::Table::input_registers;
    constexpr std::array kFormats{RegisterFormat::u16, RegisterFormat::s16, RegisterFormat::u32,
                                  RegisterFormat::s32, RegisterFormat::f32};
    row.format = kFormats[address % kFormats.size()];
    row.order = address % 2 == 0 ? WordOrder::high_first : WordOrder::low_first;
    row.clip = address % 3 == 0;
    if (row.signal == ValveSignal::bits) {
      row.format = RegisterFormat::u16;
      row.bits = {{0, ValveSignal::ready, {}}, {15, ValveSignal::fault, {}, true}};
    } else if (row.signal == ValveSignal::text) {
      row.format = RegisterFormat::text;
      row.content = "ab";
    }
    address = static_cast<std::uint16_t>(address + row.count * row.words());
    map.registers.push_back(row);
  }
  return map;
}

}  // namespace

/// Each record is (address, count, wait in ms, words); a count of more than 128 reads.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const ValveDriverSettings kSettings = [] {
    ValveDriverSettings settings;
    settings.map = fuzzed_map();
    return settings;
  }();
  ValveDriver driver(kSettings);
  ModbusUnit& unit = driver.unit();
  std::span rest(data, size);
  SimTime now = kStart;
  while (rest.size() >= 4) {
    const auto address = protocols::load_little<std::uint16_t>(rest, 0);
    const bool reads = rest[2] > 128;
    const std::size_t count = std::min<std::size_t>(1U + rest[2] % 123U, 123U);
    now += std::chrono::milliseconds(rest[3]);
    rest = rest.subspan(4);
    driver.advance(now);
    std::array<std::uint16_t, 123> words{};
    if (reads) {
      (void)unit.read_registers(protocols::modbus::RegisterTable::input, address,
                                std::span(words).first(count));
      (void)unit.read_registers(protocols::modbus::RegisterTable::holding, address,
                                std::span(words).first(count));
    } else {
      const std::size_t there = std::min(count, rest.size() / 2);
      for (std::size_t i = 0; i < there; ++i) {
        words[i] = protocols::load_little<std::uint16_t>(rest, 2 * i);
      }
      rest = rest.subspan(2 * there);
      const ValveCommand before = driver.command();
      if (unit.write_registers(now, address, std::span(words).first(count))) {
        require(driver.command().opening == before.opening);
      } else {
        unit.served(now);
      }
    }
    require(driver.next_event() > now);
    for (const double opening : driver.command().opening) {
      require(std::abs(opening) <= 1.0);
    }
  }
  return 0;
}
