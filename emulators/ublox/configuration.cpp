#include "emulators/ublox/configuration.h"

#include <algorithm>
#include <chrono>
#include <cstdlib>

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

/// True when `paths` radio paths receive all enabled systems and one of them is a major one.
bool receivable(std::span<const CfgGnssBlock> systems, int paths) {
  std::array<bool, 3> bands{};
  for (const auto& block : systems) {
    if ((block.flags & 1U) != 0) {
      bands[static_cast<std::size_t>(band_of(block.system))] = true;
    }
  }
  return has_major_system(systems) && std::ranges::count(bands, true) <= paths;
}

}  // namespace

UbloxConfiguration::UbloxConfiguration(const UbloxSettings& settings)
    : profile_(settings.profile),
      default_(default_state(settings)),
      saved_(default_),
      present_(default_) {
  if (profile_->key_items) {
    keys_.emplace(*profile_, default_);
  }
}

bool UbloxConfiguration::is_poll(const FrameView& frame) const {
  const std::size_t length = frame.payload.size();
  if (keys_ && keys_->handles(frame.id)) {
    return keys_->is_poll(frame);
  }
  if (frame.id == CfgMsg::kId) {
    return length == 2;
  }
  if (frame.id == CfgInf::kId) {
    return length == 1;
  }
  if (frame.id == CfgPrt::kId || frame.id == CfgTp5::kId) {
    return length <= 1;
  }
  return length == 0;
}

template <class Message>
Payload UbloxConfiguration::reply(const Message& message) {
  const auto payload = std::span(reply_).first(Message::kLength);
  write_payload(message, payload);
  return payload;
}

Payload UbloxConfiguration::reply_systems() {
  const std::span<std::uint8_t> all = reply_;
  write_payload(present_.gnss, all.first(CfgGnssHead::kLength));
  std::size_t at = CfgGnssHead::kLength;
  for (const auto& block : std::span(present_.systems).first(profile_->systems.size())) {
    write_payload(block, all.subspan(at, CfgGnssBlock::kLength));
    at += CfgGnssBlock::kLength;
  }
  return all.first(at);
}

Payload UbloxConfiguration::reply_sentences() {
  const std::span<std::uint8_t> all = reply_;
  write_payload(present_.nmea, all.first(CfgNmea::kLength));
  if (profile_->cfg_nmea_bytes > CfgNmea::kLength) {
    all[CfgNmea::kLength - 1] = 1;  // version of the longer form
  }
  std::ranges::copy(present_.nmea_tail, all.subspan(CfgNmea::kLength).begin());
  return all.first(profile_->cfg_nmea_bytes);
}

std::optional<Payload> UbloxConfiguration::poll(const FrameView& frame) {
  const MessageId id = frame.id;
  if (keys_) {
    if (keys_->handles(id)) {
      const std::size_t size = keys_->poll(present_, frame, reply_);
      return size == 0 ? std::nullopt : std::optional(Payload(reply_).first(size));
    }
    keys_->interrupt();
  }
  const std::uint8_t selector = frame.payload.empty() ? 0 : frame.payload[0];
  if (id == CfgPrt::kId) {
    const std::size_t port = frame.payload.empty() ? kPortUart1 : selector;
    return port < present_.ports.size() ? std::optional(reply(present_.ports[port])) : std::nullopt;
  }
  if (id == CfgMsg::kId) {
    const std::size_t index =
        message_index(*profile_, MessageId{frame.payload[0], frame.payload[1]});
    if (index == profile_->messages.size() || !profile_->messages[index].periodic) {
      return std::nullopt;
    }
    return reply(CfgMsg{frame.payload[0], frame.payload[1], present_.rates[index]});
  }
  if (id == CfgInf::kId) {
    const auto found = std::ranges::find(present_.information, selector, &CfgInf::protocol);
    return found == present_.information.end() ? std::nullopt : std::optional(reply(*found));
  }
  if (id == CfgTp5::kId) {
    return selector < present_.pulses.size() ? std::optional(reply(present_.pulses[selector]))
                                             : std::nullopt;
  }
  if (id == CfgRate::kId) return reply(present_.rate);
  if (id == CfgNav5::kId) return reply(present_.nav5);
  if (id == CfgNavx5::kId) return reply(present_.navx5);
  if (id == CfgOdo::kId && profile_->odometer) return reply(present_.odometer);
  if (id == CfgPms::kId && profile_->power_modes) return reply(CfgPms{});
  if (id == CfgNmea::kId) return reply_sentences();
  if (id == CfgGnssHead::kId) return reply_systems();
  if (id == kCfgDat) return Payload(present_.datum);
  if (id == kCfgRinv) {
    return Payload(present_.remote_inventory).first(present_.remote_inventory_bytes);
  }
  if (const auto bytes = opaque(id); !bytes.empty()) return Payload(bytes);
  if (id == CfgSbas::kId) return reply(present_.sbas);
  if (id == CfgTmode3::kId && profile_->carrier_solution) return reply(base_mode(present_));
  if (id == CfgAnt::kId) return reply(present_.antenna);
  if (id == CfgRxm::kId) return reply(present_.power);
  return std::nullopt;
}

