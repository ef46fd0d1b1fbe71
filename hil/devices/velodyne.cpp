#include "hil/devices/velodyne.h"

#include <fmt/format.h>

#include <array>
#include <boost/asio/ip/address_v4.hpp>
#include <boost/asio/ip/udp.hpp>
#include <optional>
#include <utility>

#include "drivers/http_server.h"
#include "drivers/udp_socket.h"
#include "emulators/device.h"
#include "emulators/velodyne/velodyne_lidar.h"
#include "emulators/velodyne/web_interface.h"
#include "fields/check.h"
#include "fields/visitor.h"
#include "hil/devices/device.h"
#include "hil/devices/rig_check.h"
#include "hil/devices/site.h"
#include "hil/executive/station.h"
#include "hil/files/lidar_calibration_file.h"
#include "hil/wires/outlets.h"
#include "hil/world/imu.h"
#include "hil/world/lidar.h"
#include "protocols/velodyne/data_packet.h"
#include "protocols/velodyne/packet_layout.h"
#include "sim/imu/imu_sensor.h"
#include "sim/lidar/velodyne_heads.h"

namespace rigwire::hil {

namespace velodyne = protocols::velodyne;
using fields::Choice;
using fields::IntegerRule;

namespace {

constexpr std::array<Choice<SourcePorts>, 3> kSourcePorts{
    {{SourcePorts::automatic, "auto", "The sensor's where possible, else the system chooses."},
     {SourcePorts::any, "any", "The system chooses them."},
     {SourcePorts::model, "model", "The sensor's: the destination's, or 443."}}};

using emulators::VelodyneTimeSource;

VelodyneTimeSource time_source_of(const VelodyneConfiguration& p) {
  if (p.time_source == VelodyneConfiguration::kAutomaticTimeSource ||
      p.time_source == VelodyneConfiguration::kIdealTimeSource) {
    return VelodyneTimeSource::ideal;
  }
  if (p.time_source == VelodyneConfiguration::kPulseTimeSource) {
    return VelodyneTimeSource::pulse_only;
  }
  if (p.time_source == VelodyneConfiguration::kNoTimeSource) {
    return VelodyneTimeSource::none;
  }
  return VelodyneTimeSource::receiver;
}

/// Without what needs a file.
emulators::VelodyneSettings settings_but_calibration(const VelodyneConfiguration& p) {
  emulators::VelodyneSettings settings = p.lidar;
  settings.time_source = time_source_of(p);
  settings.reference_range_m = p.sensor.beam.reference_range_m;
  settings.faults = those_of<emulators::VelodyneFault>(p.faults);
  settings.supply_faults = those_of<emulators::SupplyFault>(p.faults);
  return settings;
}

/// Whether it may send to `address`: loopback, or any with `allow_remote`.
bool permits(const VelodyneConfiguration& p, std::string_view address) {
  return p.allow_remote || address.starts_with("127.");
}

/// Sampling period of the housing's motion: about the period at which the lidar reports it.
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

/// Whether a program on this machine listens for what is sent there: the port is left to it.
bool is_here(boost::asio::io_context& io, const std::string& address) {
  boost::system::error_code error;
  const auto parsed = boost::asio::ip::make_address_v4(address, error);
  if (error || parsed.is_loopback() || parsed == boost::asio::ip::address_v4::broadcast()) {
    return true;
  }
  boost::asio::ip::udp::socket trial(io, boost::asio::ip::udp::v4());
  trial.bind({parsed, 0}, error);
  return !error;
}

/// The socket from which packets go to that port. `fixed`: the model's source port, 0 where it is
/// the destination's.
drivers::UdpSettings as_the_model(const VelodyneConfiguration& configuration, std::uint16_t port,
                                  std::uint16_t fixed) {
  drivers::UdpSettings settings;
  settings.destination = drivers::UdpEndpoint{configuration.lidar.saved.host_address, port};
  settings.broadcast = true;  // where it may go is checked against the rig's permission
  const std::string& source = configuration.source_address;
  settings.bind = drivers::UdpEndpoint{source.empty() ? "0.0.0.0" : source, fixed};
  settings.source_port_follows = fixed == 0;
  settings.shares_source = fixed != 0;
  return settings;
}

/// Returns `settings` with a source port that the system chooses.
drivers::UdpSettings from_any_port(const VelodyneConfiguration& configuration,
                                   drivers::UdpSettings settings) {
  settings.bind.reset();
  settings.source_port_follows = false;
  settings.shares_source = false;
  if (!configuration.source_address.empty()) {
    settings.bind = drivers::UdpEndpoint{configuration.source_address, 0};
  }
  return settings;
}

/// By the rig's choice of source ports. `remark` is what the user should know of it, else as it
/// was.
drivers::UdpSettings chosen_source(const VelodyneConfiguration& configuration,
                                   boost::asio::io_context& io, drivers::UdpSettings wanted,
                                   std::string* remark) {
  const auto because = [&](const std::string& why) {
    if (remark != nullptr) {
      const std::uint16_t port =
          wanted.source_port_follows ? wanted.destination->port : wanted.bind->port;
      *remark = fmt::format(
          "packets come from a port of the system's choice, not from {} as the {}'s: {}", port,
          configuration.lidar.model, why);
    }
    return from_any_port(configuration, wanted);
  };
  switch (configuration.source_ports) {
    case SourcePorts::any:
      return from_any_port(configuration, wanted);
    case SourcePorts::model:
      return wanted;
    case SourcePorts::automatic:
      break;
  }
  if (wanted.source_port_follows && is_here(io, wanted.destination->address)) {
    return because("a client on this machine listens there");
  }
  try {
    const drivers::UdpSocket trial(io, wanted);
  } catch (const drivers::EndpointError& refusal) {
    return because(refusal.what());
  }
  return wanted;
}

drivers::UdpSettings data_settings(const VelodyneConfiguration& configuration,
                                   boost::asio::io_context& io, std::string& remark) {
  const velodyne::Model& model = model_of(configuration);
  drivers::UdpSettings settings =
      as_the_model(configuration, configuration.lidar.saved.data_port, model.source_port);
  settings.time_to_live = model.headers.data_time_to_live;
  settings.dont_fragment = model.headers.data_unfragmented;
  return chosen_source(configuration, io, std::move(settings), &remark);
}

drivers::UdpSettings position_settings(const VelodyneConfiguration& configuration,
                                       boost::asio::io_context& io) {
  const velodyne::Model& model = model_of(configuration);
  drivers::UdpSettings settings =
      as_the_model(configuration, configuration.lidar.saved.telemetry_port, 0);
  settings.time_to_live = model.headers.position_time_to_live;
  if (model.position_layout == velodyne::PositionLayout::none) {
    return from_any_port(configuration, std::move(settings));  // sends nothing
  }
  return chosen_source(configuration, io, std::move(settings), nullptr);
}

/// Whether the receiver's beams can return more than one echo of surfaces.
bool tells_echoes_apart(const LidarSensorConfiguration& sensor) {
  return sensor.method == LidarMethod::rays && rays_per_beam(sensor.beam, true) > 1;
}

class VelodyneDevice final : public Device, private FixListener {
 public:
  VelodyneDevice(const VelodyneConfiguration& configuration, Site& site)
      : VelodyneDevice(configuration, site, settings_of(configuration)) {}

