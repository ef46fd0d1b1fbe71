// Hydraulic valve driver on Modbus: a valve amplifier (emulators/valve_amplifier/) behind a map of
// registers that is data (valve_map.h), Rigwire's own (registers.h) or a user's.
//
// Format page of the own map: docs/devices/valve-driver.md. Whatever the map:
//   - A request is carried out whole or not at all. A value out of range is refused with exception
//     03, or held at its limit where the map says `clip`.
//   - What one request writes acts at one instant; parameters before commands.
//   - When the outputs become enabled, commands that the request did not write go to 0, in their
//     registers too. So it is section by section where a map enables them one by one.
//   - A command in two halves is command_a less command_b, as the currents of two solenoids pull
//     against each other.
//   - Without supply it receives nothing and its outputs are at neutral. When the supply comes back
//     the registers are as delivered, and nothing is enabled or latched.
//   - Registers of sections that are not fitted take a command of 0 only and read 0.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "emulators/backends.h"
#include "emulators/device.h"
#include "emulators/modbus/modbus_unit.h"
#include "emulators/supply.h"
#include "emulators/valve_amplifier/amplifier.h"
#include "emulators/valve_driver/register_image.h"
#include "emulators/valve_driver/registers.h"
#include "emulators/valve_driver/valve_map.h"
#include "fields/rules.h"
#include "sim/samples/valve_sample.h"

namespace rigwire::emulators {

struct ValveDriverSettings {
  ValveAmplifierSettings amplifier;
  Duration sample_period = std::chrono::milliseconds(5);  ///< Transducers, 1 ms .. 1 s.
  /// Without: Rigwire's own. Its initial values beat the amplifier's parameters.
  std::optional<ValveMap> map;
  std::vector<SupplyFault> supply_faults;
};
/// Without the map, which comes from a file of its own.
void visit(fields::Visitor& v, ValveDriverSettings& p);
/// Throws std::invalid_argument naming the setting, what was found and what is allowed.
void validate(const ValveDriverSettings& settings);

class ValveDriver final : public ModbusDevice, public ValveBackend {
 public:
  /// Throws std::invalid_argument.
  explicit ValveDriver(const ValveDriverSettings& settings);

  [[nodiscard]] ModbusUnit& unit() override { return unit_; }
  [[nodiscard]] const LastRequest& last_request() const { return unit_.last_request(); }

  void advance(SimTime now) override;
  [[nodiscard]] SimTime next_event() const override {
    return std::min(supply_.next_change(), amplifier_.next_event());
  }
  [[nodiscard]] SamplePlan sample_plan() const override;
  [[nodiscard]] ReceiveCounters received() const override { return unit_.received(); }
  [[nodiscard]] double nominal_rate_hz() const override { return 0.0; }
  [[nodiscard]] std::span<const Quantity> quantities() const override { return quantities_; }

  void update(const ValveSample& sample) override;
  [[nodiscard]] const ValveCommand& command() const override { return amplifier_.command(); }

  [[nodiscard]] const ValveAmplifier& amplifier() const { return amplifier_; }
  /// What goes wrong with coils, spools, sensors and their surroundings.
  [[nodiscard]] ValveAmplifier& defects() { return amplifier_; }
  [[nodiscard]] Supply& supply() { return supply_; }
  [[nodiscard]] const ValveMap& map() const { return map_; }
  [[nodiscard]] ValveFault fault() const { return amplifier_.fault(); }
  [[nodiscard]] bool enabled() const { return amplifier_.enabled(); }

 private:
  using RegisterTable = protocols::modbus::RegisterTable;
  using BitTable = protocols::modbus::BitTable;

