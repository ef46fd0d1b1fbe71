#include "emulators/ublox/configuration_state.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string_view>

namespace rigwire::emulators {
namespace {

using namespace protocols::ubx;

constexpr std::array<std::uint8_t, 3> kInformationProtocols{0, 1, 3};

std::array<CfgPrt, 5> default_ports(const UbloxProfile& profile, std::uint32_t baud) {
  const std::uint16_t in = profile.input_protocols;
  const std::uint16_t out = profile.output_protocols;
  std::array<CfgPrt, 5> ports{};
  ports[kPortDdc] = {0, 0, 0x84, 0, in, out, 0};
  ports[kPortUart1] = {1, 0, 0x08C0, baud, in, out, 0};
  ports[kPortUart2] = {2, 0, 0x38C0, 0, 0, 0, 0};
  ports[kPortUsb] = {3, 0, 0, 0, in, out, 0};
  ports[kPortSpi] = {4, 0, 0x3200, 0, in, out, 0};
  return ports;
}

CfgNav5 default_navigation() {
  CfgNav5 nav5;
  nav5.mask = 0xFFFF;
  nav5.fix_mode = 3;
  nav5.fixed_altitude_variance_e4m2 = 10'000;
  nav5.minimum_elevation_deg = 5;
  nav5.position_dilution_mask_e1 = 250;
  nav5.time_dilution_mask_e1 = 250;
  nav5.position_accuracy_mask_m = 100;
  nav5.time_accuracy_mask_m = 300;
  nav5.differential_timeout_s = 60;
  return nav5;
}

CfgNavx5 default_expert(const UbloxProfile& profile) {
  CfgNavx5 navx5;
  navx5.minimum_satellites = 3;
  navx5.maximum_satellites = profile.channels;
  navx5.minimum_cn0_dbhz = 7;
  navx5.week_rollover = static_cast<std::uint16_t>(profile.first_week);
  navx5.precise_point_positioning = 1;
  navx5.maximum_orbit_error_m = 100;
  // Masks and reserved bytes as a NEO-7P answers: it sets all masks, so that what was read can be
  // changed and written back.
  navx5.mask1 = 0xFFFF;
  navx5.mask2 = 0x0000'000F;
  navx5.reserved1 = {3, 2};
  navx5.reserved3 = {1, 0};
  navx5.reserved4 = {0, 0, 0, 1, 1};
  navx5.reserved5 = {0, 100};
  navx5.reserved6 = {0, 1, 0x10, 0, 0, 0, 0, 0};
  return navx5;
}

/// UBX-13003221 R28, C.13; reserved bytes of a NEO-M9N.
CfgOdo default_odometer() {
  CfgOdo odometer;
  odometer.reserved = {0, 0, 0x19, 0x32, 0x19, 0x66};
  odometer.course_speed_dmps = 10;
  odometer.course_accuracy_m = 50;
  odometer.speed_gain = 153;
  odometer.course_gain = 76;
  return odometer;
}

std::array<CfgTp5, 2> default_pulses() {
  std::array<CfgTp5, 2> pulses{};
  pulses[0] = {0, 0, 50, 0, 1'000'000, 1'000'000, 0, 100'000, 0, 0xF7};
  pulses[1] = {1, 0, 50, 0, 4, 1, 125'000, 100'000, 0, 0xFE};
  return pulses;
}

void put_text(std::span<std::uint8_t> bytes, std::string_view text) {
  std::ranges::copy(text, bytes.begin());
}

void set_systems(UbloxConfigurationState& s, const UbloxProfile& profile) {
  s.gnss = {0, profile.channels, profile.channels,
            static_cast<std::uint8_t>(profile.systems.size())};
  for (std::size_t i = 0; i < profile.systems.size(); ++i) {
    const SystemChannels& system = profile.systems[i];
    s.systems[i] = {static_cast<std::uint8_t>(system.system), system.reserved, system.maximum,
                    (system.enabled ? 1U : 0U) | std::uint32_t{system.signals} << 16U};
  }
}

void set_opaque(UbloxConfigurationState& s) {
  CfgDat datum;
  put_text(datum.name, "WGS84");
  datum.major_axis_m = 6'378'137.0;
  datum.inverse_flattening = 298.257223563;
  write_payload(datum, s.datum);

  CfgPm2 power;
  power.update_period_ms = 1000;
  power.search_period_ms = 10'000;
  power.on_time_s = 2;
  write_payload(power, s.power_management);

  CfgUsb usb;
  usb.vendor_id = 0x1546;
  usb.product_id = 0x01A7;
  usb.power_consumption_ma = 100;
  put_text(usb.vendor, "u-blox AG - www.u-blox.com");
  put_text(usb.product, "u-blox 7 - GPS/GNSS Receiver");
  write_payload(usb, s.usb);

  s.interference = {0xF3, 0xAC, 0x62, 0x2D, 0x1E, 0x03, 0x00, 0x00};
  s.log_filter[0] = 1;  // version
  constexpr std::string_view kNoInventory = "Notice: no data saved!";
  put_text(std::span(s.remote_inventory).subspan(1), kNoInventory);
  s.remote_inventory_bytes = 1 + kNoInventory.size() + 1 /*end of the text*/;
}

CfgTmode3 fixed_at(const std::array<double, 3>& place_E_m) {
  constexpr int kPerCentimetre = 100;
  CfgTmode3 mode;
  mode.flags = kTmodeFixed;
  for (std::size_t axis = 0; axis < place_E_m.size(); ++axis) {
    const auto count = std::llround(place_E_m[axis] * 1e4);
    mode.position[axis] = static_cast<std::int32_t>(count / kPerCentimetre);
    mode.position_rest[axis] = static_cast<std::int8_t>(count % kPerCentimetre);
  }
  return mode;
}

}  // namespace

bool line_is_sound(const UbloxProfile& profile, const CfgPrt& uart) {
  constexpr std::uint32_t kFramingMask = 0x3EC0;
  constexpr std::uint32_t kFraming8N1 = 0x08C0;
  return (uart.mode & kFramingMask) == kFraming8N1 && uart.baud <= profile.greatest_baud &&
         std::ranges::find(ublox_bauds(), uart.baud) != ublox_bauds().end();
}

bool has_major_system(std::span<const CfgGnssBlock> systems) {
  return std::ranges::any_of(systems, [](const CfgGnssBlock& block) {
    constexpr std::array kMajor{GnssSystem::gps, GnssSystem::galileo, GnssSystem::beidou,
                                GnssSystem::glonass};
    return (block.flags & 1U) != 0 &&
           std::ranges::find(kMajor, static_cast<GnssSystem>(block.system)) != kMajor.end();
  });
}

UbloxConfigurationState default_state(const UbloxSettings& settings) {
  const UbloxProfile& profile = *settings.profile;
  UbloxConfigurationState s;
  s.ports = default_ports(profile, settings.baud);
  const auto switch_on = [&](const std::vector<std::string>& names) {
    for (const auto& name : names) {
      const std::size_t index = message_index(profile, name);
      s.rates[index] = {1, 1, 1, 1, 1, 1};
      // The second UART has its own list of corrections.
      s.rates[index][kPortUart2] = profile.messages[index].rtcm ? 0 : 1;
    }
  };
  switch_on(settings.nmea_sentences);
  switch_on(settings.ubx_messages);
  for (const auto& name : settings.uart2_messages) {
    s.rates[message_index(profile, name)][kPortUart2] = 1;
  }
  for (std::size_t i = 0; i < kInformationProtocols.size(); ++i) {
    s.information[i].protocol = kInformationProtocols[i];
  }
  s.information[1].masks.fill(0x87);
  s.rate = {static_cast<std::uint16_t>(settings.measurement_period / std::chrono::milliseconds{1}),
            1, 1};
  s.nav5 = default_navigation();
  s.navx5 = default_expert(profile);
  s.odometer = default_odometer();
  s.nmea.version = profile.nmea_version;
  s.nmea.flags = 0x02;
  s.sbas = {1, 3, 3, 0, 0x0006A2D1};
  s.antenna = {0x001B, 0xB9F0};
  s.power = {8, 0};
  s.pulses = default_pulses();
  set_systems(s, profile);
  set_opaque(s);
  if (profile.adjust_defaults != nullptr) {
    profile.adjust_defaults(s);
  }
  if (profile.carrier_solution) {
    s.ports[kPortUart2].baud = settings.uart2_baud;
    s.station_out = settings.station;
    if (settings.place_E_m) {
      set_base_mode(s, fixed_at(*settings.place_E_m));
    }
  }
  return s;
}

// Values that a NEO-M9N answers (pyubx2's examples); they include the masks that R28, C.11, sets to
// 1.
void set_modern_expert(CfgNavx5& expert) {
  expert.mask1 = 0xFFFF;
  expert.mask2 = 0x0000'03BF;
  expert.reserved1 = {0, 2};
  expert.reserved4 = {0, 0, 0, 1, 1};
  expert.reserved6 = {0, 1, 0x12, 0, 0, 0, 0, 0};
}

CfgTmode3 base_mode(const UbloxConfigurationState& state) {
  CfgTmode3 base = state.base;
  const bool geodetic = (base.flags & kTmodeGeodetic) != 0;
  base.position = geodetic ? state.base_geodetic : state.base_ecef_cm;
  base.position_rest = geodetic ? state.base_geodetic_rest : state.base_ecef_rest;
  return base;
}

void set_base_mode(UbloxConfigurationState& state, const CfgTmode3& wanted) {
  const bool geodetic = (wanted.flags & kTmodeGeodetic) != 0;
  (geodetic ? state.base_geodetic : state.base_ecef_cm) = wanted.position;
  (geodetic ? state.base_geodetic_rest : state.base_ecef_rest) = wanted.position_rest;
  state.base = wanted;
  state.base.position = {};
  state.base.position_rest = {};
}

void copy_sections(const UbloxConfigurationState& from, UbloxConfigurationState& to,
                   std::uint32_t mask) {
  if ((mask & kSectionIoPort) != 0) {
    to.ports = from.ports;
    to.usb = from.usb;
  }
  if ((mask & kSectionMessages) != 0) to.rates = from.rates;
  if ((mask & kSectionInformation) != 0) to.information = from.information;
  if ((mask & kSectionNavigation) != 0) {
    to.rate = from.rate;
    to.nav5 = from.nav5;
    to.navx5 = from.navx5;
    to.odometer = from.odometer;
    to.nmea = from.nmea;
    to.nmea_tail = from.nmea_tail;
    to.pulses = from.pulses;
    to.sbas = from.sbas;
    to.base = from.base;
    to.base_ecef_cm = from.base_ecef_cm;
    to.base_ecef_rest = from.base_ecef_rest;
    to.base_geodetic = from.base_geodetic;
    to.base_geodetic_rest = from.base_geodetic_rest;
    to.station_out = from.station_out;
    to.station_in = from.station_in;
    to.station_filter = from.station_filter;
    to.carrier_mode = from.carrier_mode;
    to.jamming_sensitive = from.jamming_sensitive;
    to.datum = from.datum;
  }
  if ((mask & kSectionReceiver) != 0) {
    to.power = from.power;
    to.power_management = from.power_management;
    to.gnss = from.gnss;
    to.systems = from.systems;
    to.interference = from.interference;
  }
  if ((mask & kSectionInventory) != 0) {
    to.remote_inventory = from.remote_inventory;
    to.remote_inventory_bytes = from.remote_inventory_bytes;
  }
  if ((mask & kSectionAntenna) != 0) to.antenna = from.antenna;
  if ((mask & kSectionLogging) != 0) to.log_filter = from.log_filter;
}

}  // namespace rigwire::emulators
