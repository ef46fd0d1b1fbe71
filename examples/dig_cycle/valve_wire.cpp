#include "dig_cycle/valve_wire.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace rigwire::dig_cycle {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::uint16_t kEnable = 1U << 0U;
constexpr std::uint16_t kFaultReset = 1U << 1U;
constexpr std::uint16_t kStatusReady = 1U << 0U;
constexpr std::uint16_t kStatusEnabled = 1U << 1U;
constexpr std::uint16_t kStatusFault = 1U << 2U;
constexpr std::size_t kHeartbeatRegister = 9;
constexpr std::size_t kSpoolPositionRegister = 2;
constexpr std::size_t kSwingAngleRegister = 30;  ///< s32, 0.001 deg, high word first.
constexpr std::size_t kSwingRateRegister = 32;   ///< s16, 0.01 deg/s.
constexpr std::size_t kMeasurementCountRegister = 33;
constexpr std::size_t kPortARegister = 40;  ///< u16, 0.1 bar, one per section.
constexpr std::size_t kPortBRegister = 50;
constexpr double kPerPressureCount_pa = 1e4;
constexpr double kFullTravel = 1000.0;  ///< 0.1 %.
constexpr std::chrono::milliseconds kReconnect{200};

double signed_value(std::uint16_t raw) {
  return std::bit_cast<std::int16_t>(raw);
}

}  // namespace

std::array<std::uint16_t, kWrittenRegisters> written_registers(const PerJoint& openings,
                                                               bool enable, bool fault_reset,
                                                               std::uint16_t heartbeat) {
  std::array<std::uint16_t, kWrittenRegisters> registers{};
  registers[0] =
      static_cast<std::uint16_t>((enable ? kEnable : 0U) | (fault_reset ? kFaultReset : 0U));
  for (std::size_t joint = 0; joint < kJoints; ++joint) {
    const double opening = enable && std::isfinite(openings[joint]) ? openings[joint] : 0.0;
    const auto raw =
        static_cast<std::int16_t>(std::lround(std::clamp(opening, -1.0, 1.0) * kFullTravel));
    registers[1 + joint] = std::bit_cast<std::uint16_t>(raw);
  }
  registers[kHeartbeatRegister] = heartbeat;
  return registers;
}

ValveState read_state(const std::array<std::uint16_t, kReadRegisters>& registers) {
  ValveState state;
  state.ready = (registers[0] & kStatusReady) != 0;
  state.enabled = (registers[0] & kStatusEnabled) != 0;
  state.faulted = (registers[0] & kStatusFault) != 0;
  state.fault_code = registers[1];
  for (std::size_t joint = 0; joint < kJoints; ++joint) {
    state.spool[joint] = signed_value(registers[kSpoolPositionRegister + joint]) / kFullTravel;
  }
  state.boom_bottom_pa = registers[kPortARegister + boom] * kPerPressureCount_pa;
  state.boom_rod_side_pa = registers[kPortBRegister + boom] * kPerPressureCount_pa;
  const std::uint32_t angle = (static_cast<std::uint32_t>(registers[kSwingAngleRegister]) << 16U) |
                              registers[kSwingAngleRegister + 1];
  state.swing_rad = std::bit_cast<std::int32_t>(angle) * 0.001 * kDegree;
  state.swing_rate_radps = signed_value(registers[kSwingRateRegister]) * 0.01 * kDegree;
  state.measurement_count = registers[kMeasurementCountRegister];
  return state;
}

ValveWire::ValveWire(const drivers::ModbusMasterSettings& settings,
                     std::chrono::milliseconds period)
    : settings_(settings), period_(period) {
  const drivers::ModbusMaster check(settings_);  // refuses settings here, not in the thread
  thread_ = std::thread([this] { run(); });
}

ValveWire::~ValveWire() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  stopping_changed_.notify_all();
  thread_.join();
}

void ValveWire::command(const PerJoint& openings, bool enable) {
  const std::lock_guard lock(mutex_);
  openings_ = openings;
  enable_ = enable;
  commanded_ = Clock::now();
}

std::optional<ValveState> ValveWire::state() const {
  const std::lock_guard lock(mutex_);
  return state_;
}

std::string ValveWire::error() const {
  const std::lock_guard lock(mutex_);
  return error_;
}

bool ValveWire::cycle(drivers::ModbusMaster& master, bool last) {
  PerJoint openings{};
  bool enable = false;
  bool reset = false;
  {
    const std::lock_guard lock(mutex_);
    const bool fresh = Clock::now() - commanded_ < kCommandLife;
    if (fresh && !last) {
      openings = openings_;
      enable = enable_;
      ++heartbeat_;
    }
    // What a killed predecessor left, or a pause of this program, is a watchdog fault and reset;
    // every other fault is the user's to see.
    reset = enable && state_ && state_->faulted && state_->fault_code == kWatchdogFault &&
            !reset_written_;
  }
  reset_written_ = reset;
  const auto written = written_registers(openings, enable && !reset, reset, heartbeat_);
  std::array<std::uint16_t, kReadRegisters> read{};
  const auto outcome = master.read_write_registers(0, written, kReadAddress, read);
  const std::lock_guard lock(mutex_);
  if (!outcome) {
    error_ = outcome.error;
    return false;
  }
  error_.clear();
  ValveState state = read_state(read);
  state.received = Clock::now();
  state.cycles = state_ ? state_->cycles + 1 : 1;
  state_ = state;
  return true;
}

void ValveWire::run() {
  drivers::ModbusMaster master(settings_);
  auto next = Clock::now();
  std::unique_lock lock(mutex_);
  while (!stopping_) {
    lock.unlock();
    auto pause = period_;
    if (!master.connected()) {
      if (const auto outcome = master.connect(); !outcome) {
        const std::lock_guard guard(mutex_);
        error_ = outcome.error;
        pause = kReconnect;
      }
    }
    if (master.connected()) {
      (void)cycle(master, false);
    }
    next = std::max(next + pause, Clock::now());
    lock.lock();
    stopping_changed_.wait_until(lock, next, [this] { return stopping_; });
  }
  lock.unlock();
  if (master.connected()) {
    (void)cycle(master, true);
  }
}

}  // namespace rigwire::dig_cycle
