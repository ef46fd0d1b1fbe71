// The host side of USB on a real kernel, for the cases of tests/kernel.
//
//   kernel_usb_host list
//   kernel_usb_host read DEVICE            DEVICE as in drivers/usb_host.h, a gs_usb adapter:
//                                          takes it from the kernel's driver, reads its
//                                          configuration, receives 50 frames from a bus of 250
//                                          kbit/s and sends one, and gives it back
//   kernel_usb_host serve DEVICE PORT      passes the device on by USB/IP, until SIGTERM
#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "drivers/tcp_server.h"
#include "drivers/usb_host.h"
#include "emulators/usb/usbip_server.h"
#include "hil/wires/usb_passthrough.h"
#include "protocols/gs_usb/host_frame.h"
#include "protocols/gs_usb/requests.h"

namespace {

using namespace rigwire;
namespace gs_usb = protocols::gs_usb;
using drivers::UsbDeviceHandle;
using protocols::usb::Outcome;
using protocols::usb::Setup;
using Bytes = std::vector<std::uint8_t>;
using WallClock = std::chrono::steady_clock;

constexpr std::uint8_t kToDevice = 0x41;  // vendor, interface
constexpr std::uint8_t kToHost = 0xC1;

void list() {
  for (const auto& device : drivers::list_usb_devices()) {
    std::printf("%s %04x:%04x %s / %s / %s %s\n", device.place.c_str(), unsigned{device.vendor},
                unsigned{device.product}, device.manufacturer.c_str(), device.product_name.c_str(),
                device.serial_number.c_str(), device.permitted ? "permitted" : "not permitted");
  }
}

/// Runs the loop until `condition` holds; throws when it takes longer than 20 s.
void run_until(boost::asio::io_context& io, const char* what,
               const std::function<bool()>& condition) {
  const auto limit = WallClock::now() + std::chrono::seconds{20};
  while (!condition()) {
    io.restart();
    io.run_one_for(std::chrono::milliseconds{100});
    if (WallClock::now() > limit) {
      throw std::runtime_error(std::string("waited in vain for ") + what);
    }
  }
}

Bytes request(boost::asio::io_context& io, UsbDeviceHandle& device, std::uint8_t type,
              gs_usb::Request number, std::span<const std::uint8_t> data, std::size_t length) {
  bool ended = false;
  Outcome outcome = Outcome::gone;
  Bytes answer;
  const Setup setup{type, static_cast<std::uint8_t>(number), 0, 0,
                    static_cast<std::uint16_t>(length)};
  device.control(setup, data, [&](const UsbDeviceHandle::Result& result) {
    outcome = result.outcome;
    answer.assign(result.data.begin(), result.data.end());
    ended = true;
  });
  run_until(io, "a control transfer", [&] { return ended; });
  if (outcome != Outcome::done) {
    throw std::runtime_error("request " + std::to_string(setup.request) + " was refused");
  }
  return answer;
}

template <class Structure>
void tell(boost::asio::io_context& io, UsbDeviceHandle& device, gs_usb::Request number,
          const Structure& structure) {
  const auto bytes = gs_usb::encode(structure);
  request(io, device, kToDevice, number, bytes, bytes.size());
}
template <class Structure>
Structure ask(boost::asio::io_context& io, UsbDeviceHandle& device, gs_usb::Request number) {
  const Bytes bytes = request(io, device, kToHost, number, {}, gs_usb::kBytes<Structure>);
  const auto structure = gs_usb::decode<Structure>(bytes);
  if (!structure.ok()) {
    throw std::runtime_error("an answer is too short");
  }
  return *structure;
}

void read(const std::string& name) {
  boost::asio::io_context io;
  drivers::UsbHost host(io);
  const auto device = host.open(drivers::parse_usb_selector(name));
  std::printf("opened %s: %s\n", device->address().c_str(),
              device->description().product_name.c_str());
  device->claim(0);
  tell(io, *device, gs_usb::Request::host_format, gs_usb::HostFormat{});
  const auto configuration =
      ask<gs_usb::DeviceConfiguration>(io, *device, gs_usb::Request::device_configuration);
  std::printf("channels %u software %u hardware %u\n", configuration.channels(),
              configuration.software_version, configuration.hardware_version);
  const auto limits = ask<gs_usb::BitTimingLimits>(io, *device, gs_usb::Request::bit_timing_limits);
  std::printf("clock %u features %05x\n", limits.clock_hz, limits.features);

  // Data transfers as the kernel's driver does them: thirty reads wait.
  unsigned received = 0;
  bool echoed = false;
  std::function<void(const UsbDeviceHandle::Result&)> on_frame =
      [&](const UsbDeviceHandle::Result& result) {
        const auto frame = gs_usb::decode_frame(result.data, true);
        if (result.outcome != Outcome::done || !frame.ok()) {
          return;
        }
        received += frame->echo == gs_usb::kReceived ? 1U : 0U;
        echoed = echoed || frame->echo == 5;
        device->read(gs_usb::kEndpointToHost, 24, on_frame);
      };
  for (int i = 0; i < 30; ++i) {
    device->read(gs_usb::kEndpointToHost, 24, on_frame);
  }
  tell(io, *device, gs_usb::Request::bit_timing, gs_usb::BitTiming{6, 7, 2, 1, 12});
  tell(io, *device, gs_usb::Request::mode,
       gs_usb::Mode{gs_usb::Mode::kStart, gs_usb::Feature::kTimeStamp});
  run_until(io, "50 frames", [&] { return received >= 50; });
  gs_usb::HostFrame frame = gs_usb::from_can({0x18EA80F9, true, false, 3, {0x00, 0xEE, 0x00}});
  frame.echo = 5;
  device->write(gs_usb::kEndpointToDevice, gs_usb::encode_frame(frame).span(),
                [](const UsbDeviceHandle::Result&) {});
  run_until(io, "the echo", [&] { return echoed; });
  tell(io, *device, gs_usb::Request::mode, gs_usb::Mode{});
  std::printf("received %u frames and an echo\n", received);
  device->release(0);
}

/// Answers of the USB/IP server go to its clients at once.
class ToClients final : public emulators::StreamOutput {
 public:
  explicit ToClients(drivers::StreamServer& server) : server_(server) {}
  void send(emulators::ConnectionId connection, SimTime /*due*/,
            std::span<const std::uint8_t> bytes) override {
    server_.send(connection, bytes);
  }
  void close(emulators::ConnectionId connection, SimTime /*due*/) override {
    server_.close(connection);
  }

