#include "hil/devices/gige_camera.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>

#include <array>
#include <boost/asio/post.hpp>
#include <cstdio>
#include <optional>
#include <utility>

#include "drivers/udp_port.h"
#include "emulators/gige_camera/gige_camera.h"
#include "fields/check.h"
#include "fields/visitor.h"
#include "hil/devices/client_request.h"
#include "hil/devices/device.h"
#include "hil/devices/rig_check.h"
#include "hil/devices/site.h"
#include "hil/executive/station.h"
#include "hil/files/settings_file.h"
#include "hil/wires/outlets.h"
#include "hil/world/camera.h"
#include "protocols/gige_vision/gvcp.h"

namespace rigwire::hil {

namespace gev = protocols::gige_vision;
using emulators::CameraAddress;
using emulators::GigeCameraKind;
using emulators::GigeCameraSettings;

namespace {

/// Waiting for the wire: answers, and packets of some 60 ms at 1 Gbit/s.
constexpr std::size_t kControlUnits = 512;
constexpr std::size_t kControlBytes = kControlUnits * gev::kGvcpSizeMaximum;
constexpr std::size_t kStreamUnits = 8192;
constexpr std::size_t kStreamBytes = std::size_t{8} << 20U;

/// At power-on, less than the network's: a client on a busy machine that is not run for 5 ms still
/// loses nothing of its system's 200 kB.
constexpr double kThroughput_bps = 200e6;

/// Loopback carries it in one piece, at half the cost of packets of 1500 bytes.
constexpr int kPacketSize = 8192;

/// Default frame period of cameras whose pictures have several parts.
constexpr Duration kFramePeriodOfSeveral = std::chrono::milliseconds(100);

/// Default exposure time, for sunlight at the lens's default aperture.
constexpr Duration kDaylightExposure = std::chrono::milliseconds(1);

/// Time to read out one row of a sensor with a global shutter.
constexpr Duration kGlobalRowTime = std::chrono::microseconds(10);

std::uint32_t parse_address(const char* key, const std::string& text) {
  in_addr address{};
  if (::inet_pton(AF_INET, text.c_str(), &address) != 1) {
    throw fields::Refused(key, "found \"" + text + "\", allowed four numbers like 127.0.0.2");
  }
  return ntohl(address.s_addr);
}

CameraAddress network_of(const GigeCameraConfiguration& p) {
  CameraAddress network;
  network.address = parse_address("address", p.address);
  if (p.allow_remote) {
    network.mask = parse_address("netmask", p.netmask);
    network.gateway = parse_address("gateway", p.gateway);
  }
  return network;
}

gev::MacAddress mac_of(const GigeCameraConfiguration& p, std::uint32_t address) {
  gev::MacAddress mac{0x02, 0x52};
  if (p.mac.empty()) {
    for (std::size_t i = 0; i < 4; ++i) {
      mac[2 + i] = static_cast<std::uint8_t>(address >> (24 - 8 * i));
    }
    return mac;
  }
  std::array<unsigned, 6> bytes{};
  int used = 0;
  const int read = std::sscanf(p.mac.c_str(), "%2x:%2x:%2x:%2x:%2x:%2x%n", &bytes[0], &bytes[1],
                               &bytes[2], &bytes[3], &bytes[4], &bytes[5], &used);
  if (read != 6 || static_cast<std::size_t>(used) != p.mac.size() || p.mac.size() != 17) {
    throw fields::Refused("mac", "found \"" + p.mac + "\", allowed one like 02:52:57:00:00:01");
  }
  if ((bytes[0] & 1U) != 0) {
    throw fields::Refused(
        "mac", "found \"" + p.mac + "\", allowed one of a single device: an even first byte");
  }
  for (std::size_t i = 0; i < mac.size(); ++i) {
    mac[i] = static_cast<std::uint8_t>(bytes[i]);
  }
  return mac;
}

GigeCameraKind kind_of(const sim::CameraKind& sensor) {
  if (std::holds_alternative<sim::StereoCameraParameters>(sensor)) {
    return GigeCameraKind::stereo;
  }
  return std::holds_alternative<sim::DepthCameraParameters>(sensor) ? GigeCameraKind::depth
                                                                    : GigeCameraKind::camera;
}

/// Where nothing is sent.
class NullDatagramOutput final : public emulators::DatagramOutput {
 public:
  void send(SimTime /*due*/, const emulators::UdpEnd& /*to*/,
            std::span<const std::uint8_t> /*bytes*/, bool /*do_not_fragment*/) override {}
};

/// What an emulator with these settings answers: `ask` is given it.
template <class Ask>
auto asked_of(const GigeCameraSettings& settings, const Ask& ask) {
  emulators::VolatileMemory memory;
  NullDatagramOutput nowhere;
  return ask(emulators::GigeCamera(settings, memory, nowhere, nowhere));
}

class GigeCameraDevice final : public Device {
 public:
  GigeCameraDevice(const GigeCameraConfiguration& configuration, Site& site)
      : io_(site.io()),
        memory_(open_settings(configuration.settings_file)),
        address_(settings_of(configuration).address.address),
        ports_(std::make_unique<Ports>(io_, address_)),
        control_outlet_(ports_->control, own_statistics(), kControlUnits, kControlBytes),
        stream_outlet_(ports_->stream, own_statistics(), kStreamUnits, kStreamBytes),
        camera_(seeded(settings_of(configuration), site), *memory_, control_outlet_,
                stream_outlet_),
        station_(camera_, camera_) {
    offer(make_fault_port(those_of<emulators::GigeCameraFault>(configuration.faults),
                          acted_by<emulators::GigeCameraFault>(camera_)));
    offer(make_fault_port(those_of<emulators::SupplyFault>(configuration.faults),
                          acted_by<emulators::SupplyFault>(camera_.supply())));
    camera_.inform_of_moves([this] { follow_soon(); });
    follow_address();  // that was saved
    camera_.set_stream_port(ports_->stream.local_port());
  }

