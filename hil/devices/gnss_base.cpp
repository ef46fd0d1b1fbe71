// A reference station on the ground: a ZED-F9P that holds its place and sends RTCM 3 over a line,
// to receivers (corrections_from) and to casters.
#include <fmt/format.h>

#include <limits>

#include "emulators/ublox/correction_output.h"
#include "emulators/ublox/receiver.h"
#include "fields/visitor.h"
#include "hil/devices/device.h"
#include "hil/devices/device_configuration.h"
#include "hil/devices/device_types.h"
#include "hil/devices/mounting.h"
#include "hil/devices/rig_check.h"
#include "hil/devices/site.h"
#include "hil/executive/station.h"
#include "sim/gnss/gnss_parameters.h"

namespace rigwire::hil {
namespace {

using fields::in;

struct GnssBaseConfiguration final : DeviceConfigurationOf<GnssBaseConfiguration> {
  Vector3 position_m{100.0, 0.0, 2.0};  ///< Position of the antenna in the world: east, north, up.
  Vector3 claim_offset_m;               ///< Offset of the reported position from it.
  std::uint16_t station = 1;
  std::vector<std::string> messages{"RTCM-1005", "RTCM-1077", "RTCM-1230"};
  Duration period = std::chrono::seconds{1};
  std::uint32_t baud = 115'200;
  sim::GnssParameters sensor;
  std::vector<MixedFault<sim::GnssFault, emulators::SupplyFault>> faults;

  GnssBaseConfiguration() {
    sensor.sky.maximum_channels = emulators::ublox_zed_f9p().channels;
    sensor.raw_measurements = true;
    sensor.second_signals = true;
    sensor.systems = {.gps = true, .glonass = true, .galileo = true, .beidou = true, .sbas = true};
  }

  void visit(fields::Visitor& v) override {
    v.vector3("position", position_m, in("m").between(-1e5, 1e5),
              "Place of the antenna from the scene's origin: east, north, up.");
    v.vector3("claim_offset", claim_offset_m, in("m").between(-1e5, 1e5),
              "Error of its reported position: east, north, up. Its rovers have the same error.");
    v.integer("station", station, fields::IntegerRule{0, 4095},
              "Number that it calls itself by (DF003).");
    v.texts("messages", messages,
            "What it sends each epoch: RTCM-1005, RTCM-1077, RTCM-1230 and others.");
    v.rate("rate", period, in("Hz").between(0.1, 20), "Epochs per second.");
    v.check(period % std::chrono::milliseconds{1} == Duration{0}, "rate",
            "the station counts its period in milliseconds", fields::print_duration(period.count()),
            "whole milliseconds");
    v.integer("baud", baud, fields::IntegerRule{4800, 921'600, fields::unit("bit/s")},
              "Speed of its line, 8N1.");
    v.section("sensor", sensor, "How well it measures.");
    v.list("faults", faults, "What goes wrong with the device, and when.");
  }
  [[nodiscard]] emulators::UbloxSettings settings() const {
    emulators::UbloxSettings settings;
    settings.profile = &emulators::ublox_zed_f9p();
    settings.baud = settings.profile->baud;
    settings.measurement_period = period;
    settings.nmea_sentences = {};
    settings.uart2_messages = messages;
    settings.uart2_baud = baud;
    settings.station = station;
    settings.uses_corrections = false;
    settings.supply_faults = those_of<emulators::SupplyFault>(faults);
    return settings;
  }
  void validate() const override {
    emulators::validate(settings());
    sim::validate(sensor);
    check_corrections(sensor.corrections.kind, false, "gnss-base");
  }
  void check(const std::string& at, RigCheck& check) const override {
    check_bands(faults, bands_of(sensor), at, check);
  }
  void each_fault(const FaultEar& take) override { show_faults(faults, take); }
  [[nodiscard]] std::vector<fields::Named> fault_kinds() const override {
    return mixed_kinds(faults);
  }
  [[nodiscard]] DevicePlan plan(const RigView& /*rig*/) const override {
    return {fmt::format("a line to its rovers at {} baud", baud),
            epochs_text(1.0 / to_seconds(period)), "", fmt::format("station {}", station)};
  }
  [[nodiscard]] std::optional<BusShare> bus_share(std::string_view /*name*/) const override {
    return std::nullopt;
  }
  [[nodiscard]] DeviceDescription describe() const override {
    emulators::NullByteOutput output;
    DeviceDescription description;
    description.quantities =
        quantities_of(emulators::UbloxReceiver(settings(), some_calendar(), output));
    description.wire = "a line to receivers (corrections_from) and casters of the rig";
    description.document = "RTCM 10403.3; as a ZED-F9P in fixed mode";
    for (const emulators::UbloxMessage& message : emulators::ublox_zed_f9p().messages) {
      if (message.rtcm) {
        description.messages.push_back({std::string(message.name), "each epoch",
                                        fmt::format("at most {} bytes", message.greatest_bytes)});
      }
    }
    return description;
  }
  [[nodiscard]] std::unique_ptr<Device> make(Site& site) const override;
  [[nodiscard]] bool is_base_station() const override { return true; }
};

class GnssBaseDevice final : public Device, private CorrectionSource {
 public:
  GnssBaseDevice(const GnssBaseConfiguration& configuration, Site& site)
      : receiver_(settings(configuration, site), site.calendar(), nowhere_, line_),
        station_(receiver_, receiver_) {
    line_.baud = configuration.baud;
    offer(antenna_faults(site.executive(), station_, bands_of(configuration.sensor),
                         those_of<sim::GnssFault>(configuration.faults)));
    offer(make_fault_port(those_of<emulators::SupplyFault>(configuration.faults),
                          acted_by<emulators::SupplyFault>(receiver_.supply())));
  }

