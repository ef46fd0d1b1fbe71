// An NTRIP caster of the rig: a TCP server, and the lines of base stations behind its mount points.
#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "drivers/tcp_server.h"
#include "emulators/ntrip/caster.h"
#include "fields/check.h"
#include "fields/visitor.h"
#include "hil/devices/client_request.h"
#include "hil/devices/device.h"
#include "hil/devices/device_configuration.h"
#include "hil/devices/device_types.h"
#include "hil/devices/rig_check.h"
#include "hil/devices/site.h"
#include "hil/executive/event_source.h"

namespace rigwire::hil {
namespace {

struct NtripMount {
  std::string name = "BASE";
  std::string from;  ///< A base station of the rig.
  std::string details;
};
void visit(fields::Visitor& v, NtripMount& p) {
  v.required("from");
  v.text("name", p.name, "By which clients ask for it; usually in capitals.");
  v.text("from", p.from, "Name of the base station whose line it is: a gnss-base or a ZED-F9P.");
  v.text("details", p.details, "What the source table says of its messages: 1005(1),1077(1).");
}

struct NtripCasterConfiguration final : DeviceConfigurationOf<NtripCasterConfiguration> {
  std::string address = "127.0.0.1";
  std::uint16_t port = 2101;
  bool allow_remote = false;
  emulators::NtripCasterSettings caster;
  std::vector<NtripMount> mounts;

  void visit(fields::Visitor& v) override {
    v.text("address", address, "Address at which the server listens.");
    v.integer("port", port, fields::IntegerRule{1, 65535}, "TCP; casters usually have 2101.");
    v.boolean("allow_remote", allow_remote, "Permits listening where other machines reach it.");
    emulators::visit(v, caster);
    v.list("mounts", mounts, "Mount points: their names, and whose streams they are.");
    v.list("faults", caster.faults, "What goes wrong with the streams, and when.");
  }
  void validate() const override {
    fields::check(caster);
    constexpr std::string_view kNotInNames = " ;/?\r\n\t";
    for (std::size_t i = 0; i < mounts.size(); ++i) {
      const std::string& name = mounts[i].name;
      const std::string at = fmt::format("mounts.{}.name", i);
      if (name.empty() || name.find_first_of(kNotInNames) != std::string::npos) {
        throw fields::Refused(at, "found \"" + name +
                                      "\", allowed: names without space, semicolon, slash and "
                                      "question mark");
      }
      if (std::ranges::count(mounts, name, &NtripMount::name) > 1) {
        throw fields::Refused(at, "found \"" + name + "\" twice, allowed: once each");
      }
    }
  }
  void check(const std::string& at, RigCheck& check) const override {
    check.listener(at, address, port, allow_remote);
    for (std::size_t i = 0; i < mounts.size(); ++i) {
      check.base_station(fmt::format("{}.mounts.{}.from", at, i), mounts[i].from, "");
    }
  }
  void each_fault(const FaultEar& take) override { show_faults(caster.faults, take); }
  [[nodiscard]] std::vector<fields::Named> fault_kinds() const override {
    return hil::fault_kinds<emulators::CasterFault>();
  }
  [[nodiscard]] DevicePlan plan(const RigView& /*rig*/) const override {
    return {fmt::format("ntrip {}:{}", address, port), "what its base stations send", "",
            fmt::format("{} mount points", mounts.size())};
  }
  [[nodiscard]] std::optional<BusShare> bus_share(std::string_view /*name*/) const override {
    return std::nullopt;
  }
  [[nodiscard]] DeviceDescription describe() const override {
    DeviceDescription description;
    description.wire = "NTRIP caster on TCP, default 127.0.0.1:2101";
    description.document = "RTCM 10410.1 (NTRIP 2.0), NTRIP 1.0; RTCM 10403.3";
    description.messages = {{"GET /", "on request", "the source table"},
                            {"GET /MOUNT", "on request", "RTCM 3 frames as they come"}};
    return description;
  }
  [[nodiscard]] std::unique_ptr<Device> make(Site& site) const override;
};

class NtripCasterDevice final : public Device, private EventSource {
 public:
  NtripCasterDevice(const NtripCasterConfiguration& configuration, Site& site)
      : executive_(site.executive()),
        endpoint_(site.io(), {.address = configuration.address,
                              .port = configuration.port,
                              .allow_remote = configuration.allow_remote}),
        output_(endpoint_, own_statistics()),
        caster_(settings(configuration, site), site.calendar(), output_) {
    offer(make_fault_port(configuration.caster.faults, acted_by<emulators::CasterFault>(caster_)));
    const auto& origin = site.frame().parameters();
    for (const NtripMount& mount : configuration.mounts) {
      protocols::ntrip::Stream stream;
      stream.mount = mount.name;
      stream.identifier = site.name();
      stream.details = mount.details;
      stream.latitude_deg = origin.latitude_deg;
      stream.longitude_deg = origin.longitude_deg;
      lines_.push_back({caster_, caster_.add(stream), mount.from});
    }
    executive_.add(static_cast<EventSource&>(*this));
    endpoint_.start(
        {.connected =
             [this](auto connection) { caster_.connected(client_arrived(executive_), connection); },
         .received =
             [this](auto connection, auto bytes) {
               caster_.receive(client_arrived(executive_), connection, bytes);
             },
         .disconnected =
             [this](auto connection) { caster_.disconnected(executive_.arrive(), connection); }});
  }