  [[nodiscard]] StationIndex enlist(Executive& executive) {
    const StationIndex index = executive.add(station_);
    executive.add(control_outlet_);
    executive.add(stream_outlet_);
    executive_ = &executive;
    index_ = index;
    listen();
    return index;
  }

  [[nodiscard]] const emulators::GigeCamera& emulator() const override { return camera_; }
  [[nodiscard]] std::string remark() const override { return remark_; }
  [[nodiscard]] std::optional<StationIndex> camera_station() const override { return index_; }
  [[nodiscard]] drivers::EndpointStatus endpoint() const override {
    drivers::EndpointStatus status = ports_->control.status();
    status.client_present = status.client_present || camera_.controlled();
    return status;
  }
  [[nodiscard]] std::optional<ClientRequest> last_request() const override { return last_request_; }
  [[nodiscard]] std::string tell(SimTime now, const DeviceConfiguration& wanted,
                                 std::string_view key) override {
    return hil::tell(emulators::GigeCamera::live_settings(), key, camera_, now,
                     static_cast<const GigeCameraConfiguration&>(wanted).camera);
  }
  /// Datagrams that were lost, and pictures that never became any.
  [[nodiscard]] std::uint64_t dropped() const override {
    const emulators::GigeCameraCounters counted = camera_.counters();
    return statistics().dropped + counted.lost_datagrams + counted.stream.lost_blocks +
           counted.skipped_pictures;
  }
  [[nodiscard]] std::vector<NamedCount> counts() const override {
    const emulators::GigeCameraCounters counted = camera_.counters();
    return {{"pictures", counted.pictures},
            {"late_pictures", counted.late_pictures},
            {"skipped_pictures", counted.skipped_pictures},
            {"lost_pictures", counted.stream.lost_blocks},
            {"ignored_triggers", counted.ignored_triggers},
            {"lost_triggers", counted.lost_triggers},
            {"lost_datagrams", counted.lost_datagrams},
            {"resent_packets", counted.stream.resent_packets},
            {"refused_resends", counted.stream.refused_resends}};
  }

