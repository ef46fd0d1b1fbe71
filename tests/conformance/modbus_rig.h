// A valve driver on a real loopback TCP port, on the wall clock, in its own thread, with every byte
// recorded for tshark. What the executive does, in small.
#pragma once

#include <atomic>
#include <boost/asio/io_context.hpp>
#include <chrono>
#include <cstdint>
#include <deque>
#include <mutex>
#include <span>
#include <thread>
#include <vector>

#include "drivers/tcp_server.h"
#include "emulators/modbus/modbus_server.h"
#include "emulators/valve_driver/valve_driver.h"

namespace rigwire::conformance {

/// Bytes that crossed the wire in one piece.
struct Segment {
  std::chrono::nanoseconds when{};
  std::uint64_t connection = 0;
  bool from_client = false;
  std::vector<std::uint8_t> bytes;
};

class ModbusRig final : private emulators::StreamOutput {
 public:
  explicit ModbusRig(const emulators::ValveDriverSettings& settings = {})
      : server_(context_, server_settings()), modbus_({}, *this), driver_(settings) {
    modbus_.add_unit(1, driver_.unit());
    server_.start({[this](auto id) { modbus_.connected(now(), id); },
                   [this](auto id, auto bytes) {
                     record(id, true, bytes);
                     modbus_.receive(now(), id, bytes);
                   },
                   [this](auto id) { modbus_.disconnected(now(), id); }});
    thread_ = std::thread([this] { run(); });
  }
  ~ModbusRig() {
    stop_ = true;
    thread_.join();
  }
  ModbusRig(const ModbusRig&) = delete;
  ModbusRig& operator=(const ModbusRig&) = delete;

  [[nodiscard]] std::uint16_t port() const { return server_.port(); }
  [[nodiscard]] std::vector<Segment> segments() const {
    const std::lock_guard lock(mutex_);
    return segments_;
  }
  [[nodiscard]] ValveCommand command() const {
    const std::lock_guard lock(mutex_);
    return command_;
  }
  void measure(const ValveSample& sample) {
    const std::lock_guard lock(mutex_);
    sample_ = sample;
    sample_waiting_ = true;
  }

 private:
  struct Due {
    SimTime when;
    emulators::ConnectionId connection = 0;
    bool close = false;
    std::vector<std::uint8_t> bytes;
  };

  static drivers::TcpServerSettings server_settings() {
    drivers::TcpServerSettings settings;
    settings.port = 0;
    return settings;
  }

  void send(emulators::ConnectionId connection, SimTime due,
            std::span<const std::uint8_t> bytes) override {
    due_.push_back({due, connection, false, {bytes.begin(), bytes.end()}});
  }
  void close(emulators::ConnectionId connection, SimTime due) override {
    due_.push_back({due, connection, true, {}});
  }

  [[nodiscard]] SimTime now() const {
    return kStart + std::chrono::duration_cast<Duration>(std::chrono::steady_clock::now() - start_);
  }

  void run() {
    while (!stop_) {
      driver_.advance(now());
      for (; !due_.empty() && due_.front().when <= now(); due_.pop_front()) {
        const Due& item = due_.front();
        if (item.close) {
          server_.close(item.connection);
        } else {
          record(item.connection, false, item.bytes);
          server_.send(item.connection, item.bytes);
        }
      }
      {
        const std::lock_guard lock(mutex_);
        if (sample_waiting_) {
          sample_.time = now();
          driver_.update(sample_);
          sample_waiting_ = false;
        }
        command_ = driver_.command();
      }
      const SimTime wake =
          std::min(now() + std::chrono::milliseconds(2),
                   std::min(driver_.next_event(), due_.empty() ? kNever : due_.front().when));
      context_.run_one_for(std::max(wake - now(), Duration{1}));
    }
  }

  void record(std::uint64_t connection, bool from_client, std::span<const std::uint8_t> bytes) {
    const std::lock_guard lock(mutex_);
    segments_.push_back(
        {now().time_since_epoch(), connection, from_client, {bytes.begin(), bytes.end()}});
  }

  const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  boost::asio::io_context context_;
  drivers::TcpServer server_;
  emulators::ModbusServer modbus_;
  emulators::ValveDriver driver_;
  std::deque<Due> due_;
  mutable std::mutex mutex_;
  std::vector<Segment> segments_;
  ValveCommand command_;
  ValveSample sample_;
  bool sample_waiting_ = false;
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

}  // namespace rigwire::conformance