  /// The wire's view of the driver.
  class Unit final : public ModbusUnit {
   public:
    explicit Unit(ValveDriver& driver);
    void advance(SimTime now) override { driver_.advance(now); }
    [[nodiscard]] bool supplied() const override { return driver_.supply_.on(); }
    [[nodiscard]] std::uint32_t starts() const override { return driver_.starts_; }
    Outcome read_registers(RegisterTable table, std::uint16_t address,
                           std::span<std::uint16_t> values) const override;
    Outcome write_registers(SimTime now, std::uint16_t address,
                            std::span<const std::uint16_t> values) override;
    Outcome read_bits(BitTable table, std::uint16_t address,
                      protocols::modbus::BitBlock& bits) const override;
    Outcome write_coils(SimTime now, std::uint16_t address,
                        const protocols::modbus::BitBlock& coils) override;
    [[nodiscard]] std::string_view server_id() const override;
    [[nodiscard]] std::span<const IdentificationObject> identification() const override;
    [[nodiscard]] bool has_function(std::uint8_t function) const override;
    void served(SimTime now) override;

   private:
    ValveDriver& driver_;
    std::array<IdentificationObject, 4> objects_;
    std::string server_id_;
  };

  /// What one write does, collected before it acts.
  struct Change {
    ValveRequest request;
    /// Halves of a command, in %, where a map has them apart.
    std::array<std::optional<double>, kValveSections> towards_a{};
    std::array<std::optional<double>, kValveSections> towards_b{};
    ValveAmplifierParameters parameters;
    bool parameters_written = false;
    bool command_written = false;
    bool watchdog_written = false;
    std::optional<std::uint16_t> heartbeat;
    std::optional<WatchdogFeed> feed;
  };

  // Reading.
  [[nodiscard]] ModbusUnit::Outcome read(ModbusTable table, std::size_t address,
                                         std::span<std::uint16_t> values) const;
  [[nodiscard]] RegisterWords words_of(const ValveRegister& entry, std::size_t index) const;
  [[nodiscard]] double value_of(ValveSignal signal, std::size_t section) const;
  [[nodiscard]] double measured_value(ValveSignal signal, std::size_t section) const;
  [[nodiscard]] double parameter_value(ValveSignal signal, std::size_t section) const;
  [[nodiscard]] double count_of(const ValveRegister& entry, std::size_t index) const;
  // Writing. `values` are held at their limits where the map says so.
  [[nodiscard]] ModbusUnit::Outcome check_write(ModbusTable table, std::size_t address,
                                                std::span<std::uint16_t> values) const;
  [[nodiscard]] ModbusUnit::Outcome write(SimTime now, ModbusTable table, std::size_t address,
                                          std::span<const std::uint16_t> values);
  [[nodiscard]] bool accepts(const ValveRegister& entry, std::size_t index,
                             RegisterWords& words) const;
  void collect(const ValveRegister& entry, std::size_t index, Change& change) const;
  void collect(ValveSignal signal, std::optional<std::size_t> section, double value,
               Change& change) const;
  void act(SimTime now, Change change);
  /// Commands from their halves, and enable from the sections', where the map has only these.
  void complete(Change& change);
  void count_heartbeat(SimTime now, std::uint16_t value);
  void feed(SimTime now);
  void forget_commands();
  /// Registers as delivered, and what follows from them.
  void power_up(SimTime now);
  void switch_supply(SimTime now);
  void describe_quantities();

  const ValveDriverSettings settings_;
  const ValveMap map_;
  RegisterImage image_;
  ValveAmplifier amplifier_;
  const bool enabled_by_section_;
  Supply supply_;
  std::uint32_t starts_ = 0;
  WatchdogFeed feed_ = WatchdogFeed::any_request;
  std::array<double, kValveSections> towards_a_{};  ///< Commands last written by the master, %.
  std::array<double, kValveSections> towards_b_{};
  bool heartbeat_seen_ = false;
  std::uint16_t heartbeat_ = 0;
  std::uint16_t missed_cycles_ = 0;
  SimTime now_{};
  std::vector<Quantity> quantities_;
  Unit unit_;
};

}  // namespace rigwire::emulators
