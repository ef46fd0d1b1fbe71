// One emulated inertial measurement unit on a real kernel's CAN, for the cases of tests/kernel: the
// OpenIMU335RI emulator behind the bus model, in real time, on a SocketCAN interface or on a
// serial-line adapter (slcan) at the end of a pty.
//
//   kernel_can_peer socketcan:INTERFACE|slcan:LINK [SERIAL [SECONDS [imu|encoder|mti]]]
//
// The unit stands still, nose up by 5 degrees. In its place `encoder` is a CANopen encoder of
// node-ID 0x20 that stands at a quarter turn, `mti` an Xsens MTi-600. Ends after SECONDS (600) or
// on SIGTERM, then prints what it sent and received. Every SIGUSR1 makes the client's controller
// say that it is worse off: no acknowledgement, warning, passive, bus-off, and then well again.
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
#include <memory>
#include <numbers>
#include <stdexcept>
#include <string>

#include "drivers/pty.h"
#include "drivers/slcan_adapter.h"
#include "drivers/socketcan.h"
#include "drivers/terminal.h"
#include "emulators/can/can_bus.h"
#include "emulators/canopen/rotary_encoder.h"
#include "emulators/openimu/openimu335ri.h"
#include "emulators/xsens/mti_600.h"
#include "fields/constants.h"

namespace {

using namespace rigwire;
using WallClock = std::chrono::steady_clock;

constexpr double kNoseUp_rad = 5.0 * std::numbers::pi / 180.0;
constexpr auto kStep = std::chrono::milliseconds{1};

/// The bus model's outside: frames go to the kernel as they end on the modelled bus, and so does
/// what the client's controller has to say.
class ToKernel final : public emulators::FrameOutput, public emulators::CanOutside {
 public:
  explicit ToKernel(drivers::CanBus& wire) : wire_(wire) {}
  void send(SimTime due, const protocols::can::Frame& frame) override {
    if (wire_.deliver(frame, due - kStart)) {
      ++sent;
    } else {
      ++refused;
    }
  }
  void confirm(SimTime now, bool went_out) override { wire_.confirm(went_out, now - kStart); }
  void report(SimTime now, const protocols::can::ControllerReport& report) override {
    wire_.report(report, now - kStart);
  }
  void worsen(SimTime now) {
    using protocols::can::ErrorState;
    protocols::can::ControllerReport news;
    if (step_ == 0) {
      news.error = protocols::can::BusError::acknowledgement;
      news.transmitting = true;
    } else {
      constexpr std::array kStates{ErrorState::warning, ErrorState::passive, ErrorState::bus_off,
                                   ErrorState::active};
      constexpr std::array<std::uint16_t, 4> kTransmitErrors{96, 128, 256, 0};
      news.state = kStates[step_ - 1];
      news.state_changed = true;
      news.transmit_errors = kTransmitErrors[step_ - 1];
      news.restarted = news.state == ErrorState::active;
    }
    step_ = (step_ + 1) % 5;
    report(now, news);
  }
  unsigned long sent = 0;
  unsigned long refused = 0;

 private:
  drivers::CanBus& wire_;
  std::size_t step_ = 0;
};

struct Wire {
  std::unique_ptr<drivers::ByteStream> line;  ///< Below the adapter; null for SocketCAN.
  std::unique_ptr<drivers::CanBus> bus;
};

Wire open_wire(boost::asio::io_context& io, const std::string& address) {
  const std::string name = address.substr(address.find(':') + 1);
  Wire wire;
  if (address.starts_with("socketcan:")) {
    wire.bus = std::make_unique<drivers::SocketCanBus>(io, name);
  } else if (address.starts_with("slcan:")) {
    auto pty = std::make_unique<drivers::Pty>(io, name);
    drivers::SlcanAdapterSettings settings;
    settings.kernel_attached = [line = pty.get()] {
      return drivers::slcan_attached(line->slave_name());
    };
    wire.bus = std::make_unique<drivers::SlcanAdapter>(*pty, std::move(settings));
    wire.line = std::move(pty);
  } else {
    throw std::invalid_argument("address '" + address + "': socketcan:NAME or slcan:LINK expected");
  }
  return wire;
}

/// The device under test with its one constant sample.
class Unit {
 public:
  virtual ~Unit() = default;
  [[nodiscard]] virtual emulators::CanDevice& device() = 0;
  virtual void sample(SimTime time) = 0;
  virtual void print_identity() {}
};

ImuSample nose_up(SimTime time) {
  ImuSample sample;
  sample.time = time;
  sample.specific_force_mps2 = {kGravity_mps2 * std::sin(kNoseUp_rad), 0.0,
                                kGravity_mps2 * std::cos(kNoseUp_rad)};
  return sample;
}

class ImuUnit final : public Unit {
 public:
  ImuUnit(std::uint32_t serial, emulators::FrameOutput& output) : imu_(settings(serial), output) {}
  emulators::CanDevice& device() override { return imu_; }
  void sample(SimTime time) override { imu_.update(nose_up(time)); }
  void print_identity() override {
    std::printf("address %02X name %016llX ", static_cast<unsigned>(imu_.address()),
                static_cast<unsigned long long>(imu_.name()));
  }

