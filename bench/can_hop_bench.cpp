#include "bench/can_hop_bench.h"

#include <boost/asio/io_context.hpp>
#include <chrono>

#include "drivers/can_interface.h"
#include "drivers/pty.h"
#include "drivers/serial_port.h"
#include "drivers/slcan_adapter.h"
#include "drivers/slcan_client.h"
#include "drivers/socketcan.h"
#include "hil/executive/cpu_time.h"
#include "protocols/can/bits.h"

namespace rigwire::bench {
namespace {

using drivers::CanBus;
using protocols::can::Frame;
using WallClock = std::chrono::steady_clock;

constexpr std::uint32_t kCanHopBitRate_bps = 1'000'000;
/// Frames between two looks at the reader: fits a pty's buffer and a socket's.
constexpr std::size_t kBatch = 64;
/// For what never arrives.
constexpr auto kPatience = std::chrono::seconds(2);

/// The angular rate message of an OpenIMU335RI at rest.
constexpr Frame kFrame{0x0CF02A80, true, false, 8, {0x00, 0x7D, 0x00, 0x7D, 0x00, 0x7D, 0x3F, 0}};

/// Runs the handlers until `count` frames have arrived, or none does for kPatience.
void wait_for(boost::asio::io_context& io, const std::uint64_t& received, std::uint64_t count) {
  std::uint64_t seen = received;
  for (auto end = WallClock::now() + kPatience; received < count && WallClock::now() < end;) {
    io.restart();
    if (io.poll() == 0) {
      io.run_one_for(std::chrono::milliseconds(1));
    }
    if (received != seen) {
      seen = received;
      end = WallClock::now() + kPatience;
    }
  }
}

/// The reader counts into `cost.received`.
void measure(boost::asio::io_context& io, CanBus& device, std::size_t frames, CanHopCost& cost) {
  cost.wire_limit_per_second = kCanHopBitRate_bps / static_cast<double>(exact_bits(kFrame));
  double device_s = 0.0;
  const double cpu_begin_s = hil::thread_cpu_seconds();
  const auto begin = WallClock::now();
  for (std::size_t offered = 0; offered < frames;) {
    {
      const hil::StageTimer timer(device_s);
      for (std::size_t i = 0; i < kBatch && offered < frames; ++i, ++offered) {
        cost.sent += device.deliver(kFrame, std::chrono::microseconds(offered)) ? 1 : 0;
      }
    }
    wait_for(io, cost.received, cost.sent);
  }
  const std::chrono::duration<double> wall = WallClock::now() - begin;
  const auto count = static_cast<double>(frames);
  cost.device_ns = 1e9 * device_s / count;
  cost.both_ns = 1e9 * (hil::thread_cpu_seconds() - cpu_begin_s) / count;
  cost.per_second = static_cast<double>(cost.received) / wall.count();
}

CanHopCost measure_slcan(std::size_t frames) {
  CanHopCost cost;
  cost.hop = "slcan on a pty";
  boost::asio::io_context io;
  drivers::Pty pty(io, {});
  drivers::SlcanAdapter adapter(pty, kCanHopBitRate_bps);
  bool open = false;
  adapter.on_client([&open](const drivers::CanClient& client) { open = client.open; });
  adapter.start([](const Frame&) {});
  drivers::SerialPort port(io, {.path = pty.slave_name(), .baud = 115200});
  drivers::SlcanClient client(port, kCanHopBitRate_bps);
  client.start([&cost](const Frame&) { ++cost.received; });
  for (const auto end = WallClock::now() + kPatience; !open && WallClock::now() < end;) {
    io.restart();
    io.run_one_for(std::chrono::milliseconds(1));
  }
  measure(io, adapter, frames, cost);
  return cost;
}

CanHopCost measure_socketcan(const std::string& interface, std::size_t frames) {
  CanHopCost cost;
  cost.hop = interface;
  boost::asio::io_context io;
  drivers::SocketCanBus device(io, interface);
  drivers::SocketCanBus client(io, interface);
  client.start([&cost](const Frame&) { ++cost.received; });
  measure(io, device, frames, cost);
  return cost;
}

}  // namespace

std::vector<CanHopCost> measure_can_hops(std::size_t frames) {
  std::vector<CanHopCost> costs{measure_slcan(frames)};
  const auto vcan = drivers::find_can_interface("vcan0");
  if (vcan && vcan->up && vcan->is_virtual()) {
    costs.push_back(measure_socketcan("vcan0", frames));
  }
  return costs;
}

}  // namespace rigwire::bench
