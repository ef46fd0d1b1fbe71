#include "emulators/valve_driver/registers.h"

#include <array>

namespace rigwire::emulators::valve_registers {
namespace {

using protocols::modbus::Access;
using protocols::modbus::Format;
using protocols::modbus::RegisterEntry;
using protocols::modbus::Table;

constexpr auto kRows = static_cast<std::uint16_t>(kValveSections);

constexpr RegisterEntry holding(std::string_view name, std::uint16_t address, std::uint16_t count,
                                Format format, std::string_view unit, double scale,
                                std::int32_t lower, std::int32_t upper, std::int32_t initial,
                                std::string_view text) {
  return {name,
          Table::holding_registers,
          address,
          count,
          1,
          format,
          Access::read_write,
          unit,
          scale,
          lower,
          upper,
          initial,
          text};
}

constexpr RegisterEntry parameter(std::string_view name, Parameter which, Format format,
                                  std::string_view unit, double scale, std::int32_t lower,
                                  std::int32_t upper, std::int32_t initial, std::string_view text) {
  RegisterEntry entry = holding(name, static_cast<std::uint16_t>(kSectionParameters + which), kRows,
                                format, unit, scale, lower, upper, initial, text);
  entry.stride = kParameterStride;
  return entry;
}

constexpr RegisterEntry input(std::string_view name, std::uint16_t address, std::uint16_t count,
                              Format format, std::string_view unit, double scale,
                              std::int32_t lower, std::int32_t upper, std::string_view text) {
  return {name,
          Table::input_registers,
          address,
          count,
          1,
          format,
          Access::read,
          unit,
          scale,
          lower,
          upper,
          0,
          text};
}

constexpr std::array kMap{
    holding("control", kControl, 1, Format::u16, "", 1, 0, kControlMaximum, 0,
            "bit 0 enable, 1 fault reset (edge), 2 float, 3 quick stop"),
    holding("spool_command", kSpoolCommand, kRows, Format::s16, "%", 0.1, -1000, 1000, 0,
            "one per section, positive opens port A; sections that are not fitted take 0 only"),
    holding("heartbeat", kHeartbeat, 1, Format::u16, "", 1, 0, 65535, 0, "master's cycle counter"),
    holding("watchdog", kWatchdog, 1, Format::u16, "ms", 1, 0, 5000, 200, "0 off, else 20 .. 5000"),
    holding("reaction", kReaction, 1, Format::u16, "", 1, 0, 2, 0,
            "when the watchdog trips: 0 neutral, 1 hold, 2 float"),
    holding("watchdog_source", kWatchdogSource, 1, Format::u16, "", 1, 0, 1, 0,
            "fed by: 0 every request that is served, 1 a changed heartbeat only"),
    parameter("dead_band_positive", dead_band_positive, Format::u16, "%", 0.1, 0, 500, 0,
              "spool travel that the smallest positive command jumps to"),
    parameter("dead_band_negative", dead_band_negative, Format::u16, "%", 0.1, 0, 500, 0,
              "the same for negative commands"),
    parameter("ramp_up", ramp_up, Format::u16, "ms", 1, 0, 5000, 0, "time from neutral to 100 %"),
    parameter("ramp_down", ramp_down, Format::u16, "ms", 1, 0, 5000, 0,
              "time from 100 % to neutral"),
    parameter("gain", gain, Format::u16, "%", 0.1, 0, 2000, 1000,
              "command times gain, held at 100 %"),
    parameter("polarity", polarity, Format::s16, "", 1, -1, 1, 1, "1, or -1 to exchange the ports"),
    input("status", kStatus, 1, Format::u16, "", 1, 0, 31,
          "bit 0 ready, 1 enabled, 2 fault, 3 watchdog tripped, 4 an output at its limit"),
    input("fault_code", kFaultCode, 1, Format::u16, "", 1, 0, 8,
          "0 none, 1 watchdog, 2 open coil, 3 over-current, 4 under-voltage, 5 spool not "
          "following, 6 sensor, 7 over-temperature, 8 configuration"),
    input("spool_position", kSpoolPosition, kRows, Format::s16, "%", 0.1, -1000, 1000,
          "measured, one per section"),
    input("coil_current", kCoilCurrent, kRows, Format::u16, "mA", 1, 0, 65535,
          "of the coil in use, one per section"),
    input("supply_voltage", kSupplyVoltage, 1, Format::u16, "V", 0.01, 0, 65535, "electrical"),
    input("driver_temperature", kDriverTemperature, 1, Format::s16, "degC", 0.1, -400, 1500, ""),
    input("heartbeat_echo", kHeartbeatEcho, 1, Format::u16, "", 1, 0, 65535,
          "last heartbeat written"),
    input("missed_cycles", kMissedCycles, 1, Format::u16, "", 1, 0, 65535,
          "heartbeat steps that were skipped, wraps"),
    input("swing_angle", kSwingAngle, 1, Format::s32, "deg", 0.001, -2147483647, 2147483647,
          "swing encoder, upper structure against undercarriage, left positive; high word first"),
    input("swing_rate", kSwingRate, 1, Format::s16, "deg/s", 0.01, -32767, 32767, "left positive"),
    input("measurement_count", kMeasurementCount, 1, Format::u16, "", 1, 0, 65535,
          "measurements taken, wraps; stands still when the transducers are silent"),
    input("port_a_pressure", kPortAPressure, kRows, Format::u16, "bar", 0.1, 0, 65535,
          "cylinder bottom side or motor port A, one per section"),
    input("port_b_pressure", kPortBPressure, kRows, Format::u16, "bar", 0.1, 0, 65535,
          "cylinder rod side or motor port B, one per section"),
    input("supply_pressure", kSupplyPressure, 1, Format::u16, "bar", 0.1, 0, 65535, "pump"),
    input("oil_temperature", kOilTemperature, 1, Format::s16, "degC", 0.1, -400, 1500, ""),
};

}  // namespace

std::span<const RegisterEntry> map() {
  return kMap;
}

bool allowed(const RegisterEntry& entry, std::uint16_t raw) {
  constexpr std::int32_t kWatchdogMinimum_ms = 20;
  const std::int32_t value = protocols::modbus::signed_value(entry, raw);
  if (entry.access != Access::read_write || value < entry.lower || value > entry.upper) {
    return false;
  }
  if (entry.address == kWatchdog) {
    return value == 0 || value >= kWatchdogMinimum_ms;
  }
  if (entry.address == kSectionParameters + Parameter::polarity) {
    return value != 0;
  }
  return true;
}

}  // namespace rigwire::emulators::valve_registers