  [[nodiscard]] StationIndex enlist(Executive& executive) {
    const StationIndex index = executive.add(station_);
    executive.add(data_outlet_);
    executive.add(position_outlet_);
    if (server_) {
      server_->start_patiently([this, &executive](const drivers::HttpRequest& request,
                                                  const drivers::HttpServer::Respond& respond) {
        const SimTime now = client_arrived(executive);
        if (lidar_.supply().on()) {  // else it receives nothing
          last_request_ = {now, request.method + " " + request.target};
          respond(answer(now, request));
        }
      });
    }
    return index;
  }

  /// Adds the station that gives the lidar its motion, when the device reports it. To be called
  /// once, after enlist().
  [[nodiscard]] std::optional<StationIndex> enlist_motion(Executive& executive) {
    if (model_of(configuration_).position_layout != velodyne::PositionLayout::inertial) {
      return std::nullopt;
    }
    return executive.add(motion_station_);
  }

  void connect(const Neighbours& neighbours) override {
    const bool any = configuration_.time_source == VelodyneConfiguration::kAutomaticTimeSource;
    if (FixSource* source = neighbours.fixes_of(any ? "" : configuration_.time_source)) {
      source->inform(*this);
    }
  }

  [[nodiscard]] const emulators::VelodyneLidar& emulator() const override { return lidar_; }
  [[nodiscard]] bool is_lidar() const override { return true; }
  [[nodiscard]] std::string remark() const override { return remark_; }
  [[nodiscard]] drivers::EndpointStatus endpoint() const override { return data_.status(); }
  [[nodiscard]] std::string tell(SimTime now, const DeviceConfiguration& wanted,
                                 std::string_view key) override {
    if (!lidar_.supply().on()) {
      return "the sensor has no supply";
    }
    if (lidar_.starting_up(now)) {
      return "the sensor starts up";
    }
    emulators::VelodyneLiveSettings live = lidar_.live_settings();
    std::string why = hil::tell(emulators::velodyne_live_settings(model_of(configuration_)), key,
                                live, now, static_cast<const VelodyneConfiguration&>(wanted).lidar);
    why = why.empty() ? objection(live) : why;
    if (why.empty() && live != lidar_.live_settings()) {
      lidar_.apply(now, live);
      follow_destination();
    }
    return why;
  }
  /// Returns the last request to the web interface.
  [[nodiscard]] std::optional<ClientRequest> last_request() const override { return last_request_; }
  [[nodiscard]] std::uint64_t dropped() const override {
    return statistics().dropped + lidar_.packets_lost();
  }