  [[nodiscard]] StationIndex enlist(Executive& executive) { return executive.add(station_); }

  [[nodiscard]] CorrectionSource* corrections() override { return this; }
  [[nodiscard]] drivers::EndpointStatus endpoint() const override {
    return {"line to its rovers", !line_.listeners.empty()};
  }
  [[nodiscard]] std::uint64_t frames() const override { return line_.units; }
  [[nodiscard]] const emulators::Device& emulator() const override { return receiver_; }
  [[nodiscard]] std::optional<ClientRequest> last_request() const override { return std::nullopt; }

 private:
  static Eigen::Vector3d to_eigen(const Vector3& v) { return {v.x, v.y, v.z}; }
  static emulators::UbloxSettings settings(const GnssBaseConfiguration& configuration,
                                           const Site& site) {
    emulators::UbloxSettings settings = configuration.settings();
    const Eigen::Vector3d claimed_E_m = site.frame().to_ecef(
        to_eigen(configuration.position_m) + to_eigen(configuration.claim_offset_m));
    settings.place_E_m = {claimed_E_m.x(), claimed_E_m.y(), claimed_E_m.z()};
    settings.noise_seed = site.device_seed();
    return settings;
  }
  void inform(CorrectionListener& listener) override { line_.listeners.push_back(&listener); }

  struct Line final : emulators::ByteOutput {
    void send(SimTime due, std::span<const std::uint8_t> bytes) override {
      ++units;
      for (CorrectionListener* listener : listeners) {
        listener->hear_corrections(due, bytes, baud);
      }
    }
    std::uint32_t baud = 0;
    std::uint64_t units = 0;
    std::vector<CorrectionListener*> listeners;
  };

  emulators::NullByteOutput nowhere_;
  Line line_;
  emulators::UbloxReceiver receiver_;
  StationOf<emulators::GnssBackend> station_;
};

std::unique_ptr<Device> GnssBaseConfiguration::make(Site& site) const {
  auto device = std::make_unique<GnssBaseDevice>(*this, site);
  set_up_antenna(site, device->enlist(site.executive()), {position_m.x, position_m.y, position_m.z},
                 sensor, those_of<sim::GnssFault>(faults));
  return device;
}

}  // namespace

std::unique_ptr<DeviceConfiguration> fresh_gnss_base() {
  return std::make_unique<GnssBaseConfiguration>();
}

}  // namespace rigwire::hil
