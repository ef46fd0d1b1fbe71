// A CAN bus behind an emulated gs_usb adapter, exported by USB/IP in real time, for the cases of
// tests/kernel: two OpenIMU335RI stand on the bus, nose up by 5 degrees, and the kernel that
// attaches the adapter is the third node.
//
//   kernel_gs_usb_peer PORT [SECONDS [BIT_RATE_BPS]]
//
// Serves 127.0.0.1:PORT. SIGUSR1 pulls the adapter out, or puts it back. Ends after SECONDS (600)
// or on SIGTERM, then prints what the bus and the adapter counted.
#include <algorithm>
#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <functional>
#include <numbers>

#include "drivers/tcp_server.h"
#include "emulators/can/can_bus.h"
#include "emulators/openimu/openimu335ri.h"
#include "emulators/usb/gs_usb.h"
#include "emulators/usb/usbip_server.h"
#include "fields/constants.h"
#include "to_clients.h"

namespace {

using namespace rigwire;
using WallClock = std::chrono::steady_clock;

constexpr double kNoseUp_rad = 5.0 * std::numbers::pi / 180.0;
constexpr auto kStep = std::chrono::milliseconds{1};

/// The adapter's controller is the bus model's outside node.
class OnTheBus final : public emulators::GsUsbWire, public emulators::CanOutside {
 public:
  explicit OnTheBus(emulators::CanBusModel& bus) : bus_(bus) {
    bus_.set_outside(*this);
    bus_.set_client(kStart, {.present = false, .restart_after = std::nullopt});
  }
  void connect(emulators::GsUsbAdapter& adapter) { adapter_ = &adapter; }
  void set_controller(SimTime now, const emulators::OutsideController& controller) override {
    bus_.set_client(now, controller);
  }
  void send(SimTime now, const protocols::can::Frame& frame) override { bus_.receive(now, frame); }
  void confirm(SimTime now, bool sent) override { adapter_->confirmed(now, sent); }
  void report(SimTime now, const protocols::can::ControllerReport& report) override {
    adapter_->reported(now, report);
  }

 private:
  emulators::CanBusModel& bus_;
  emulators::GsUsbAdapter* adapter_ = nullptr;
};

/// What the inertial units send reaches the adapter at its end of frame.
class ToAdapter final : public emulators::FrameOutput {
 public:
  void connect(emulators::GsUsbAdapter& adapter) { adapter_ = &adapter; }
  void send(SimTime due, const protocols::can::Frame& frame) override {
    adapter_->received(due, frame);
  }

 private:
  emulators::GsUsbAdapter* adapter_ = nullptr;
};

/// Two units at rest.
class Imus {
 public:
  Imus(emulators::CanBusModel& bus, emulators::FrameOutput& exit)
      : nodes_{bus.add_node(exit), bus.add_node(exit)},
        units_{emulators::OpenImu(settings(0x80, 0x12345), nodes_[0]),
               emulators::OpenImu(settings(0x81, 0x23456), nodes_[1])} {
    for (std::size_t i = 0; i < units_.size(); ++i) {
      bus.attach(nodes_[i], units_[i]);
      next_samples_[i] = units_[i].sample_plan().first;
    }
  }
  [[nodiscard]] SimTime next_event() const {
    SimTime next = kNever;
    for (std::size_t i = 0; i < units_.size(); ++i) {
      next = std::min({next, next_samples_[i], units_[i].next_event()});
    }
    return next;
  }
  void advance(SimTime now) {
    for (std::size_t i = 0; i < units_.size(); ++i) {
      if (next_samples_[i] <= now) {
        ImuSample sample;
        sample.time = next_samples_[i];
        sample.specific_force_mps2 = {kGravity_mps2 * std::sin(kNoseUp_rad), 0.0,
                                      kGravity_mps2 * std::cos(kNoseUp_rad)};
        units_[i].update(sample);
        next_samples_[i] = units_[i].sample_plan().next_after(next_samples_[i]);
      }
      units_[i].advance(now);
    }
  }