 private:
  /// UDP ports of the camera at one address.
  struct Ports {
    Ports(boost::asio::io_context& io, std::uint32_t address)
        : control(io, {.address = address, .port = gev::kGvcpPort, .broadcasts = true}),
          stream(io, {.address = address}) {}

    drivers::UdpPort control;
    drivers::UdpPort stream;
  };

  static GigeCameraSettings seeded(GigeCameraSettings settings, const Site& site) {
    settings.seed = site.device_seed();
    return settings;
  }

  void listen() {
    control_outlet_.start(
        [this](const drivers::DatagramPort::Peer& from, std::span<const std::uint8_t> datagram) {
          const SimTime now = client_arrived(*executive_);
          if (auto request = gvcp_request(datagram)) {
            last_request_ = {now, std::move(*request)};
          }
          camera_.receive(now, {from.address, from.port}, datagram);
          if (camera_.address_changes() != followed_changes_) {
            follow_soon();
          }
        });
  }

  /// Not at once: a port would be closed while it hands over.
  void follow_soon() {
    if (std::exchange(follows_, true)) {
      return;
    }
    boost::asio::post(io_, [this, alive = std::weak_ptr<char>(alive_)] {
      if (!alive.expired()) {
        follow_address();
        listen();
      }
    });
  }

  /// The answer to what moved it has gone or goes from the new place. Where that cannot be had, the
  /// camera stays where it is.
  void follow_address() {
    follows_ = false;
    followed_changes_ = camera_.address_changes();
    const CameraAddress wanted = camera_.address();
    if (wanted.address == address_) {
      return;
    }
    std::unique_ptr<Ports> moved;
    try {
      moved = std::make_unique<Ports>(io_, wanted.address);
    } catch (const drivers::EndpointError& refusal) {
      remark_ = refusal.what();
      CameraAddress back = wanted;
      back.address = address_;
      camera_.set_address(back);
      return;
    }
    ports_ = std::move(moved);
    address_ = wanted.address;
    control_outlet_.lead_to(ports_->control);
    stream_outlet_.lead_to(ports_->stream);
    camera_.set_stream_port(ports_->stream.local_port());
  }

