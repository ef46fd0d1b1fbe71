// Two valve drivers, units 1 and 7, on a Modbus RTU line: a real pseudo-terminal, on the wall
// clock, in its own thread, with every byte recorded for tshark. What the executive does, in small.
#pragma once

#include <atomic>
#include <boost/asio/io_context.hpp>
#include <chrono>
#include <cstdint>
#include <deque>
#include <mutex>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "drivers/pty.h"
#include "emulators/modbus/modbus_rtu_server.h"
#include "emulators/valve_driver/valve_driver.h"
#include "modbus_rig.h"

namespace rigwire::conformance {

class ModbusRtuRig final : private emulators::ByteOutput {
 public:
  ModbusRtuRig(const emulators::ModbusRtuSettings& line,
               const emulators::ValveDriverSettings& valves)
      : timing_(line.line.timing),
        pty_(context_, "", timing_.baud),
        modbus_(line, *this),
        first_(valves),
        second_(valves) {
    modbus_.add_unit(1, first_.unit());
    modbus_.add_unit(7, second_.unit());
    pty_.on_client([this](const drivers::LineClient& client) {
      modbus_.set_client(arrive(), {client.present, client.baud});
    });
    pty_.start([this](std::span<const std::uint8_t> bytes) {
      record(true, bytes, Duration{0});
      modbus_.receive(arrive(), bytes);
    });
    thread_ = std::thread([this] { run(); });
  }
  ~ModbusRtuRig() override {
    stop_ = true;
    thread_.join();
  }
  ModbusRtuRig(const ModbusRtuRig&) = delete;
  ModbusRtuRig& operator=(const ModbusRtuRig&) = delete;

  [[nodiscard]] const std::string& path() const { return pty_.slave_name(); }
  [[nodiscard]] const protocols::modbus::RtuTiming& timing() const { return timing_; }
  /// What the client wrote and what was answered, an answer in one piece.
  [[nodiscard]] std::vector<Segment> segments() const {
    const std::lock_guard lock(mutex_);
    return segments_;
  }
  /// Set points of the first section of units 1 and 7.
  [[nodiscard]] std::array<double, 2> openings() const {
    const std::lock_guard lock(mutex_);
    return openings_;
  }

 private:
  struct Due {
    SimTime when;
    std::uint8_t byte;
  };

  void send(SimTime due, std::span<const std::uint8_t> bytes) override {
    for (const std::uint8_t byte : bytes) {
      due_.push_back({due, byte});
    }
  }

  [[nodiscard]] SimTime now() const {
    return kStart + std::chrono::duration_cast<Duration>(std::chrono::steady_clock::now() - start_);
  }
  SimTime arrive() {
    const SimTime present = now();
    live(present);
    return present;
  }
  void live(SimTime until) {
    modbus_.advance(until);
    first_.advance(until);
    second_.advance(until);
  }

  void run() {
    while (!stop_) {
      live(now());
      for (; !due_.empty() && due_.front().when <= now(); due_.pop_front()) {
        record(false, std::span(&due_.front().byte, 1), timing_.frame_silence());
        (void)pty_.write(std::span(&due_.front().byte, 1));
      }
      {
        const std::lock_guard lock(mutex_);
        openings_ = {first_.command().opening[0], second_.command().opening[0]};
      }
      const SimTime wake =
          std::min({now() + std::chrono::milliseconds(2), modbus_.next_event(), first_.next_event(),
                    second_.next_event(), due_.empty() ? kNever : due_.front().when});
      context_.run_one_for(std::max(wake - now(), Duration{1}));
    }
  }

  /// Bytes of the same side belong to the segment before; lumps of the client stay apart when
  /// `join` is 0.
  void record(bool from_client, std::span<const std::uint8_t> bytes, Duration join) {
    const std::lock_guard lock(mutex_);
    const bool goes_on =
        join > Duration{0} && !segments_.empty() && segments_.back().from_client == from_client;
    if (!goes_on) {
      segments_.push_back({now().time_since_epoch(), 1, from_client, {}});
    }
    segments_.back().bytes.insert(segments_.back().bytes.end(), bytes.begin(), bytes.end());
  }

  const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  const protocols::modbus::RtuTiming timing_;
  boost::asio::io_context context_;
  drivers::Pty pty_;
  emulators::ModbusRtuServer modbus_;
  emulators::ValveDriver first_;
  emulators::ValveDriver second_;
  std::deque<Due> due_;
  mutable std::mutex mutex_;
  std::vector<Segment> segments_;
  std::array<double, 2> openings_{};
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

}  // namespace rigwire::conformance