 private:
  static emulators::OpenImuSettings settings(std::uint8_t address, std::uint32_t serial) {
    emulators::OpenImuSettings settings;
    settings.source_address = address;
    settings.serial = serial;
    return settings;
  }
  std::array<std::reference_wrapper<emulators::FrameOutput>, 2> nodes_;
  std::array<emulators::OpenImu, 2> units_;
  std::array<SimTime, 2> next_samples_{};
};

void run(std::uint16_t port, std::chrono::seconds limit, std::uint32_t bit_rate_bps) {
  boost::asio::io_context io;
  emulators::CanBusModel bus({.bit_rate_bps = bit_rate_bps});
  OnTheBus controller(bus);
  ToAdapter to_adapter;
  Imus imus(bus, to_adapter);
  emulators::GsUsbAdapter adapter({.memory_frames = 1024}, controller);
  controller.connect(adapter);
  to_adapter.connect(adapter);

  drivers::TcpServer tcp(io, {.port = port, .backlog_bytes = 1U << 20U});
  ToClients to_clients(tcp);
  emulators::UsbipServer server({}, to_clients);
  const auto usb_port = server.add(adapter, "can0");

  const auto start = WallClock::now();
  const auto now = [start] { return kStart + Duration{WallClock::now() - start}; };
  // Everything up to now is done before something new comes in.
  const auto live = [&](SimTime until) {
    for (;;) {
      const SimTime next = std::min({imus.next_event(), bus.next_event(), server.next_event()});
      if (next > until) {
        return;
      }
      imus.advance(next);
      bus.advance(next);
      server.advance(next);
    }
  };
  tcp.start({.connected =
                 [&](auto connection) {
                   live(now());
                   server.connected(now(), connection);
                 },
             .received =
                 [&](auto connection, auto bytes) {
                   const SimTime instant = now();
                   live(instant);
                   server.receive(instant, connection, bytes);
                 },
             .disconnected =
                 [&](auto connection) {
                   live(now());
                   server.disconnected(now(), connection);
                 }});

  bool stop = false;
  boost::asio::signal_set end(io, SIGTERM, SIGINT);
  end.async_wait([&](const boost::system::error_code&, int) { stop = true; });
  boost::asio::signal_set pull(io, SIGUSR1);
  std::function<void()> watch = [&] {
    pull.async_wait([&](const boost::system::error_code& error, int) {
      if (error) {
        return;
      }
      const bool plugged = server.plugged(usb_port);
      std::printf("%s\n", plugged ? "unplugged" : "plugged");
      std::fflush(stdout);
      plugged ? server.unplug(now(), usb_port) : server.plug(now(), usb_port);
      watch();
    });
  };
  watch();
  std::printf("serving %s on tcp 127.0.0.1:%u\n", server.bus_id(usb_port).c_str(),
              static_cast<unsigned>(tcp.port()));
  std::fflush(stdout);

  boost::asio::steady_timer timer(io);
  while (!stop && WallClock::now() < start + limit) {
    // Until the next event, and not longer than a step.
    const auto next = std::min(start + (imus.next_event() - kStart), WallClock::now() + kStep);
    const auto next_on_bus = std::min(bus.next_event(), server.next_event());
    timer.expires_at(next_on_bus == kNever ? next : std::min(next, start + (next_on_bus - kStart)));
    bool due = false;
    timer.async_wait([&](const boost::system::error_code&) { due = true; });
    while (!due && !stop) {
      io.run_one();
    }
    live(now());
  }
  const auto& counted = adapter.counters();
  const auto number = [](std::uint64_t value) { return static_cast<unsigned long long>(value); };
  std::printf(
      "bus frames %llu load %.3f from_host %llu echoed %llu abandoned %llu to_host %llu lost %llu "
      "error_frames %llu restarts %llu refused %llu malformed %llu unsent %llu\n",
      number(bus.frames()), bus.load(now()), number(counted.from_host), number(counted.echoed),
      number(counted.abandoned), number(counted.to_host), number(counted.lost),
      number(counted.error_frames), number(counted.restarts), number(counted.refused_requests),
      number(counted.malformed_frames), number(counted.unsent));
}

}  // namespace

int main(int argument_count, char** arguments) {
  if (argument_count < 2 || argument_count > 4) {
    std::fprintf(stderr, "usage: %s PORT [SECONDS [BIT_RATE_BPS]]\n", arguments[0]);
    return 2;
  }
  try {
    const auto number = [&](int index, long fallback) {
      return argument_count > index ? std::strtol(arguments[index], nullptr, 0) : fallback;
    };
    run(static_cast<std::uint16_t>(number(1, 3240)), std::chrono::seconds{number(2, 600)},
        static_cast<std::uint32_t>(number(3, 250'000)));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "kernel_gs_usb_peer: %s\n", error.what());
    return 1;
  }
  return 0;
}