 private:
  static emulators::OpenImuSettings settings(std::uint32_t serial) {
    emulators::OpenImuSettings settings;
    settings.serial = serial;
    return settings;
  }
  emulators::OpenImu imu_;
};

class EncoderUnit final : public Unit {
 public:
  explicit EncoderUnit(emulators::FrameOutput& output) : encoder_(settings(), memory_, output) {}
  emulators::CanDevice& device() override { return encoder_; }
  void sample(SimTime time) override { encoder_.update({time, 0.5 * std::numbers::pi, 0.0}); }

 private:
  static emulators::RotaryEncoderSettings settings() {
    emulators::RotaryEncoderSettings settings;
    settings.node.node_id = 0x20;
    settings.counter_clockwise = true;
    return settings;
  }
  emulators::VolatileMemory memory_;
  emulators::RotaryEncoder encoder_;
};

class MtiUnit final : public Unit {
 public:
  explicit MtiUnit(emulators::FrameOutput& output) : mti_({}, calendar_, output) {}
  emulators::CanDevice& device() override { return mti_; }
  void sample(SimTime time) override { mti_.update(nose_up(time)); }

 private:
  Calendar calendar_{UtcTime{2026, 6, 1, 8, 0, 0, 0}};
  emulators::Mti600 mti_;
};

std::unique_ptr<Unit> make_unit(const std::string& kind, std::uint32_t serial,
                                emulators::FrameOutput& output) {
  if (kind == "imu") {
    return std::make_unique<ImuUnit>(serial, output);
  }
  if (kind == "encoder") {
    return std::make_unique<EncoderUnit>(output);
  }
  if (kind == "mti") {
    return std::make_unique<MtiUnit>(output);
  }
  throw std::invalid_argument("unit '" + kind + "': imu, encoder or mti expected");
}

void run(const std::string& address, std::uint32_t serial, std::chrono::seconds limit,
         const std::string& kind) {
  boost::asio::io_context io;
  Wire wire = open_wire(io, address);
  ToKernel outside(*wire.bus);
  emulators::CanBusModel bus({});
  bus.set_outside(outside);
  emulators::FrameOutput& node = bus.add_node(outside);
  // A rig's bus has this node, too: without it, equal frames of this unit and of another one
  // collide forever.
  (void)bus.add_node(outside, {.name = "acknowledger"});
  const std::unique_ptr<Unit> unit = make_unit(kind, serial, node);
  emulators::CanDevice& device = unit->device();
  bus.attach(node, device);

  const auto start = WallClock::now();
  const auto now = [start] { return kStart + Duration{WallClock::now() - start}; };
  wire.bus->start([&](const protocols::can::Frame& frame) {
    std::printf("heard %08X#", static_cast<unsigned>(frame.id));
    for (const auto byte : frame.payload()) {
      std::printf("%02X", static_cast<unsigned>(byte));
    }
    std::printf("\n");
    bus.receive(std::max(now(), kStart), frame);
  });

  boost::asio::signal_set worsening(io, SIGUSR1);
  std::function<void()> wait_to_worsen = [&] {
    worsening.async_wait([&](const boost::system::error_code& error, int) {
      if (!error) {
        outside.worsen(now());
        wait_to_worsen();
      }
    });
  };
  wait_to_worsen();

  bool stop = false;
  boost::asio::signal_set signals(io, SIGTERM, SIGINT);
  signals.async_wait([&](const boost::system::error_code&, int) { stop = true; });

  SimTime next_sample = device.sample_plan().first;
  boost::asio::steady_timer timer(io);
  for (auto deadline = start; !stop && deadline < start + limit; deadline += kStep) {
    timer.expires_at(deadline);
    bool due = false;
    timer.async_wait([&](const boost::system::error_code&) { due = true; });
    while (!due && !stop) {
      io.run_one();
    }
    // Events in order of time, none later than now.
    for (const SimTime until = now();;) {
      const SimTime next = std::min({next_sample, device.next_event(), bus.next_event()});
      if (next > until) {
        break;
      }
      if (next == next_sample) {
        unit->sample(next);
        next_sample = device.sample_plan().next_after(next);
      } else if (next == device.next_event()) {
        device.advance(next);
      } else {
        bus.advance(next);
      }
    }
    std::fflush(stdout);
  }
  unit->print_identity();
  const emulators::ReceiveCounters received = device.received();
  std::printf("sent %lu refused %lu accepted %llu ignored %llu bad %llu\n", outside.sent,
              outside.refused, static_cast<unsigned long long>(received.accepted),
              static_cast<unsigned long long>(received.ignored),
              static_cast<unsigned long long>(received.malformed));
}

}  // namespace

int main(int argument_count, char** arguments) {
  if (argument_count < 2 || argument_count > 5) {
    std::fprintf(stderr,
                 "usage: %s socketcan:INTERFACE|slcan:LINK [SERIAL [SECONDS [imu|encoder|mti]]]\n",
                 arguments[0]);
    return 2;
  }
  try {
    const auto number = [&](int index, long fallback) {
      return argument_count > index ? std::strtol(arguments[index], nullptr, 0) : fallback;
    };
    run(arguments[1], static_cast<std::uint32_t>(number(2, 0x12345)),
        std::chrono::seconds{number(3, 600)}, argument_count > 4 ? arguments[4] : "imu");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "kernel_can_peer: %s\n", error.what());
    return 1;
  }
  return 0;
}
