#include "bench/rig_bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <stdexcept>
#include <thread>

#include "bench/private_rig.h"
#include "drivers/modbus_master.h"
#include "emulators/valve_driver/registers.h"
#include "hil/rig/rig.h"
#include "protocols/velodyne/data_packet.h"
#include "protocols/velodyne/position_packet.h"

namespace rigwire::bench {
namespace {

constexpr std::chrono::milliseconds kExchangePeriod{10};

void require_whole(const hil::RunOutcome& outcome) {
  if (outcome.fault) {
    throw std::runtime_error(
        fmt::format("the run ended at {:.3f} s: {}", to_seconds(outcome.reached), *outcome.fault));
  }
}

/// Exchanges registers with the valve driver as a controller does, until it is destroyed.
class FieldMaster {
 public:
  explicit FieldMaster(std::uint16_t port) : thread_([this, port] { exchange(port); }) {}
  ~FieldMaster() { stop(); }
  FieldMaster(const FieldMaster&) = delete;
  FieldMaster& operator=(const FieldMaster&) = delete;

  std::uint64_t stop() {
    stopped_ = true;
    if (thread_.joinable()) {
      thread_.join();
    }
    return exchanges_;
  }

 private:
  void exchange(std::uint16_t port) {
    namespace reg = emulators::valve_registers;
    drivers::ModbusMaster master({.port = port});
    constexpr std::array<std::uint16_t, 1> kEnable{reg::kControlEnable};
    std::array<std::uint16_t, reg::kCoilCurrent + kValveSections> answer{};
    auto deadline = std::chrono::steady_clock::now();
    while (!stopped_) {
      const bool answered =
          (master.connected() || master.connect()) &&
          master.read_write_registers(reg::kControl, kEnable, reg::kInputMirror, answer);
      exchanges_ += answered ? 1U : 0U;
      deadline += kExchangePeriod;
      std::this_thread::sleep_until(deadline);
    }
  }

  std::atomic<bool> stopped_{false};
  std::uint64_t exchanges_ = 0;  ///< Read after the thread has ended.
  std::thread thread_;
};

/// Laser shots in the data packets that the lidar has sent; its position packets count in the same
/// statistics.
double shots_sent(const std::vector<hil::DeviceReport>& devices) {
  namespace velodyne = protocols::velodyne;
  constexpr auto kData = static_cast<double>(velodyne::kDataPacketSize);
  constexpr auto kPosition = static_cast<double>(velodyne::kPositionPacketSize);
  double packets = 0.0;
  for (const hil::DeviceReport& device : devices) {
    if (device.name == "lidar") {
      packets = (static_cast<double>(device.statistics.bytes) -
                 kPosition * static_cast<double>(device.statistics.units)) /
                (kData - kPosition);
    }
  }
  return packets * static_cast<double>(velodyne::kBlocksPerPacket * velodyne::kChannelsPerBlock);
}

}  // namespace

FreeRun measure_free_run(Duration duration, int threads) {
  const PrivateRig own({fmt::format("devices.lidar.sensor.threads={}", threads)});
  boost::asio::io_context io;
  hil::Rig rig(own.configuration(), io, {});
  const double cpu_before_s = hil::process_cpu_seconds();
  const hil::RunOutcome outcome = rig.executive().run_free(kStart + duration);
  require_whole(outcome);
  FreeRun run;
  run.threads = threads;
  run.sim_s = to_seconds(outcome.reached);
  run.wall_s = outcome.wall_s;
  run.cpu_s = hil::process_cpu_seconds() - cpu_before_s;
  run.devices = rig.device_reports();
  run.realtime_factor = run.sim_s / run.wall_s;
  run.points_per_s = shots_sent(run.devices) / run.wall_s;
  run.truth = rig.truth().stages();
  run.wire = rig.executive().wire_stages();
  run.peak_rss_mb = hil::peak_resident_megabytes();
  return run;
}

bool same_bytes(const FreeRun& a, const FreeRun& b) {
  return std::ranges::equal(
      a.devices, b.devices, [](const hil::DeviceReport& x, const hil::DeviceReport& y) {
        return x.name == y.name && x.statistics.hash.value() == y.statistics.hash.value();
      });
}

PacedRun measure_paced_run(Duration duration) {
  const PrivateRig own;
  boost::asio::io_context io;
  hil::Rig rig(own.configuration(), io, {});
  hil::PacedSettings settings;
  settings.lead = own.configuration().lead;
  FieldMaster master(own.modbus_port());
  const double cpu_before_s = hil::process_cpu_seconds();
  PacedRun run;
  run.outcome = rig.executive().run_paced(settings, kStart + duration);
  require_whole(run.outcome);
  run.cpu_share = (hil::process_cpu_seconds() - cpu_before_s) / run.outcome.wall_s;
  run.exchanges = master.stop();
  run.exchange_period = kExchangePeriod;
  run.devices = rig.device_reports();
  return run;
}

}  // namespace rigwire::bench