 private:
  VelodyneDevice(const VelodyneConfiguration& configuration, Site& site,
                 emulators::VelodyneSettings settings)
      : configuration_(configuration),
        io_(site.io()),
        data_(site.io(), data_settings(configuration, site.io(), remark_)),
        position_(site.io(), position_settings(configuration, site.io())),
        data_outlet_(data_, own_statistics()),
        position_outlet_(position_, own_statistics()),
        lidar_(seeded(std::move(settings), site), site.calendar(), data_outlet_, position_outlet_),
        station_(lidar_, lidar_),
        web_(lidar_, {.silent_refusals = configuration.web.silent_refusals,
                      .objection = [this](const auto& live) { return objection(live); }}) {
    offer(make_fault_port(those_of<emulators::VelodyneFault>(configuration.faults),
                          acted_by<emulators::VelodyneFault>(lidar_)));
    offer(make_fault_port(those_of<emulators::SupplyFault>(configuration.faults),
                          acted_by<emulators::SupplyFault>(lidar_.supply())));
    if (configuration.web.port != 0) {
      drivers::HttpServerSettings server;
      server.address = configuration.web.address;
      server.port = configuration.web.port;
      server.allow_remote = configuration.allow_remote;
      server_.emplace(site.io(), server);
    }
  }

  void observe_fix(const GnssSample& sample) override { lidar_.observe_fix(sample); }

  static emulators::VelodyneSettings seeded(emulators::VelodyneSettings settings,
                                            const Site& site) {
    settings.seed = site.device_seed();
    return settings;
  }

  /// Why these settings cannot be had here; empty: they can.
  [[nodiscard]] std::string objection(const emulators::VelodyneLiveSettings& live) const {
    if (live.return_mode != velodyne::ReturnMode::strongest &&
        !tells_echoes_apart(configuration_.sensor)) {
      return "the rig's beams have no width and return one echo (sensor.sub_rays, sensor.method)";
    }
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
    follow_destination();
    return {response.status, std::move(response.content_type), std::move(response.body),
            std::move(response.allow), response.close};
  }

  /// A port that turns out to be taken on our side leaves the packets where they went before.
  void follow_destination() {
    if (std::exchange(destination_changes_, lidar_.destination_changes()) ==
        lidar_.destination_changes()) {
      return;
    }
    const auto data = lidar_.data_destination();
    const auto position = lidar_.position_destination();
    (void)data_.retarget({data.address, data.port});
    (void)position_.retarget({position.address, position.port});
  }

