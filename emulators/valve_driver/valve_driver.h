// Hydraulic valve driver on Modbus: spool commands in, status and transducers out.
//
// Format page: docs/devices/valve-driver.md; registers in registers.h. In short:
//   - A request is carried out whole or not at all. Commands outside -1000 .. 1000 and every other
//     value out of range are refused with exception 03, never clipped.
//   - Outputs follow the commands only while enabled (control bit 0 set and no fault latched). A
//     command written while disabled is stored, and has no effect: on the change to enabled every
//     section starts from 0 unless that same request commands it.
//   - Quick stop, disabling and faults go to neutral at once, past the ramps; when quick stop is
//     cleared, sections start from 0 as after enabling. Float puts all fitted sections to float;
//     quick stop beats float.
//   - The watchdog runs while enabled, from the last request that feeds it (register 18). A
//     request at the very instant of expiry is too late. On expiry fault 1 is latched and the
//     outputs react (register 17) at exactly that instant; hold and float last until the master
//     clears enable, sets quick stop or resets the fault.
//   - A fault stays latched until control bit 1 goes from 0 to 1. If enable is set then, the
//     driver is enabled again, with all commands 0 unless that request carries some.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "emulators/backends.h"
#include "emulators/device.h"
#include "emulators/modbus/modbus_device.h"
#include "emulators/valve_driver/registers.h"
#include "emulators/valve_driver/stage.h"
#include "sim/samples/valve_sample.h"

namespace rigwire::emulators {

struct ValveDriverSettings {
  std::vector<std::string> sections = {"swing", "boom", "stick", "bucket"};  ///< 1 .. 8 names.
  Duration watchdog = std::chrono::milliseconds(200);  ///< 0 = off, 20 ms .. 5 s.
  valve_registers::Reaction reaction = valve_registers::Reaction::neutral;
  Duration sample_period = std::chrono::milliseconds(5);  ///< Transducers, 1 ms .. 1 s.
  Duration ramp_cycle = std::chrono::milliseconds(1);  ///< Output steps on a ramp, 0.1 .. 100 ms.
  double coil_current_start_ma = 250.0;                ///< At the least opening, 0 .. below full.
  double coil_current_full_ma = 750.0;                 ///< At 100 % opening, up to 65535.
  double supply_voltage_v = 24.0;                      ///< Reported, constant, 9 .. 32.
  double driver_temperature_c = 40.0;                  ///< Reported, constant, -40 .. 150.
  double spool_tolerance = 0.3;  ///< Set point to measured position, 0.01 .. 2.
  Duration spool_fault_delay = std::chrono::milliseconds(500);  ///< Off for this long; 0 = never.
  std::string vendor = "Rigwire";  ///< Identification texts, 1 .. 60 characters.
  std::string product_code = "RW-HVD8";
  std::string revision = "1.0";
  std::string product_name = "Hydraulic valve driver";
};
/// Throws std::invalid_argument naming the setting, what was found and what is allowed.
void validate(const ValveDriverSettings& settings);

class ValveDriver final : public ModbusDevice, public ValveBackend {
 public:
  /// Throws std::invalid_argument.
  explicit ValveDriver(const ValveDriverSettings& settings);

  [[nodiscard]] ModbusUnit& unit() override { return unit_; }

  void advance(SimTime now) override;
  [[nodiscard]] SimTime next_event() const override;
  [[nodiscard]] SamplePlan sample_plan() const override;
  [[nodiscard]] ReceiveCounters received() const override { return unit_.received(); }
  [[nodiscard]] double nominal_rate_hz() const override { return 0.0; }
  [[nodiscard]] std::span<const Quantity> quantities() const override { return quantities_; }

  /// A spool position that is not a number latches fault 6; other quantities that are not numbers
  /// leave their register as it is.
  void update(const ValveSample& sample) override;
  [[nodiscard]] const ValveCommand& command() const override { return command_; }

  [[nodiscard]] valve_registers::FaultCode fault() const { return fault_; }
  [[nodiscard]] bool enabled() const { return enabled_; }

 private:
  using RegisterTable = protocols::modbus::RegisterTable;
  using HoldingImage = std::array<std::uint16_t, valve_registers::kHoldingEnd>;

  /// The wire's view of the driver.
  class Unit final : public ModbusUnit {
   public:
    explicit Unit(ValveDriver& driver);
    void advance(SimTime now) override { driver_.advance(now); }
    Outcome read_registers(RegisterTable table, std::uint16_t address,
                           std::span<std::uint16_t> values) const override;
    Outcome write_registers(SimTime now, std::uint16_t address,
                            std::span<const std::uint16_t> values) override;
    [[nodiscard]] std::string_view server_id() const override;
    [[nodiscard]] std::span<const IdentificationObject> identification() const override;
    void served(SimTime now) override;

   private:
    ValveDriver& driver_;
    std::array<IdentificationObject, 4> objects_;
    std::string server_id_;
  };

  /// Nothing when every value may be written.
  [[nodiscard]] ModbusUnit::Outcome check_write(std::uint16_t address,
                                                std::span<const std::uint16_t> values) const;
  void apply_write(SimTime now, std::uint16_t address, std::span<const std::uint16_t> values);
  /// `written` says which commands the request carried.
  void apply_control(SimTime now, std::uint16_t old_control,
                     const std::array<bool, kValveSections>& written);
  void count_heartbeat(SimTime now, std::uint16_t old_value, std::uint16_t new_value);
  void take_parameters();
  [[nodiscard]] std::uint16_t input(std::uint16_t address) const;
  [[nodiscard]] std::uint16_t status() const;
  [[nodiscard]] double coil_current_ma(std::size_t section) const;

  [[nodiscard]] SimTime watchdog_deadline() const;
  void latch(SimTime now, valve_registers::FaultCode code);
  void set_targets(SimTime now);
  void release(SimTime now);
  void step_ramps(SimTime now);
  void schedule_ramp(SimTime now);
  void refresh_output(SimTime now);
  void store(std::uint16_t address, double value);
  void supervise_spools(const ValveSample& sample);
  void describe_quantities();

  const ValveDriverSettings settings_;
  HoldingImage holding_{};
  std::array<std::uint16_t, valve_registers::kInputEnd> measured_{};  ///< From the last sample.
  std::array<ValveStageParameters, kValveSections> parameters_{};
  std::array<ValveStage, kValveSections> stages_{};
  ValveCommand command_;
  bool enabled_ = false;
  bool watchdog_tripped_ = false;
  valve_registers::FaultCode fault_ = valve_registers::FaultCode::none;
  valve_registers::Reaction active_reaction_ =
      valve_registers::Reaction::neutral;  ///< After a trip.
  bool heartbeat_seen_ = false;
  std::uint16_t missed_cycles_ = 0;
  SimTime fed_{};                                          ///< Last time the watchdog was fed.
  SimTime next_ramp_ = kNever;                             ///< Next output step.
  std::array<SimTime, kValveSections> spool_off_since_{};  ///< kNever while it follows.
  std::vector<Quantity> quantities_;
  Unit unit_;
};

}  // namespace rigwire::emulators