  boost::asio::io_context& io_;
  std::unique_ptr<emulators::NonvolatileMemory> memory_;
  std::uint32_t address_;  ///< Address of the ports.
  std::unique_ptr<Ports> ports_;
  AddressedOutlet control_outlet_;
  AddressedOutlet stream_outlet_;
  emulators::GigeCamera camera_;
  StationOf<emulators::CameraBackend> station_;
  Executive* executive_ = nullptr;
  std::optional<StationIndex> index_;
  std::uint32_t followed_changes_ = 0;
  bool follows_ = false;  ///< Is about to move.
  std::string remark_;
  std::optional<ClientRequest> last_request_;
  std::shared_ptr<char> alive_ = std::make_shared<char>();
};

}  // namespace

GigeCameraConfiguration::GigeCameraConfiguration(sim::CameraKind kind, std::string_view model)
    : sensor(std::move(kind)) {
  camera.model = model;
  camera.throughput_bps = kThroughput_bps;
  camera.packet_size = kPacketSize;
  if (kind_of(sensor) != GigeCameraKind::camera) {
    camera.frame_period = kFramePeriodOfSeveral;
  }
  const auto* const depth = std::get_if<sim::DepthCameraParameters>(&sensor);
  camera.exposure = depth != nullptr ? depth->noise_exposure : kDaylightExposure;
}

GigeCameraSettings settings_of(const GigeCameraConfiguration& p) {
  GigeCameraSettings settings = p.camera;
  settings.faults = those_of<emulators::GigeCameraFault>(p.faults);
  settings.supply_faults = those_of<emulators::SupplyFault>(p.faults);
  const sim::CameraAbilities abilities = sim::abilities_of(p.sensor);
  settings.kind = kind_of(p.sensor);
  settings.address = network_of(p);
  settings.permitted = settings.address;
  settings.mac = mac_of(p, settings.address.address);
  settings.width = abilities.width_px;
  settings.height = abilities.height_px;
  settings.formats = abilities.formats;
  settings.binning = abilities.binning;
  settings.row_time = abilities.row_time > Duration{0} ? abilities.row_time : kGlobalRowTime;
  if (abilities.geometry) {
    const sim::ReportedGeometry& geometry = *abilities.geometry;
    settings.geometry = {geometry.focal_length_px, geometry.baseline_m, geometry.principal_u_px,
                         geometry.principal_v_px, geometry.coding};
  }
  return settings;
}

CameraCommand power_on_command(const GigeCameraConfiguration& configuration) {
  return asked_of(settings_of(configuration),
                  [](const emulators::GigeCamera& device) { return device.command(); });
}

void GigeCameraConfiguration::visit(fields::Visitor& v) {
  v.text("address", address, "IPv4 address that is the camera's own, in 127.0.0.0/8.");
  v.boolean("allow_remote", allow_remote, "Permits addresses and clients outside this machine.");
  v.only_if(allow_remote, "allow_remote", "allow_remote: true", [this](fields::Visitor& w) {
    w.text("netmask", netmask, "Mask of the camera's network; only clients in it are answered.");
    w.text("gateway", gateway, "Gateway that the camera reports.");
  });
  v.text("mac", mac, "Hardware address that it reports; empty = made from the address.");
  v.file("settings_file", settings_file, fields::FileKind::memory,
         "What a client saved (name, persistent address); empty = lasts as long as the run.");
  emulators::visit(v, camera);
  v.duration("processing", processing, {0, 10'000'000'000},
             "From the end of an exposure to when its picture can leave.");
  v.section("mount", mount, "Where on the machine it is; x looks along the optical axis.");
  v.boolean("sees_own_link", sees_own_link, "Whether it can see the link that it is mounted on.");
  std::visit([&v](auto& kind) { v.section("sensor", kind, "Lens, image sensor, how it renders."); },
             sensor);
  v.list("faults", faults, "What goes wrong with the device, and when.");
}

void GigeCameraConfiguration::validate() const {
  const GigeCameraSettings settings = settings_of(*this);
  const sim::CameraAbilities abilities = sim::abilities_of(sensor);
  const auto side = [](const char* key, int found, int of) {
    fields::require(found % of == 0, key, std::to_string(found),
                    "multiples of " + std::to_string(of) + " on the wire");
  };
  side("sensor", abilities.width_px, 8);
  side("sensor", abilities.height_px, 4);
  emulators::validate(settings);
  if (const auto* const plain = std::get_if<sim::CameraParameters>(&sensor)) {
    // The other kinds have asked their lenses themselves.
    const sim::ImageSensorParameters& chip = plain->sensor;
    (void)sim::Lens(plain->lens, chip.pixel_pitch_m, chip.width_px, chip.height_px);
  }
  const Duration longest = sim::optics_of(sensor).auto_exposure.longest;
  fields::require(!camera.exposure_auto || longest <= camera.frame_period,
                  "sensor.auto_exposure.longest", fields::print_duration(longest.count()),
                  "at most the time between two frames, " +
                      fields::print_duration(camera.frame_period.count()));
  fields::require(camera.exposure <= camera.frame_period, "exposure",
                  fields::print_duration(camera.exposure.count()),
                  "at most the time between two frames, " +
                      fields::print_duration(camera.frame_period.count()));
  const Duration shortest = asked_of(
      settings, [](const emulators::GigeCamera& device) { return device.shortest_period(); });
  fields::require(
      shortest <= camera.frame_period, "rate",
      fmt::format("{:g} Hz", 1.0 / to_seconds(camera.frame_period)),
      fmt::format("at most {:.2f} Hz: reading out and sending a picture takes {}",
                  1.0 / to_seconds(shortest), fields::print_duration(shortest.count())));
}

void GigeCameraConfiguration::check(const std::string& at, RigCheck& check) const {
  check.address(at + ".address", address, allow_remote);
  check.link(at + ".mount.link", mount.link);
  check.claim(at + ".address", fmt::format("udp {}:{}", address, gev::kGvcpPort), address);
  const GigeCameraSettings settings = settings_of(*this);
  const std::uint32_t host = settings.address.address & ~settings.address.mask;
  if (host == 0 || host == ~settings.address.mask) {
    check.report(at + ".address", "is no host's, but its whole network's", "\"" + address + "\"",
                 "another address of that network");
  }
  const gev::MacAddress& hardware = settings.mac;
  check.claim(at + (mac.empty() ? ".address" : ".mac"),
              fmt::format("mac {:02x}", fmt::join(hardware, ":")),
              fmt::format("{:02x}", fmt::join(hardware, ":")));
  check.claim(at + ".serial",
              fmt::format("camera {} {} {}", camera.vendor, camera.model, camera.serial_number),
              camera.serial_number);
}

void GigeCameraConfiguration::each_fault(const FaultEar& take) {
  show_faults(faults, take);
}

std::vector<fields::Named> GigeCameraConfiguration::fault_kinds() const {
  return mixed_kinds(faults);
}

std::vector<LiveKey> GigeCameraConfiguration::live_keys() const {
  return hil::live_keys(emulators::GigeCamera::live_settings());
}

DevicePlan GigeCameraConfiguration::plan(const RigView& /*rig*/) const {
  const GigeCameraSettings settings = settings_of(*this);
  const double rate_hz = 1.0 / to_seconds(camera.frame_period);
  const std::size_t bytes = picture_bytes(power_on_command(*this));
  return {fmt::format("udp {}:{}, GigE Vision", address, gev::kGvcpPort),
          fmt::format("{:g} pictures/s", rate_hz),
          fmt::format("{:.0f} B/s", rate_hz * static_cast<double>(bytes)),
          fmt::format("{} x {} pixels, when a client starts it", settings.width, settings.height)};
}

std::optional<BusShare> GigeCameraConfiguration::bus_share(std::string_view /*name*/) const {
  return std::nullopt;
}

DeviceDescription GigeCameraConfiguration::describe() const {
  DeviceDescription description;
  description.quantities = asked_of(settings_of(*this), [](const emulators::GigeCamera& device) {
    return quantities_of(device);
  });
  description.page = "docs/devices/gige-camera.md";  // of all kinds
  description.wire = "UDP: control at port 3956 of the camera's address, pictures to the client";
  description.document = "GigE Vision as Aravis 0.8 and Wireshark 4.0 speak it; EMVA SFNC, PFNC";
  description.messages = {
      {"DISCOVERY, FORCEIP", "on request", "who it is, where it is"},
      {"READREG, READMEM", "on request",
       "registers, and the description of its features (GenICam)"},
      {"WRITEREG, WRITEMEM", "received", "control, settings, triggers"},
      {"PACKETRESEND", "received", "packets of the stream that are to be sent again"},
      {"stream packets", "when acquiring", "leader, payload and trailer of each picture"}};
  return description;
}

std::unique_ptr<Device> GigeCameraConfiguration::make(Site& site) const {
  auto device = std::make_unique<GigeCameraDevice>(*this, site);
  WorldCameraSettings settings;
  settings.name = site.name();
  settings.mount = site.mount(mount);
  settings.sees_own_link = sees_own_link;
  settings.processing = processing;
  settings.auto_exposure = sim::optics_of(sensor).auto_exposure;
  SimulatedWorld& world = site.world();
  const std::uint64_t seed = site.seed();
  const std::string& name = site.name();
  world.add(make_world_camera(device->enlist(site.executive()), settings, world.scene(),
                              world.terrain(), site.surroundings(),
                              [&] { return sim::make_camera(sensor, seed, name); }));
  return device;
}

}  // namespace rigwire::hil