bool UbloxConfiguration::set(const FrameView& frame) {
  const MessageId id = frame.id;
  if (keys_) {
    if (keys_->handles(id)) {
      return keys_->set(present_, frame);
    }
    keys_->interrupt();
  }
  if (id == CfgPrt::kId) return set_ports(frame.payload);
  if (id == CfgMsg::kId) return set_message(frame.payload);
  if (id == CfgInf::kId) return set_information(frame.payload);
  if (id == CfgGnssHead::kId) return set_systems(frame.payload);
  if (id == CfgNmea::kId) return set_sentences(frame.payload);
  if (id == CfgCfg::kId) return set_store(frame.payload);
  if (id == kCfgDat) return set_datum(frame.payload);
  if (id == kCfgRinv) return set_inventory(frame.payload);
  if (const auto wanted = decode<CfgRate>(frame); wanted.ok()) return set_rate(*wanted);
  if (const auto wanted = decode<CfgNav5>(frame); wanted.ok()) return set_navigation(*wanted);
  if (const auto wanted = decode<CfgNavx5>(frame); wanted.ok()) return set_expert(*wanted);
  if (const auto wanted = decode<CfgTp5>(frame); wanted.ok()) return set_pulse(*wanted);
  if (const auto wanted = decode<CfgOdo>(frame); wanted.ok()) return set_odometer(*wanted);
  if (const auto wanted = decode<CfgPms>(frame); wanted.ok()) {
    return profile_->power_modes && *wanted == CfgPms{};  // no power saving is emulated
  }
  if (const auto wanted = decode<CfgSbas>(frame); wanted.ok()) {
    present_.sbas = *wanted;
    return true;
  }
  if (const auto wanted = decode<CfgTmode3>(frame); wanted.ok()) return set_base(*wanted);
  if (const auto wanted = decode<CfgAnt>(frame); wanted.ok()) {
    present_.antenna = *wanted;
    return true;
  }
  if (const auto wanted = decode<CfgRxm>(frame); wanted.ok()) {
    if (wanted->low_power_mode != 0) {  // power save is not emulated
      return false;
    }
    present_.power = *wanted;
    return true;
  }
  return set_opaque(frame);
}

void UbloxConfiguration::reload() {
  if (keys_) {
    keys_->reload(present_);
  } else {
    present_ = saved_;
  }
}

void UbloxConfiguration::forget() {
  saved_ = default_;
  if (keys_) {
    keys_->forget();
  }
}

bool UbloxConfiguration::text_enabled(std::uint8_t protocol, unsigned kind_bit) const {
  const auto found = std::ranges::find(present_.information, protocol, &CfgInf::protocol);
  return found != present_.information.end() && (found->masks[kPortUart1] >> kind_bit & 1U) != 0;
}

bool UbloxConfiguration::enabled(GnssSystem system) const {
  return (flags_of(system) & 1U) != 0;
}

bool UbloxConfiguration::second_enabled(GnssSystem system) const {
  const unsigned bit = system == GnssSystem::galileo ? 21 : 20;
  return enabled(system) && (flags_of(system) >> bit & 1U) != 0;
}

/// Returns the flags of the system in CFG-GNSS; 0 if the type does not have the system.
std::uint32_t UbloxConfiguration::flags_of(GnssSystem system) const {
  const auto systems = std::span(present_.systems).first(profile_->systems.size());
  const auto found =
      std::ranges::find(systems, static_cast<std::uint8_t>(system), &CfgGnssBlock::system);
  return found != systems.end() ? found->flags : 0U;
}

// Ports and memory: CFG-PRT, CFG-MSG, CFG-INF and CFG-CFG.

