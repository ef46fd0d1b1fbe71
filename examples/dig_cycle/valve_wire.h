// The valve driver's Modbus connection: one function-23 request per cycle writes control word,
// commands and heartbeat, and reads status, spool positions and swing encoder.
//
// libmodbus blocks, so the connection lives in a thread of its own; commands go in and states come
// out under one lock. The heartbeat counts only while the program keeps commanding: when command()
// has not been called for kCommandLife, the thread writes neutral and leaves the heartbeat,
// whatever became of the rest of the program.
//
// Registers: docs/devices/valve-driver.md; addresses from 0.
#pragma once

#include <array>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "dig_cycle/machine.h"
#include "drivers/modbus_master.h"

namespace rigwire::dig_cycle {

/// What one answer of the driver says.
struct ValveState {
  std::chrono::steady_clock::time_point received{};
  bool ready = false;
  bool enabled = false;
  bool faulted = false;
  std::uint16_t fault_code = 0;
  PerJoint spool{};  ///< -1..1, measured.
  /// Ports of the boom's section: cylinders' bottom and rod side. 0: not measured.
  double boom_bottom_pa = 0.0;
  double boom_rod_side_pa = 0.0;
  double swing_rad = 0.0;
  double swing_rate_radps = 0.0;
  /// Counts the encoder's measurements: unchanged when the transducers are silent.
  std::uint16_t measurement_count = 0;
  std::uint64_t cycles = 0;  ///< Answers so far.
};

/// The registers that one cycle writes (from 0) and reads (input registers, mirrored from 1000).
inline constexpr std::size_t kWrittenRegisters = 1     // control word
                                                 + 8   // spool commands
                                                 + 1;  // heartbeat
inline constexpr std::size_t kReadRegisters = 58;      // status 0 .. port B pressures 57
inline constexpr std::uint16_t kReadAddress = 1000;
inline constexpr std::uint16_t kWatchdogFault = 1;

/// Openings beyond -1..1 are limited; a value that is not a number is neutral.
[[nodiscard]] std::array<std::uint16_t, kWrittenRegisters> written_registers(
    const PerJoint& openings, bool enable, bool fault_reset, std::uint16_t heartbeat);
[[nodiscard]] ValveState read_state(const std::array<std::uint16_t, kReadRegisters>& registers);

class ValveWire {
 public:
  static constexpr std::chrono::milliseconds kCommandLife{150};

  /// Starts connecting at once, and again after every failure. Throws std::invalid_argument.
  ValveWire(const drivers::ModbusMasterSettings& settings, std::chrono::milliseconds period);
  /// Neutral, disabled, disconnected; waits for the answer as long as the settings' time-out.
  ~ValveWire();
  ValveWire(const ValveWire&) = delete;
  ValveWire& operator=(const ValveWire&) = delete;

  /// Openings -1..1 of sections 1..4. `enable` false is neutral and disabled.
  void command(const PerJoint& openings, bool enable);
  /// The newest answer; empty before the first.
  [[nodiscard]] std::optional<ValveState> state() const;
  /// Why the last cycle failed; empty when it did not.
  [[nodiscard]] std::string error() const;

 private:
  void run();
  bool cycle(drivers::ModbusMaster& master, bool last);

  const drivers::ModbusMasterSettings settings_;
  const std::chrono::milliseconds period_;
  mutable std::mutex mutex_;
  std::condition_variable stopping_changed_;
  PerJoint openings_{};
  bool enable_ = false;
  std::chrono::steady_clock::time_point commanded_{};
  std::optional<ValveState> state_;
  std::string error_ = "not connected yet";
  bool stopping_ = false;
  std::uint16_t heartbeat_ = 0;  ///< Used by the thread only.
  bool reset_written_ = false;   ///< Used by the thread only: the reset bit acts on its edge.
  std::thread thread_;
};

}  // namespace rigwire::dig_cycle
