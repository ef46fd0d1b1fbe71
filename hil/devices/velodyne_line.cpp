#include "hil/devices/velodyne_line.h"

#include <fmt/format.h>

#include <utility>

#include "drivers/http_server.h"
#include "drivers/udp_socket.h"
#include "emulators/velodyne/velodyne_lidar.h"
#include "emulators/velodyne/web_interface.h"
#include "hil/executive/station.h"
#include "hil/wires/outlets.h"

namespace rigwire::hil {
namespace {

/// How often the lidar's housing is looked at: about as often as it tells of it.
constexpr Duration kMotionPeriod = std::chrono::milliseconds(5);

/// Hands the motion of the housing to the lidar, whose own samples are its firings.
class MotionInput final : public emulators::Device, public emulators::ImuBackend {
 public:
  explicit MotionInput(emulators::VelodyneLidar& lidar) : lidar_(lidar) {}
  void advance(SimTime /*now*/) override {}
  [[nodiscard]] SimTime next_event() const override { return kNever; }
  [[nodiscard]] SamplePlan sample_plan() const override {
    return {kStart + kMotionPeriod, kMotionPeriod};
  }
  [[nodiscard]] emulators::ReceiveCounters received() const override { return {}; }
  [[nodiscard]] double nominal_rate_hz() const override { return 0.0; }
  [[nodiscard]] std::span<const emulators::Quantity> quantities() const override { return {}; }
  void update(const ImuSample& sample) override { lidar_.observe_motion(sample); }

 private:
  emulators::VelodyneLidar& lidar_;
};

/// The socket from which packets go to that port.
drivers::UdpSettings socket_settings(const VelodyneConfiguration& configuration,
                                     std::uint16_t port) {
  drivers::UdpSettings settings;
  settings.destination = drivers::UdpEndpoint{configuration.lidar.host_address, port};
  settings.broadcast = true;  // where it may go is checked against the rig's permission
  const std::string& source = configuration.source_address;
  const bool as_model = configuration.source_ports == SourcePorts::model;
  if (!source.empty() || as_model) {
    const std::uint16_t fixed = model_of(configuration).source_port;
    settings.bind = drivers::UdpEndpoint{source.empty() ? "0.0.0.0" : source,
                                         as_model ? fixed : std::uint16_t{0}};
    settings.source_port_follows = as_model && fixed == 0;
  }
  return settings;
}

class UdpLidarLine final : public LidarLine {
 public:
  UdpLidarLine(const VelodyneConfiguration& configuration, const LineContext& context)
      : UdpLidarLine(configuration, context, settings_of(configuration)) {}

  DeviceIndex enlist(Executive& executive) override {
    const DeviceIndex index = executive.add(station_);
    executive.add(data_outlet_);
    executive.add(position_outlet_);
    if (server_) {
      server_->start([this, &executive](const drivers::HttpRequest& request) {
        return answer(client_arrived(executive), request);
      });
    }
    return index;
  }

  std::optional<DeviceIndex> enlist_motion(Executive& executive) override {
    if (model_of(configuration_).position_layout != protocols::velodyne::PositionLayout::inertial) {
      return std::nullopt;
    }
    return executive.add(motion_station_);
  }

  [[nodiscard]] const emulators::LidarBackend& backend() const override { return lidar_; }
  void observe_fix(const GnssSample& sample) override { lidar_.observe_fix(sample); }
  [[nodiscard]] drivers::EndpointStatus endpoint() const override { return data_.status(); }
  [[nodiscard]] std::uint64_t dropped() const override {
    return statistics().dropped + lidar_.packets_lost();
  }
  [[nodiscard]] const emulators::Device& device() const override { return lidar_; }

 private:
  UdpLidarLine(const VelodyneConfiguration& configuration, const LineContext& context,
               emulators::VelodyneSettings settings)
      : configuration_(configuration),
        io_(context.io),
        data_(context.io, socket_settings(configuration, configuration.lidar.data_port)),
        position_(context.io, position_settings(configuration)),
        data_outlet_(data_, own_statistics()),
        position_outlet_(position_, own_statistics()),
        lidar_(seeded(std::move(settings), context), context.calendar, data_outlet_,
               position_outlet_),
        station_(lidar_, lidar_),
        web_(lidar_, {.silent_refusals = configuration.web.silent_refusals,
                      .objection = [this](const auto& live) { return objection(live); }}) {
    if (configuration.web.port != 0) {
      drivers::HttpServerSettings server;
      server.address = configuration.web.address;
      server.port = configuration.web.port;
      server.allow_remote = configuration.allow_remote;
      server_.emplace(context.io, server);
    }
  }

  static emulators::VelodyneSettings seeded(emulators::VelodyneSettings settings,
                                            const LineContext& context) {
    settings.fault_seed = context.device_seed;
    return settings;
  }

  static drivers::UdpSettings position_settings(const VelodyneConfiguration& configuration) {
    drivers::UdpSettings settings =
        socket_settings(configuration, configuration.lidar.telemetry_port);
    if (model_of(configuration).source_port != 0) {
      settings.bind.reset();  // the data packets have the port; this model sends no others
    }
    return settings;
  }

  /// Why packets cannot go where these settings want them; empty: they can.
  [[nodiscard]] std::string objection(const emulators::VelodyneLiveSettings& live) const {
    if (!permits(configuration_, live.host_address)) {
      return fmt::format("{} is outside this machine; the rig does not permit it (allow_remote)",
                         live.host_address);
    }
    try {
      drivers::UdpSettings trial;
      trial.destination = drivers::UdpEndpoint{live.host_address, live.data_port};
      trial.broadcast = true;
      if (!configuration_.source_address.empty()) {
        trial.bind = drivers::UdpEndpoint{configuration_.source_address, 0};
      }
      const drivers::UdpSocket socket(io_, trial);
    } catch (const drivers::EndpointError& refusal) {
      return refusal.what();
    }
    return {};
  }

  drivers::HttpResponse answer(SimTime now, const drivers::HttpRequest& request) {
    if (lidar_.starting_up(now)) {
      return {503, "text/plain", "the sensor starts up\n", {}, true};
    }
    emulators::WebResponse response =
        web_.answer(now, {request.method, request.target, request.body});
    if (std::exchange(destination_changes_, lidar_.destination_changes()) !=
        lidar_.destination_changes()) {
      follow_destination();
    }
    return {response.status, std::move(response.content_type), std::move(response.body),
            std::move(response.allow), response.close};
  }

  /// A port that turns out to be taken on our side leaves the packets where they went before.
  void follow_destination() {
    const auto data = lidar_.data_destination();
    const auto position = lidar_.position_destination();
    (void)data_.retarget({data.address, data.port});
    (void)position_.retarget({position.address, position.port});
  }

  const VelodyneConfiguration configuration_;
  boost::asio::io_context& io_;
  drivers::UdpSocket data_;
  drivers::UdpSocket position_;
  DatagramOutlet data_outlet_;
  DatagramOutlet position_outlet_;
  emulators::VelodyneLidar lidar_;
  LidarStation station_;
  MotionInput motion_{lidar_};
  ImuStation motion_station_{motion_, motion_};
  emulators::VelodyneWebInterface web_;
  std::uint32_t destination_changes_ = lidar_.destination_changes();
  std::optional<drivers::HttpServer> server_;
};

}  // namespace

std::unique_ptr<LidarLine> make_line(const VelodyneConfiguration& configuration,
                                     const LineContext& context) {
  return std::make_unique<UdpLidarLine>(configuration, context);
}

}  // namespace rigwire::hil
