// A u-blox receiver and an operator's levers exported by USB/IP in real time, for the cases of
// tests/kernel.
//
//   kernel_usb_peer PORT [SECONDS]
//
// Serves 127.0.0.1:PORT; the receiver is 1-1, the joystick 1-2. The receiver drives north-east; the
// left stick sweeps its whole way right and left in four seconds, button 1 is down on the right
// half. Says on standard output how the host has set the serial line. SIGUSR1 pulls the receiver
// out, or puts it back. Ends after SECONDS (600) or on SIGTERM, then prints what went over the
// wire.
#include <algorithm>
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

#include "drivers/tcp_server.h"
#include "emulators/ublox/receiver.h"
#include "emulators/usb/cdc_acm.h"
#include "emulators/usb/hid_joystick.h"
#include "emulators/usb/usbip_server.h"
#include "to_clients.h"

namespace {

using namespace rigwire;
using WallClock = std::chrono::steady_clock;

constexpr auto kStep = std::chrono::milliseconds{5};
constexpr auto kLeverPeriod = std::chrono::milliseconds{20};
constexpr double kSweep_s = 4.0;

/// The receiver behind its USB socket.
class Receiver final : public emulators::CdcAcmDevice, public emulators::ByteOutput {
 public:
  Receiver() : receiver_(settings(), calendar_, *this) {
    next_sample_ = receiver_.sample_plan().first;
  }
  [[nodiscard]] emulators::CdcAcm& usb() { return usb_; }
  [[nodiscard]] const emulators::UbloxReceiver& receiver() const { return receiver_; }

  void received(SimTime now, std::span<const std::uint8_t> bytes) override {
    receiver_.receive(now, bytes);
  }
  void line_changed(SimTime now, const emulators::CdcAcmLine& line) override {
    std::printf("line present %d dtr %d rts %d %u %u%c%u\n", line.client_present,
                line.data_terminal_ready, line.request_to_send, line.coding.rate_bps,
                line.coding.data_bits, "NOEMS"[static_cast<unsigned>(line.coding.parity) % 5],
                line.coding.stop == protocols::usb::cdc::StopBits::one ? 1U : 2U);
    std::fflush(stdout);
    receiver_.set_client(now, {line.client_present, 0});
  }
  void send(SimTime due, std::span<const std::uint8_t> bytes) override {
    now_ = std::max(now_, due);
    usb_.send(now_, bytes);
  }

  [[nodiscard]] SimTime next_event() const {
    return std::min(next_sample_, receiver_.next_event());
  }
  void advance(SimTime now) {
    now_ = now;
    if (next_sample_ <= now) {
      receiver_.update(sample(next_sample_));
      next_sample_ = receiver_.sample_plan().next_after(next_sample_);
    }
    receiver_.advance(now);
  }

 private:
  static emulators::UbloxSettings settings() {
    emulators::UbloxSettings settings;
    settings.baud = 115200;
    return settings;
  }
  static GnssSample sample(SimTime time) {
    const double t = to_seconds(time);
    GnssSample sample;
    sample.time = time;
    sample.fix = GnssFix::three_d;
    sample.latitude_deg = 49.42 + 2e-5 * t;
    sample.longitude_deg = 7.75 + 3e-5 * t;
    sample.ellipsoid_height_m = 300.0;
    sample.geoid_separation_m = 48.0;
    sample.velocity_ned_mps = {2.226, 2.175, 0.0};
    sample.horizontal_accuracy_m = 2.5;
    sample.vertical_accuracy_m = 4.0;
    sample.horizontal_dilution = 1.0;
    sample.vertical_dilution = 1.9;
    sample.position_dilution = 1.8;
    sample.time_dilution = 0.9;
    for (std::uint8_t number = 1; number <= 9; ++number) {
      sample.satellites.push_back({number, 0.5 * number, 0.1 * number, 35.0 + number, true, true});
    }
    return sample;
  }