 private:
  drivers::StreamServer& server_;
};

void serve(const std::string& name, std::uint16_t port) {
  boost::asio::io_context io;
  drivers::UsbHost host(io);
  hil::UsbPassThrough device(host.open(drivers::parse_usb_selector(name)));
  drivers::TcpServer tcp(io, {.port = port, .backlog_bytes = 1U << 20U});
  ToClients to_clients(tcp);
  emulators::UsbipServer server({}, to_clients);
  const auto usb_port = server.add(device, "passed on");
  const auto start = WallClock::now();
  const auto now = [start] { return kStart + Duration{WallClock::now() - start}; };
  tcp.start(
      {.connected = [&](auto connection) { server.connected(now(), connection); },
       .received = [&](auto connection, auto bytes) { server.receive(now(), connection, bytes); },
       .disconnected = [&](auto connection) { server.disconnected(now(), connection); }});
  boost::asio::signal_set end(io, SIGTERM, SIGINT);
  end.async_wait([&](const boost::system::error_code&, int) { io.stop(); });
  std::printf("serving %s on tcp 127.0.0.1:%u\n", server.bus_id(usb_port).c_str(),
              unsigned{tcp.port()});
  std::fflush(stdout);
  io.run();
}

}  // namespace

int main(int argument_count, char** arguments) {
  const std::vector<std::string> words(arguments + 1, arguments + argument_count);
  try {
    if (words.size() == 1 && words[0] == "list") {
      list();
    } else if (words.size() == 2 && words[0] == "read") {
      read(words[1]);
    } else if (words.size() == 3 && words[0] == "serve") {
      serve(words[1], static_cast<std::uint16_t>(std::stoul(words[2])));
    } else {
      std::fprintf(stderr, "usage: %s list | read DEVICE | serve DEVICE PORT\n", arguments[0]);
      return 2;
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "kernel_usb_host: %s\n", error.what());
    return 1;
  }
  return 0;
}
