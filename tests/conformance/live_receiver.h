// A receiver on a pseudo-terminal in real time, living on a thread of its own until the object
// ends.
#pragma once

#include <atomic>
#include <boost/asio/io_context.hpp>
#include <chrono>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <mutex>
#include <span>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "child_process.h"
#include "drivers/pty.h"
#include "emulators/ublox/receiver.h"
#include "simulated_receiver.h"

namespace rigwire::test {

class LiveReceiver {
 public:
  struct State {
    SimTime time = kStart;
    emulators::UbloxCounters counters;
    emulators::ReceiveCounters received;
    std::uint32_t baud = 0;
    bool client_present = false;
    std::uint64_t bytes_refused = 0;  ///< By the system: the client did not read.
  };

  LiveReceiver(const emulators::UbloxSettings& settings, std::filesystem::path path,
               Sky sky = driving_machine)
      : path_(std::move(path)),
        thread_([this, settings, sky = std::move(sky)] { live(settings, sky); }) {
    while (!ready_) {
      std::this_thread::sleep_for(std::chrono::milliseconds{1});
    }
  }
  ~LiveReceiver() {
    stop_ = true;
    thread_.join();
  }
  LiveReceiver(const LiveReceiver&) = delete;
  LiveReceiver& operator=(const LiveReceiver&) = delete;

  [[nodiscard]] std::string path() const { return path_.string(); }
  [[nodiscard]] static Calendar calendar() { return Calendar(UtcTime{2026, 6, 1, 8, 0, 0, 0}); }
  /// Whether it wakes up and says something.
  [[nodiscard]] bool awake() const {
    return eventually([this] { return state().counters.epochs > 0; });
  }
  [[nodiscard]] State state() const {
    const std::lock_guard lock(mutex_);
    return state_;
  }

 private:
  class Line final : public emulators::ByteOutput {
   public:
    explicit Line(drivers::Pty& pty) : pty_(pty) {}
    void send(SimTime due, std::span<const std::uint8_t> bytes) override {
      waiting_.push_back({due, {bytes.begin(), bytes.end()}});
    }
    std::uint64_t write_due(SimTime now) {
      std::uint64_t refused = 0;
      for (; !waiting_.empty() && waiting_.front().first <= now; waiting_.pop_front()) {
        const auto& bytes = waiting_.front().second;
        refused += bytes.size() - pty_.write(bytes);
      }
      return refused;
    }

   private:
    drivers::Pty& pty_;
    std::deque<std::pair<SimTime, std::vector<std::uint8_t>>> waiting_;
  };

  void live(const emulators::UbloxSettings& settings, const Sky& sky) {
    boost::asio::io_context context;
    drivers::Pty pty(context, path_);
    // A real serial port is open to its group, too: gpsd gives up root once it has opened its
    // device, and could not open the next one.
    using std::filesystem::perms;
    std::filesystem::permissions(
        pty.slave_name(),
        perms::all & ~(perms::owner_exec | perms::group_exec | perms::others_exec));
    std::filesystem::permissions(path_.parent_path(),
                                 perms::owner_all | perms::group_exec | perms::others_exec,
                                 std::filesystem::perm_options::add);
    Line line(pty);
    emulators::UbloxReceiver receiver(settings, calendar(), line);
    const auto begin = std::chrono::steady_clock::now();
    const auto now = [begin] {
      return kStart +
             std::chrono::duration_cast<Duration>(std::chrono::steady_clock::now() - begin);
    };
    pty.start([&](std::span<const std::uint8_t> bytes) { receiver.receive(now(), bytes); });
    emulators::SerialClient client;
    SimTime sampled = kStart;
    ready_ = true;
    while (!stop_) {
      const SimTime instant = now();
      const emulators::SerialClient seen{pty.status().client_present, pty.client_baud()};
      if (seen != client) {
        client = seen;
        receiver.set_client(instant, client);
      }
      for (SimTime due = receiver.sample_plan().next_after(sampled); due <= instant;
           due = receiver.sample_plan().next_after(sampled)) {
        receiver.advance(due);
        receiver.update(sky(due));
        sampled = due;
      }
      receiver.advance(instant);
      const std::uint64_t refused = line.write_due(instant);
      context.poll();
      context.restart();
      {
        const std::lock_guard lock(mutex_);
        state_.time = instant;
        state_.counters = receiver.counters();
        state_.received = receiver.received();
        state_.baud = receiver.baud();
        state_.client_present = client.present;
        state_.bytes_refused += refused;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds{1});
    }
  }

  std::filesystem::path path_;
  std::atomic<bool> ready_{false};
  std::atomic<bool> stop_{false};
  mutable std::mutex mutex_;
  State state_;
  std::thread thread_;
};

}  // namespace rigwire::test