  const VelodyneConfiguration configuration_;
  boost::asio::io_context& io_;
  std::string remark_;  ///< Filled while data_ is made.
  drivers::UdpSocket data_;
  drivers::UdpSocket position_;
  DatagramOutlet data_outlet_;
  DatagramOutlet position_outlet_;
  emulators::VelodyneLidar lidar_;
  StationOf<emulators::LidarBackend> station_;
  MotionInput motion_{lidar_};
  StationOf<emulators::ImuBackend> motion_station_{motion_, motion_};
  emulators::VelodyneWebInterface web_;
  std::uint32_t destination_changes_ = lidar_.destination_changes();
  std::optional<ClientRequest> last_request_;
  std::optional<drivers::HttpServer> server_;
};

std::string document_of(std::string_view model) {
  if (model.starts_with("HDL-32")) {
    return "Velodyne HDL-32E user's manual 63-9113 Rev. E and H";
  }
  if (model.starts_with("HDL-64")) {
    return "Velodyne HDL-64E S2 and S2.1 user's manual, S3 user's manual 63-HDL64ES3 Rev. J";
  }
  if (model.starts_with("VLP-32")) {
    return "Velodyne VLP-32C user's manual 63-9325 Rev. B";
  }
  if (model.starts_with("VLS")) {
    return "Velodyne VLS-128 user's manual 63-9483 Rev. A (draft)";
  }
  return "Velodyne VLP-16 user's manual 63-9243 Rev. D";
}

}  // namespace

VelodyneConfiguration::VelodyneConfiguration(std::string_view model) {
  lidar.model = model;
  lidar.saved.host_address = "127.0.0.1";
  lidar.position_wait =
      Duration{velodyne::packet_period_ns(model_of(*this), velodyne::ReturnMode::strongest)};
  const sim::SpinningHead head = sim::velodyne_head(model);
  sensor.beam = head.receiver;
  sensor.rotor = head.rotor;
}

emulators::VelodyneSettings settings_of(const VelodyneConfiguration& p) {
  emulators::VelodyneSettings settings = settings_but_calibration(p);
  if (!p.calibration_file.empty()) {
    settings.calibration = load_lidar_calibration(p.calibration_file);
  }
  return settings;
}

const protocols::velodyne::Model& model_of(const VelodyneConfiguration& p) {
  return emulators::model_of(p.lidar);
}

void visit(fields::Visitor& v, LidarWebConfiguration& p) {
  v.integer("port", p.port, IntegerRule{0, 65535},
            "TCP port of the web interface; 0 = there is none.");
  v.only_if(p.port != 0, "port", "a port", [&p](fields::Visitor& w) {
    w.text("address", p.address, "IPv4 address at which the web interface listens.");
    w.boolean("silent_refusals", p.silent_refusals, "Answers success to what it refuses, too.");
  });
}

void VelodyneConfiguration::visit(fields::Visitor& v) {
  emulators::visit(v, lidar);
  v.boolean("allow_remote", allow_remote, "Permits addresses outside this machine.");
  v.text("source_address", source_address,
         "Address that packets are sent from; empty = the system chooses.");
  v.choice("source_ports", source_ports, kSourcePorts, "UDP ports that packets are sent from.");
  const bool has_status_channel = model_of(*this).status_channel;
  if (!has_status_channel) {
    v.section("web", web, "The sensor's web interface.");
  }
  if (has_status_channel) {
    v.file("calibration", calibration_file, fields::FileKind::calibration,
           "File of the unit's calibration, YAML; empty = the nominal unit.");
  }
  v.text("time_source", time_source,
         "Satellite receiver; auto = the first one, locked; or ideal, pulse, none.");
  v.section("mount", mount, "Position and orientation of the spin axis on the machine.");
  v.section("sensor", sensor, "How well it measures.");
  v.list("faults", faults, "What goes wrong with the device, and when.");
}

void VelodyneConfiguration::validate() const {
  emulators::validate(settings_but_calibration(*this));
  sim::validate(sensor.beam);
  sim::validate(sensor.images);
  sim::validate(sensor.rotor);
  if (lidar.saved.return_mode != velodyne::ReturnMode::strongest && !tells_echoes_apart(sensor)) {
    throw fields::Refused(
        sensor.method == LidarMethod::rays ? "sensor.sub_rays" : "sensor.method",
        sensor.method == LidarMethod::rays
            ? "found 1 with return_mode last or dual, allowed 0, 5, 19 or 1000: a beam without "
              "width has one echo"
            : "found depth_image with return_mode last or dual, allowed rays: a pixel has one "
              "surface");
  }
}

void VelodyneConfiguration::check(const std::string& at, RigCheck& check) const {
  const auto claim_port = [&](const char* key, const std::string& where, std::uint16_t port) {
    check.claim(at + key, fmt::format("{}:{}", where, port), std::to_string(port));
  };
  check.address(at + ".address", lidar.saved.host_address, allow_remote);
  check.link(at + ".mount.link", mount.link);
  claim_port(".port", "udp " + lidar.saved.host_address, lidar.saved.data_port);
  if (model_of(*this).position_layout != velodyne::PositionLayout::none) {
    claim_port(".position_port", "udp " + lidar.saved.host_address, lidar.saved.telemetry_port);
  }
  if (!source_address.empty()) {
    check.address(at + ".source_address", source_address, true);
  }
  if (web.port != 0) {
    check.address(at + ".web.address", web.address, allow_remote);
    claim_port(".web.port", "tcp " + web.address, web.port);
  }
  if (!calibration_file.empty()) {
    try {
      (void)load_lidar_calibration(calibration_file);
    } catch (const std::runtime_error& error) {
      check.report(at + ".calibration", error.what());
    }
  }
  check.receiver(at + ".time_source", time_source,
                 {std::string(kAutomaticTimeSource), std::string(kIdealTimeSource),
                  std::string(kPulseTimeSource), std::string(kNoTimeSource)});
}

void VelodyneConfiguration::each_fault(const FaultEar& take) {
  show_faults(faults, take);
}

std::vector<fields::Named> VelodyneConfiguration::fault_kinds() const {
  return mixed_kinds(faults);
}

std::vector<LiveKey> VelodyneConfiguration::live_keys() const {
  return hil::live_keys(emulators::velodyne_live_settings(model_of(*this)));
}

DevicePlan VelodyneConfiguration::plan(const RigView& /*rig*/) const {
  const double packets_hz =
      1e9 / velodyne::packet_period_ns(model_of(*this), lidar.saved.return_mode);
  std::string wire = fmt::format("udp {}:{}", lidar.saved.host_address, lidar.saved.data_port);
  if (model_of(*this).position_layout != velodyne::PositionLayout::none) {
    wire += fmt::format(" and {}", lidar.saved.telemetry_port);
  }
  if (web.port != 0) {
    wire += fmt::format("; http {}:{}", web.address, web.port);
  }
  return {wire, fmt::format("{:.1f} packets/s", packets_hz),
          fmt::format("{:.0f} B/s", packets_hz * velodyne::kDataPacketSize),
          fmt::format("{:.0f} rpm", lidar.saved.rotor_rpm)};
}

std::optional<BusShare> VelodyneConfiguration::bus_share(std::string_view /*name*/) const {
  return std::nullopt;
}

DeviceDescription VelodyneConfiguration::describe() const {
  emulators::NullByteOutput output;
  const emulators::VelodyneLidar device(settings_of(*this), some_calendar(), output, output);
  DeviceDescription description;
  description.quantities = quantities_of(device);
  description.page = "docs/devices/velodyne.md";  // of the whole series
  const velodyne::Model& model = model_of(*this);
  const double data_hz = 1e9 / velodyne::packet_period_ns(model, velodyne::ReturnMode::strongest);
  const bool positions = model.position_layout != velodyne::PositionLayout::none;
  description.wire = positions ? "UDP: data packets to port 2368, position packets to port 8308"
                               : "UDP: data packets to port 2368";
  description.document = document_of(model.name);
  description.messages = {
      {"data packet", fmt::format("{:.1f} /s", data_hz),
       fmt::format("1206 bytes: {} firings of {} lasers, azimuth, time of hour",
                   velodyne::firings_per_packet(model, velodyne::ReturnMode::strongest),
                   model.lasers.size())}};
  if (positions) {
    description.messages.push_back({"position packet",
                                    fmt::format("{:.1f} /s", device.nominal_rate_hz() - data_hz),
                                    "512 bytes: time of hour, PPS state, $GPRMC sentence"});
  } else {
    description.messages.push_back(
        {"status channel", "each data packet", "2 bytes: time, state and calibration by turns"});
  }
  if (!model.status_channel) {
    description.wire += "; HTTP where `web.port` is set";
    description.messages.push_back(
        {"web interface", "on request", "settings, status, diagnostics (velodyne-web.md)"});
  }
  return description;
}

std::unique_ptr<Device> VelodyneConfiguration::make(Site& site) const {
  auto device = std::make_unique<VelodyneDevice>(*this, site);
  const emulators::LidarBackend& backend = device->emulator();
  auto caster = make_lidar_sensor(
      sensor, {backend.pattern(), device->emulator().sample_plan(), backend.command()}, site.seed(),
      site.name());
  site.world().add(make_world_lidar(device->enlist(site.executive()), site.name(),
                                    site.mount(mount), std::move(caster), backend.pattern()));
  if (const auto motion = device->enlist_motion(site.executive())) {
    site.world().add(
        make_world_imu(*motion, site.mount(mount),
                       sim::ImuSensor(sim::perfect_imu(), site.seed(), site.name() + "/motion")));
  }
  return device;
}

}  // namespace rigwire::hil
