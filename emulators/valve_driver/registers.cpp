#include "emulators/valve_driver/registers.h"

#include <cmath>
#include <utility>

namespace rigwire::emulators::valve_registers {
namespace {

using enum ValveSignal;
using Format = RegisterFormat;

constexpr auto kRows = static_cast<std::uint16_t>(kValveSections);

struct Range {
  double lower = 0.0;
  double upper = 65535.0;
};

ValveRegister holding(const char* name, std::uint16_t address, Format format, ValveSignal signal,
                      const char* unit, double scale, Range range, double initial,
                      const char* text) {
  ValveRegister entry;
  entry.name = name;
  entry.address = address;
  entry.format = format;
  entry.writable = true;
  entry.signal = signal;
  entry.unit = unit;
  entry.scale = scale;
  entry.lower = range.lower;
  entry.upper = range.upper;
  entry.initial = std::round(initial);
  entry.text = text;
  return entry;
}

ValveRegister input(const char* name, std::uint16_t address, std::uint16_t count, Format format,
                    ValveSignal signal, const char* unit, double scale, Range range,
                    const char* text) {
  ValveRegister entry = holding(name, address, format, signal, unit, scale, range, 0, text);
  entry.table = ModbusTable::input_registers;
  entry.count = count;
  entry.writable = false;
  entry.initial.reset();
  return entry;
}

double count_ms(Duration span) {
  return to_seconds(span) * 1e3;
}

void add_commands(ValveMap& map, const ValveAmplifierParameters& p) {
  auto& list = map.registers;
  ValveRegister control =
      holding("control", kControl, Format::u16, bits, "", 1, {0, kControlMaximum}, 0,
              "bit 0 enable, 1 fault reset (edge), 2 float, 3 quick stop");
  control.bits = {{0, enable, {}}, {1, fault_reset, {}}, {2, floating, {}}, {3, quick_stop, {}}};
  list.push_back(std::move(control));
  ValveRegister commands =
      holding("spool_command", kSpoolCommand, Format::s16, command, "%", 0.1, {-1000, 1000}, 0,
              "one per section, positive opens port A; sections that are not fitted take 0 only");
  commands.count = kRows;
  list.push_back(std::move(commands));
  list.push_back(holding("heartbeat", kHeartbeat, Format::u16, heartbeat, "", 1, {}, 0,
                         "master's cycle counter"));
  list.push_back(holding("dither_amplitude", kDitherAmplitude, Format::u16, dither_amplitude, "mA",
                         1, {0, 500}, p.dither.amplitude_ma,
                         "of the coil currents; more than `current_start` is fault 8"));
  list.push_back(holding("dither_frequency", kDitherFrequency, Format::u16, dither_frequency, "Hz",
                         1, {20, 400}, p.dither.frequency_hz, ""));
  list.push_back(holding("current_start", kCurrentStart, Format::u16, current_start, "mA", 1, {},
                         p.current_start_ma,
                         "at the least opening; not below `current_full` is fault 8"));
  list.push_back(holding("current_full", kCurrentFull, Format::u16, current_full, "mA", 1, {},
                         p.current_full_ma, "at 100 % opening"));
  ValveRegister time_out = holding("watchdog", kWatchdog, Format::u16, watchdog, "ms", 1,
                                   {20, 5000}, count_ms(p.watchdog), "0 off, else 20 .. 5000");
  time_out.also = {0};
  list.push_back(std::move(time_out));
  list.push_back(holding("reaction", kReaction, Format::u16, reaction, "", 1, {0, 2},
                         static_cast<double>(p.reaction),
                         "when the watchdog trips: 0 neutral, 1 hold, 2 float"));
  list.push_back(holding("watchdog_source", kWatchdogSource, Format::u16, watchdog_source, "", 1,
                         {0, 1}, 0,
                         "fed by: 0 every request that is served, 1 a changed heartbeat only"));
}

void add_parameters(ValveMap& map, std::size_t sections) {
  const auto add = [&](const char* name, Parameter which, Format format, ValveSignal signal,
                       const char* unit, double scale, Range range, double initial,
                       const char* text) -> ValveRegister& {
    ValveRegister entry = holding(name, static_cast<std::uint16_t>(kSectionParameters + which),
                                  format, signal, unit, scale, range, initial, text);
    entry.count = static_cast<std::uint16_t>(sections);
    entry.stride = kParameterStride;
    return map.registers.emplace_back(std::move(entry));
  };
  add("dead_band_positive", Parameter::dead_band_positive, Format::u16,
      ValveSignal::dead_band_positive, "%", 0.1, {0, 500}, 0,
      "spool travel that the smallest positive command jumps to");
  add("dead_band_negative", Parameter::dead_band_negative, Format::u16,
      ValveSignal::dead_band_negative, "%", 0.1, {0, 500}, 0, "the same for negative commands");
  add("ramp_up", Parameter::ramp_up, Format::u16, ValveSignal::ramp_up, "ms", 1, {0, 5000}, 0,
      "time from neutral to 100 %");
  add("ramp_down", Parameter::ramp_down, Format::u16, ValveSignal::ramp_down, "ms", 1, {0, 5000}, 0,
      "time from 100 % to neutral");
  add("gain", Parameter::gain, Format::u16, ValveSignal::gain, "%", 0.1, {0, 2000}, 1000,
      "command times gain, held at 100 %");
  add("polarity", Parameter::polarity, Format::s16, ValveSignal::polarity, "", 1, {-1, 1}, 1,
      "1, or -1 to exchange the ports")
      .except = {0};
}

void add_inputs(ValveMap& map) {
  auto& list = map.registers;
  ValveRegister state =
      input("status", kStatus, 1, Format::u16, bits, "", 1, {0, 31},
            "bit 0 ready, 1 enabled, 2 fault, 3 watchdog tripped, 4 an output at its limit");
  state.bits = {{0, ready, {}},
                {1, enabled, {}},
                {2, fault, {}},
                {3, watchdog_tripped, {}},
                {4, at_limit, {}}};
  list.push_back(std::move(state));
  list.push_back(input("fault_code", kFaultCode, 1, Format::u16, fault_code, "", 1, {0, 8},
                       "0 none, 1 watchdog, 2 open coil, 3 over-current, 4 under-voltage, 5 spool "
                       "not following, 6 sensor, 7 over-temperature, 8 configuration"));
  list.push_back(input("spool_position", kSpoolPosition, kRows, Format::s16, spool_position, "%",
                       0.1, {-1000, 1000}, "measured, one per section"));
  list.push_back(input("coil_current", kCoilCurrent, kRows, Format::u16, coil_current, "mA", 1, {},
                       "of the coil in use, one per section"));
  list.push_back(input("supply_voltage", kSupplyVoltage, 1, Format::u16, supply_voltage, "V", 0.01,
                       {}, "electrical"));
  list.push_back(input("driver_temperature", kDriverTemperature, 1, Format::s16, driver_temperature,
                       "degC", 0.1, {-400, 1500}, ""));
  list.push_back(input("heartbeat_echo", kHeartbeatEcho, 1, Format::u16, heartbeat_echo, "", 1, {},
                       "last heartbeat written"));
  list.push_back(input("missed_cycles", kMissedCycles, 1, Format::u16, missed_cycles, "", 1, {},
                       "heartbeat steps that were skipped, wraps"));
  list.push_back(input("fault_section", kFaultSection, 1, Format::u16, fault_section, "", 1, {0, 8},
                       "of the latched fault, from 1; 0: the whole driver"));
  list.push_back(input("swing_angle", kSwingAngle, 1, Format::s32, swing_angle, "deg", 0.001,
                       {-2147483647, 2147483647},
                       "swing encoder, upper structure against undercarriage, left positive; high "
                       "word first"));
  list.push_back(input("swing_rate", kSwingRate, 1, Format::s16, swing_rate, "deg/s", 0.01,
                       {-32767, 32767}, "left positive"));
  list.push_back(
      input("measurement_count", kMeasurementCount, 1, Format::u16, measurement_count, "", 1, {},
            "measurements taken, wraps; does not change while the transducers are silent"));
  list.push_back(input("port_a_pressure", kPortAPressure, kRows, Format::u16, port_a_pressure,
                       "bar", 0.1, {}, "cylinder bottom side or motor port A, one per section"));
  list.push_back(input("port_b_pressure", kPortBPressure, kRows, Format::u16, port_b_pressure,
                       "bar", 0.1, {}, "cylinder rod side or motor port B, one per section"));
  list.push_back(input("supply_pressure", kSupplyPressure, 1, Format::u16, supply_pressure, "bar",
                       0.1, {}, "pump"));
  list.push_back(input("oil_temperature", kOilTemperature, 1, Format::s16, oil_temperature, "degC",
                       0.1, {-400, 1500}, ""));
}

}  // namespace

ValveMap map(std::size_t sections, const ValveAmplifierParameters& parameters) {
  ValveMap map;
  map.gaps_read_zero = true;
  map.input_mirror = kInputMirror;
  add_commands(map, parameters);
  add_parameters(map, sections);
  add_inputs(map);
  return map;
}

}  // namespace rigwire::emulators::valve_registers