bool UbloxConfiguration::set_port(const CfgPrt& port) {
  if (port.port >= present_.ports.size()) {
    return false;
  }
  if (port.port == kPortUart1 && !line_is_sound(*profile_, port)) {
    return false;
  }
  CfgPrt& present = present_.ports[port.port];
  present = port;
  present.input_protocols =
      static_cast<std::uint16_t>(port.input_protocols & profile_->input_protocols);
  present.output_protocols =
      static_cast<std::uint16_t>(port.output_protocols & profile_->output_protocols);
  return true;
}

bool UbloxConfiguration::set_ports(Payload payload) {
  if (payload.empty() || payload.size() % CfgPrt::kLength != 0) {
    return false;
  }
  const UbloxConfigurationState before = present_;
  for (std::size_t at = 0; at < payload.size(); at += CfgPrt::kLength) {
    if (!set_port(read_payload<CfgPrt>(payload.subspan(at)))) {
      present_ = before;
      return false;
    }
  }
  return true;
}

bool UbloxConfiguration::set_rate(std::size_t index, std::size_t port, std::uint8_t rate) {
  if (index >= profile_->messages.size() || !profile_->messages[index].periodic || port >= kPorts) {
    return false;
  }
  present_.rates[index][port] = rate;
  return true;
}

bool UbloxConfiguration::set_message(Payload payload) {
  if (payload.size() != 3 && payload.size() != CfgMsg::kLength) {
    return false;
  }
  const std::size_t index = message_index(*profile_, MessageId{payload[0], payload[1]});
  if (payload.size() == 3) {
    return set_rate(index, kPortUart1, payload[2]);
  }
  const auto wanted = read_payload<CfgMsg>(payload);
  if (index == profile_->messages.size() || !profile_->messages[index].periodic) {
    return false;
  }
  present_.rates[index] = wanted.rates;
  return true;
}

bool UbloxConfiguration::set_information(Payload payload) {
  if (payload.empty() || payload.size() % CfgInf::kLength != 0) {
    return false;
  }
  auto wanted = present_.information;
  for (std::size_t at = 0; at < payload.size(); at += CfgInf::kLength) {
    const auto block = read_payload<CfgInf>(payload.subspan(at));
    const auto found = std::ranges::find(wanted, block.protocol, &CfgInf::protocol);
    if (found == wanted.end()) {
      return false;
    }
    *found = block;
  }
  present_.information = wanted;
  return true;
}

bool UbloxConfiguration::set_store(Payload payload) {
  if (payload.size() != CfgCfg::kLength && payload.size() != CfgCfg::kLength + 1 /*devices*/) {
    return false;
  }
  const auto masks = read_payload<CfgCfg>(payload);
  copy_sections(default_, saved_, masks.clear_mask);
  copy_sections(present_, saved_, masks.save_mask);
  copy_sections(saved_, present_, masks.load_mask);
  return true;
}

// Navigation and sentences: CFG-RATE, NAV5, NAVX5, ODO, GNSS, NMEA, TP5, DAT, RINV.

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

bool UbloxConfiguration::set_base(const CfgTmode3& wanted) {
  constexpr std::uint16_t kKnown = kTmodeGeodetic | 0x00FF;
  constexpr int kGreatestRest = 99;
  const bool rest_fits = std::ranges::all_of(wanted.position_rest, [](std::int8_t rest) {
    return rest >= -kGreatestRest && rest <= kGreatestRest;
  });
  constexpr std::int32_t kPole_e7deg = 900'000'000;
  constexpr std::int32_t kTurn_e7deg = 1'800'000'000;
  const bool on_earth =
      (wanted.flags & kTmodeGeodetic) == 0 ||
      (std::abs(wanted.position[0]) <= kPole_e7deg && std::abs(wanted.position[1]) <= kTurn_e7deg);
  if (!profile_->carrier_solution || wanted.version != 0 || (wanted.flags & ~kKnown) != 0 ||
      wanted.mode() > kTmodeFixed || !rest_fits || !on_earth) {
    return false;
  }
  set_base_mode(present_, wanted);
  return true;
}

bool UbloxConfiguration::set_odometer(const CfgOdo& wanted) {
  constexpr std::uint8_t kProfile = 0x07;
  constexpr std::uint8_t kCustom = 4;
  constexpr std::uint8_t kKnown =
      kOdoUse | kOdoLowSpeedCourse | kOdoFilteredSpeed | kOdoFilteredCourse;
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
