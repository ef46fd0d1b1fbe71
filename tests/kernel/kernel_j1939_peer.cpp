// A vehicle gateway on a real kernel's CAN, for the cases of tests/kernel that have the kernel's
// own J1939 as its partner: the emulator in real time on a raw socket of a SocketCAN interface.
//
//   kernel_j1939_peer INTERFACE [ADDRESS [SERIAL [SECONDS]]]
//
// The machine stands with its engine at idle. Ends after SECONDS (600) or on SIGTERM, then prints
// what it sent and received.
#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <stdexcept>
#include <string>

#include "emulators/vehicle_gateway/vehicle_gateway.h"

namespace {

using namespace rigwire;
using WallClock = std::chrono::steady_clock;

volatile std::sig_atomic_t stopped = 0;

class KernelBus final : public emulators::FrameOutput {
 public:
  explicit KernelBus(const std::string& interface) : socket_(::socket(PF_CAN, SOCK_RAW, CAN_RAW)) {
    sockaddr_can address{};
    address.can_family = AF_CAN;
    address.can_ifindex = static_cast<int>(if_nametoindex(interface.c_str()));
    if (socket_ < 0 || address.can_ifindex == 0 ||
        ::bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
      throw std::runtime_error(interface + ": " + std::strerror(errno));
    }
  }
  ~KernelBus() override { ::close(socket_); }
  KernelBus(const KernelBus&) = delete;
  KernelBus& operator=(const KernelBus&) = delete;

  void send(SimTime /*due*/, const protocols::can::Frame& frame) override {
    can_frame raw{};
    raw.can_id = frame.id | (frame.extended ? CAN_EFF_FLAG : 0U);
    raw.can_dlc = frame.length;
    std::copy(frame.data.begin(), frame.data.end(), raw.data);
    sent += ::write(socket_, &raw, sizeof raw) == static_cast<ssize_t>(sizeof raw) ? 1U : 0U;
  }
  /// Waits for a frame for at most a millisecond.
  bool receive(protocols::can::Frame& frame) {
    constexpr int kWait_ms = 1;
    pollfd ready{socket_, POLLIN, 0};
    can_frame raw{};
    if (::poll(&ready, 1, kWait_ms) != 1 ||
        ::read(socket_, &raw, sizeof raw) != static_cast<ssize_t>(sizeof raw)) {
      return false;
    }
    frame = {};
    frame.extended = (raw.can_id & CAN_EFF_FLAG) != 0;
    frame.remote = (raw.can_id & CAN_RTR_FLAG) != 0;
    frame.id = raw.can_id & (frame.extended ? CAN_EFF_MASK : CAN_SFF_MASK);
    frame.length = raw.can_dlc;
    std::copy_n(raw.data, frame.data.size(), frame.data.begin());
    return true;
  }
  unsigned long sent = 0;

 private:
  int socket_;
};

void run(const std::string& interface, std::uint8_t address, std::uint32_t serial,
         std::chrono::seconds limit) {
  KernelBus bus(interface);
  emulators::VehicleGatewaySettings settings;
  settings.source_address = address;
  settings.serial = serial;
  emulators::VehicleGateway gateway(settings, bus);
  VehicleSample sample;
  sample.engine.speed_radps = 800.0 * protocols::vehicle::kRevolutionPerMinute_radps;
  SimTime next_sample = gateway.sample_plan().first;
  const auto start = WallClock::now();
  while (stopped == 0 && WallClock::now() < start + limit) {
    protocols::can::Frame frame;
    const bool heard = bus.receive(frame);
    const SimTime now = kStart + Duration{WallClock::now() - start};
    for (; next_sample <= now; next_sample = gateway.sample_plan().next_after(next_sample)) {
      sample.time = next_sample;
      gateway.update(sample);
    }
    gateway.advance(now);
    if (heard) {
      gateway.receive(now, frame);
    }
  }
  const auto counters = gateway.received();
  std::printf("address %02X sent %lu accepted %llu ignored %llu bad %llu\n",
              static_cast<unsigned>(gateway.address()), bus.sent,
              static_cast<unsigned long long>(counters.accepted),
              static_cast<unsigned long long>(counters.ignored),
              static_cast<unsigned long long>(counters.malformed));
}

}  // namespace

int main(int argument_count, char** arguments) {
  if (argument_count < 2 || argument_count > 5) {
    std::fprintf(stderr, "usage: %s INTERFACE [ADDRESS [SERIAL [SECONDS]]]\n", arguments[0]);
    return 2;
  }
  const auto stop = [](int) { stopped = 1; };
  std::signal(SIGTERM, stop);
  std::signal(SIGINT, stop);
  try {
    const auto number = [&](int index, long fallback) {
      return argument_count > index ? std::strtol(arguments[index], nullptr, 0) : fallback;
    };
    run(arguments[1], static_cast<std::uint8_t>(number(2, 0x27)),
        static_cast<std::uint32_t>(number(3, 0x12345)), std::chrono::seconds{number(4, 600)});
  } catch (const std::exception& error) {
    std::fprintf(stderr, "kernel_j1939_peer: %s\n", error.what());
    return 1;
  }
  return 0;
}
