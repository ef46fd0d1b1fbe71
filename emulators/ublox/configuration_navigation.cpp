// CFG-RATE, NAV5, NAVX5, GNSS, NMEA, TP5, DAT, RINV: how the receiver navigates and speaks.
#include <algorithm>
#include <chrono>

#include "emulators/ublox/configuration.h"
#include "protocols/bytes.h"

namespace rigwire::emulators {
namespace {

using namespace protocols::ubx;
using Payload = std::span<const std::uint8_t>;

/// Carrier bands that a radio path receives at once.
enum class Band : std::uint8_t { l1, glonass, beidou };

Band band_of(std::uint8_t system) {
  switch (static_cast<GnssSystem>(system)) {
    case GnssSystem::glonass:
      return Band::glonass;
    case GnssSystem::beidou:
      return Band::beidou;
    default:
      return Band::l1;
  }
}

/// Systems that give a position without another one.
bool is_major(std::uint8_t system) {
  switch (static_cast<GnssSystem>(system)) {
    case GnssSystem::gps:
    case GnssSystem::galileo:
    case GnssSystem::beidou:
    case GnssSystem::glonass:
      return true;
    default:
      return false;
  }
}

/// True when `paths` radio paths receive all enabled systems and one of them is a major one.
bool receivable(std::span<const CfgGnssBlock> systems, int paths) {
  std::array<bool, 3> bands{};
  bool major = false;
  for (const auto& block : systems) {
    if ((block.flags & 1U) != 0) {
      bands[static_cast<std::size_t>(band_of(block.system))] = true;
      major |= is_major(block.system);
    }
  }
  return major && std::ranges::count(bands, true) <= paths;
}

}  // namespace

bool UbloxConfiguration::set_rate(const CfgRate& wanted) {
  constexpr int kMoreTimeReferences_e2 = 1800;
  constexpr std::uint16_t kGreatestRatio = 127;
  const std::uint16_t greatest_reference = profile_->protocol_e2 >= kMoreTimeReferences_e2 ? 4 : 1;
  if (std::chrono::milliseconds{wanted.measurement_period_ms} < profile_->shortest_period ||
      wanted.time_reference > greatest_reference ||
      (profile_->navigation_ratio &&
       (wanted.navigation_ratio == 0 || wanted.navigation_ratio > kGreatestRatio))) {
    return false;
  }
  present_.rate = wanted;
  if (!profile_->navigation_ratio) {
    present_.rate.navigation_ratio = 1;  // protocols below 18 know no other
  }
  return true;
}

bool UbloxConfiguration::set_navigation(const CfgNav5& wanted) {
  // 0 portable .. 8 airborne 4 g; 9 wrist and 10 bike came later.
  const std::uint8_t greatest_model = profile_->generation < 8 ? 8 : 10;
  CfgNav5 next = present_.nav5;
  const auto has = [&](unsigned bit) { return (wanted.mask >> bit & 1U) != 0; };
  if (has(0)) next.dynamic_model = wanted.dynamic_model;
  if (has(1)) next.minimum_elevation_deg = wanted.minimum_elevation_deg;
  if (has(2)) {
    next.fix_mode = wanted.fix_mode;
    next.fixed_altitude_cm = wanted.fixed_altitude_cm;
    next.fixed_altitude_variance_e4m2 = wanted.fixed_altitude_variance_e4m2;
  }
  if (has(3)) next.dead_reckoning_limit_s = wanted.dead_reckoning_limit_s;
  if (has(4)) {
    next.position_dilution_mask_e1 = wanted.position_dilution_mask_e1;
    next.position_accuracy_mask_m = wanted.position_accuracy_mask_m;
  }
  if (has(5)) {
    next.time_dilution_mask_e1 = wanted.time_dilution_mask_e1;
    next.time_accuracy_mask_m = wanted.time_accuracy_mask_m;
  }
  if (has(6)) {
    next.static_hold_cmps = wanted.static_hold_cmps;
    next.static_hold_distance_m = wanted.static_hold_distance_m;
  }
  if (has(7)) next.differential_timeout_s = wanted.differential_timeout_s;
  if (has(8)) {
    next.cn0_satellites = wanted.cn0_satellites;
    next.cn0_threshold_dbhz = wanted.cn0_threshold_dbhz;
  }
  if (has(10)) next.utc_standard = wanted.utc_standard;
  constexpr std::uint8_t kReservedModel = 1;
  if (next.minimum_elevation_deg < -90 || next.minimum_elevation_deg > 90 || next.fix_mode < 1 ||
      next.fix_mode > 3 || next.dynamic_model > greatest_model ||
      next.dynamic_model == kReservedModel) {
    return false;
  }
  present_.nav5 = next;
  return true;
}

bool UbloxConfiguration::set_expert(const CfgNavx5& wanted) {
  CfgNavx5& next = present_.navx5;
  const auto has = [&](unsigned bit) { return (wanted.mask1 >> bit & 1U) != 0; };
  if (has(2)) {
    next.minimum_satellites = wanted.minimum_satellites;
    next.maximum_satellites = wanted.maximum_satellites;
  }
  if (has(3)) next.minimum_cn0_dbhz = wanted.minimum_cn0_dbhz;
  if (has(6)) next.initial_fix_3d = wanted.initial_fix_3d;
  if (has(9)) next.week_rollover = wanted.week_rollover;
  if (has(10)) next.acknowledge_aiding = wanted.acknowledge_aiding;
  if (has(13)) next.precise_point_positioning = wanted.precise_point_positioning;
  if (has(14)) {
    next.autonomous_orbits = wanted.autonomous_orbits;
    next.maximum_orbit_error_m = wanted.maximum_orbit_error_m;
  }
  return true;
}

bool UbloxConfiguration::set_odometer(const CfgOdo& wanted) {
  constexpr std::uint8_t kProfile = 0x07;
  constexpr std::uint8_t kCustom = 4;
  constexpr std::uint8_t kKnown = kOdoUse | kOdoFilteredSpeed | kOdoFilteredCourse;
  // The low-speed course filter is not emulated.
  if (!profile_->odometer || wanted.version != 0 || (wanted.flags & ~kKnown) != 0 ||
      (wanted.profile & kProfile) > kCustom) {
    return false;
  }
  CfgOdo& next = present_.odometer;
  const auto reserved = next.reserved;
  next = wanted;
  next.profile &= kProfile;
  next.reserved = reserved;
  return true;
}

bool UbloxConfiguration::set_systems(Payload payload) {
  if (payload.size() < CfgGnssHead::kLength) {
    return false;
  }
  const auto head = read_payload<CfgGnssHead>(payload);
  if (payload.size() != CfgGnssHead::kLength + head.blocks * CfgGnssBlock::kLength ||
      head.version != 0) {
    return false;
  }
  auto wanted = present_.systems;
  const auto systems = std::span(wanted).first(profile_->systems.size());
  for (std::size_t at = CfgGnssHead::kLength; at < payload.size(); at += CfgGnssBlock::kLength) {
    const auto block = read_payload<CfgGnssBlock>(payload.subspan(at));
    const auto found = std::ranges::find(systems, block.system, &CfgGnssBlock::system);
    if (found != systems.end()) {
      *found = block;
    } else if ((block.flags & 1U) != 0) {
      return false;  // a system that the chip does not have
    }
  }
  if (!receivable(systems, profile_->radio_paths)) {
    return false;
  }
  present_.systems = wanted;
  present_.gnss.used_channels = std::min(head.used_channels, present_.gnss.hardware_channels);
  return true;
}

bool UbloxConfiguration::set_sentences(Payload payload) {
  if (payload.size() != profile_->cfg_nmea_bytes ||
      payload.size() > CfgNmea::kLength + present_.nmea_tail.size()) {
    return false;
  }
  const auto wanted = read_payload<CfgNmea>(payload);
  if (std::ranges::find(profile_->nmea_versions, wanted.version) == profile_->nmea_versions.end()) {
    return false;
  }
  constexpr std::uint8_t kGreatestTalker = 7;
  if (wanted.main_talker > kGreatestTalker || wanted.gsv_talker > 1 ||
      wanted.satellite_numbering > 1) {
    return false;
  }
  present_.nmea = wanted;
  const Payload tail = payload.subspan(CfgNmea::kLength);
  std::copy_n(tail.begin(), std::min(tail.size(), present_.nmea_tail.size()),
              present_.nmea_tail.begin());
  return true;
}

bool UbloxConfiguration::set_pulse(const CfgTp5& wanted) {
  if (wanted.index >= present_.pulses.size()) {
    return false;
  }
  present_.pulses[wanted.index] = wanted;
  return true;
}

bool UbloxConfiguration::set_datum(Payload payload) {
  constexpr std::size_t kName = 2 /*number*/ + 6 /*name*/;
  if (payload.size() + kName != present_.datum.size()) {
    return false;
  }
  const std::span<std::uint8_t> datum(present_.datum);
  constexpr std::array<std::uint8_t, kName> kUser{0xFF, 0xFF, 'U', 'S', 'E', 'R', 0, 0};
  std::ranges::copy(kUser, datum.begin());
  std::ranges::copy(payload, datum.subspan(kName).begin());
  return true;
}

bool UbloxConfiguration::set_inventory(Payload payload) {
  if (payload.empty() || payload.size() > present_.remote_inventory.size()) {
    return false;
  }
  std::ranges::copy(payload, present_.remote_inventory.begin());
  present_.remote_inventory_bytes = payload.size();
  return true;
}

std::span<std::uint8_t> UbloxConfiguration::opaque(MessageId id) {
  if (id == kCfgPm2) return present_.power_management;
  if (id == kCfgUsb) return present_.usb;
  if (id == kCfgItfm) return present_.interference;
  if (id == kCfgLogfilter) return present_.log_filter;
  return {};
}

bool UbloxConfiguration::set_opaque(const FrameView& frame) {
  const auto target = opaque(frame.id);
  if (target.empty() || frame.payload.size() != target.size()) {
    return false;
  }
  const bool with_version = frame.id == kCfgPm2 || frame.id == kCfgLogfilter;
  if (with_version && frame.payload[0] != target[0]) {
    return false;
  }
  std::ranges::copy(frame.payload, target.begin());
  return true;
}

}  // namespace rigwire::emulators