  void connect(const Neighbours& neighbours) override {
    for (Line& line : lines_) {
      if (CorrectionSource* source = neighbours.corrections_of(line.from)) {
        source->inform(line);
      }
    }
  }

  [[nodiscard]] drivers::EndpointStatus endpoint() const override { return endpoint_.status(); }
  [[nodiscard]] std::uint64_t frames() const override { return caster_.frames_sent(); }
  [[nodiscard]] const emulators::Device& emulator() const override { return caster_; }
  [[nodiscard]] std::vector<NamedCount> counts() const override {
    const emulators::NtripCasterCounters& counters = caster_.counters();
    return {{"frames received", counters.frames},
            {"requests refused", counters.refused},
            {"requests timed out", counters.timed_out}};
  }
  [[nodiscard]] std::optional<ClientRequest> last_request() const override {
    const emulators::LastRequest& request = caster_.last_request();
    if (request.at == kNever) {
      return std::nullopt;
    }
    const auto bytes = request.bytes();
    return ClientRequest{request.at, std::string(bytes.begin(), bytes.end())};
  }

 private:
  static emulators::NtripCasterSettings settings(const NtripCasterConfiguration& configuration,
                                                 const Site& site) {
    emulators::NtripCasterSettings settings = configuration.caster;
    settings.noise_seed = site.device_seed();
    return settings;
  }

  // Received and delayed frames leave at once: they are due at the instant of what caused them.
  [[nodiscard]] SimTime next_event() const override { return caster_.next_event(); }
  [[nodiscard]] SimTime next_wakeup() const override { return caster_.next_event(); }
  void advance(SimTime now) override { caster_.advance(now); }

  struct Output final : emulators::StreamOutput {
    Output(drivers::StreamServer& to, WireStatistics& counted) : server(to), statistics(counted) {}
    void send(emulators::ConnectionId connection, SimTime /*due*/,
              std::span<const std::uint8_t> bytes) override {
      if (server.send(connection, bytes)) {
        ++statistics.units;
        statistics.bytes += bytes.size();
      } else {
        ++statistics.dropped;
      }
    }
    void close(emulators::ConnectionId connection, SimTime /*due*/) override {
      server.close(connection);
    }
    drivers::StreamServer& server;
    WireStatistics& statistics;
  };
  /// A base station's line.
  struct Line final : CorrectionListener {
    Line(emulators::NtripCaster& to, std::size_t at, std::string of)
        : caster(to), mount(at), from(std::move(of)) {}
    void hear_corrections(SimTime now, std::span<const std::uint8_t> bytes,
                          std::uint32_t /*baud*/) override {
      caster.hear(now, mount, bytes);
    }
    emulators::NtripCaster& caster;
    std::size_t mount;
    std::string from;
  };

  Executive& executive_;
  drivers::TcpServer endpoint_;
  Output output_;
  emulators::NtripCaster caster_;
  std::vector<Line> lines_;  ///< Complete before listeners get pointers to them.
};

std::unique_ptr<Device> NtripCasterConfiguration::make(Site& site) const {
  return std::make_unique<NtripCasterDevice>(*this, site);
}

}  // namespace

std::unique_ptr<DeviceConfiguration> fresh_ntrip_caster() {
  return std::make_unique<NtripCasterConfiguration>();
}

}  // namespace rigwire::hil