  Calendar calendar_{UtcTime{2026, 6, 1, 8, 0, 0, 0}};
  SimTime now_ = kStart;
  emulators::UbloxReceiver receiver_;
  emulators::CdcAcm usb_{emulators::ublox_usb(7), *this};
  SimTime next_sample_ = kNever;
};

/// Sweeps the left stick.
class Operator {
 public:
  explicit Operator(emulators::HidJoystick& levers) : levers_(levers) {}
  [[nodiscard]] SimTime next_event() const { return next_; }
  void advance(SimTime now) {
    if (next_ <= now) {
      JoystickSample sample;
      sample.time = next_;
      sample.axes[0] = std::sin(2.0 * 3.14159265358979 * to_seconds(next_) / kSweep_s);
      sample.buttons[0] = sample.axes[0] > 0.0;
      levers_.update(sample);
      next_ += kLeverPeriod;
    }
  }

 private:
  emulators::HidJoystick& levers_;
  SimTime next_ = kStart;
};

void run(std::uint16_t port, std::chrono::seconds limit) {
  boost::asio::io_context io;
  Receiver receiver;
  emulators::HidJoystick levers({});
  Operator hand(levers);
  drivers::TcpServerSettings settings;
  settings.port = port;
  settings.backlog_bytes = 1U << 20U;
  drivers::TcpServer tcp(io, settings);
  ToClients to_clients(tcp);
  emulators::UsbipServer server({}, to_clients);
  const auto gnss = server.add(receiver.usb(), "gnss");
  server.add(levers, "levers");

  const auto start = WallClock::now();
  const auto now = [start] { return kStart + Duration{WallClock::now() - start}; };
  /// Everything up to now is done before something new comes in.
  const auto live = [&](SimTime until) {
    for (;;) {
      const SimTime next =
          std::min({receiver.next_event(), hand.next_event(), server.next_event()});
      if (next > until) {
        return until;
      }
      receiver.advance(next);
      hand.advance(next);
      server.advance(next);
    }
  };
  tcp.start(
      {.connected = [&](auto connection) { server.connected(live(now()), connection); },
       .received = [&](auto connection,
                       auto bytes) { server.receive(live(now()), connection, bytes); },
       .disconnected = [&](auto connection) { server.disconnected(live(now()), connection); }});

  bool stop = false;
  boost::asio::signal_set end(io, SIGTERM, SIGINT);
  end.async_wait([&](const boost::system::error_code&, int) { stop = true; });
  boost::asio::signal_set pull(io, SIGUSR1);
  std::function<void()> watch = [&] {
    pull.async_wait([&](const boost::system::error_code& error, int) {
      if (!error) {
        const bool plugged = server.plugged(gnss);
        plugged ? server.unplug(live(now()), gnss) : server.plug(live(now()), gnss);
        std::printf("%s\n", plugged ? "unplugged" : "plugged");
        std::fflush(stdout);
        watch();
      }
    });
  };
  watch();
  std::printf("serving on 127.0.0.1:%u\n", static_cast<unsigned>(tcp.port()));
  std::fflush(stdout);

  boost::asio::steady_timer timer(io);
  for (auto deadline = start; !stop && deadline < start + limit; deadline += kStep) {
    timer.expires_at(deadline);
    bool due = false;
    timer.async_wait([&](const boost::system::error_code&) { due = true; });
    while (!due && !stop) {
      io.run_one();
    }
    live(now());
  }
  const auto counted = server.received();
  std::printf("sentences %llu lost_bytes %llu reports %llu accepted %llu ignored %llu bad %llu\n",
              static_cast<unsigned long long>(receiver.receiver().counters().messages_sent),
              static_cast<unsigned long long>(receiver.usb().lost_bytes()),
              static_cast<unsigned long long>(levers.reports_sent()),
              static_cast<unsigned long long>(counted.accepted),
              static_cast<unsigned long long>(counted.ignored),
              static_cast<unsigned long long>(counted.malformed));
}

}  // namespace

int main(int argument_count, char** arguments) {
  if (argument_count < 2 || argument_count > 3) {
    std::fprintf(stderr, "usage: %s PORT [SECONDS]\n", arguments[0]);
    return 2;
  }
  try {
    const long seconds = argument_count > 2 ? std::strtol(arguments[2], nullptr, 10) : 600;
    run(static_cast<std::uint16_t>(std::strtol(arguments[1], nullptr, 10)),
        std::chrono::seconds{seconds});
  } catch (const std::exception& error) {
    std::fprintf(stderr, "kernel_usb_peer: %s\n", error.what());
    return 1;
  }
  return 0;
}
