#include "emulators/ublox/configuration.h"

#include <algorithm>
#include <chrono>
#include <string>

#include "protocols/bytes.h"

namespace rigwire::emulators {
namespace {

using namespace protocols::ubx;
using Payload = std::span<const std::uint8_t>;

constexpr std::uint32_t kFraming8N1 = 0x08C0;
constexpr std::uint32_t kFramingMask = 0x3EC0;
constexpr std::uint16_t kInputProtocols = 0x0007;
constexpr std::uint16_t kOutputProtocols = 0x0003;
constexpr std::uint16_t kShortestPeriod_ms = 50;
constexpr std::array<std::uint8_t, 3> kInformationProtocols{0, 1, 3};

constexpr std::uint8_t kGps = 0;
constexpr std::uint8_t kSbas = 1;
constexpr std::uint8_t kQzss = 5;
constexpr std::uint8_t kGlonass = 6;

// Sections of CFG-CFG.
constexpr std::uint32_t kIoPort = 0x001;
constexpr std::uint32_t kMessages = 0x002;
constexpr std::uint32_t kInformation = 0x004;
constexpr std::uint32_t kNavigation = 0x008;
constexpr std::uint32_t kReceiver = 0x010;
constexpr std::uint32_t kAntenna = 0x400;

std::array<CfgPrt, 5> default_ports(std::uint32_t baud) {
  std::array<CfgPrt, 5> ports{};
  ports[kPortDdc] = {0, 0, 0x84, 0, kInputProtocols, kOutputProtocols, 0};
  ports[kPortUart1] = {1, 0, kFraming8N1, baud, kInputProtocols, kOutputProtocols, 0};
  ports[kPortUart2] = {2, 0, 0x38C0, 0, 0, 0, 0};
  ports[kPortUsb] = {3, 0, 0, 0, kInputProtocols, kOutputProtocols, 0};
  ports[kPortSpi] = {4, 0, 0x3200, 0, kInputProtocols, kOutputProtocols, 0};
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

std::array<CfgTp5, 2> default_pulses() {
  std::array<CfgTp5, 2> pulses{};
  pulses[0] = {0, 0, 50, 0, 1'000'000, 1'000'000, 0, 100'000, 0, 0xF7};
  pulses[1] = {1, 0, 50, 0, 4, 1, 125'000, 100'000, 0, 0xFE};
  return pulses;
}

}  // namespace

UbloxConfiguration::UbloxConfiguration(const UbloxSettings& settings) {
  State& s = default_;
  s.ports = default_ports(settings.baud);
  const auto switch_on = [&](const std::vector<std::string>& names) {
    for (const auto& name : names) {
      s.rates[ublox_message_index(name)] = {1, 1, 1, 1, 1, 1};
    }
  };
  switch_on(settings.nmea_sentences);
  switch_on(settings.ubx_messages);
  for (std::size_t i = 0; i < kInformationProtocols.size(); ++i) {
    s.information[i].protocol = kInformationProtocols[i];
  }
  s.information[1].masks.fill(0x87);
  s.rate = {static_cast<std::uint16_t>(settings.measurement_period / std::chrono::milliseconds{1}),
            1, 1};
  s.nav5 = default_navigation();
  s.navx5.minimum_satellites = 3;
  s.navx5.maximum_satellites = 22;
  s.navx5.minimum_cn0_dbhz = 7;
  s.navx5.week_rollover = 1691;
  s.navx5.precise_point_positioning = 1;
  s.navx5.maximum_orbit_error_m = 100;
  s.nmea.version = 0x23;
  s.nmea.flags = 0x02;
  s.sbas = {1, 3, 3, 0, 0x0006A2D1};
  s.antenna = {0x001B, 0xB9F0};
  s.power = {8, 0};
  s.pulses = default_pulses();
  s.gnss = {0, 22, 22, 4};
  s.systems = {CfgGnssBlock{kGps, 4, 255, 1}, CfgGnssBlock{kSbas, 1, 3, 1},
               CfgGnssBlock{kQzss, 0, 3, 1}, CfgGnssBlock{kGlonass, 8, 255, 0}};
  saved_ = default_;
  present_ = default_;
}

bool UbloxConfiguration::is_poll(const FrameView& frame) {
  const std::size_t length = frame.payload.size();
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

std::optional<Payload> UbloxConfiguration::poll(const FrameView& frame) {
  const MessageId id = frame.id;
  const std::uint8_t selector = frame.payload.empty() ? 0 : frame.payload[0];
  if (id == CfgPrt::kId) {
    const std::size_t port = frame.payload.empty() ? kPortUart1 : selector;
    return port < present_.ports.size() ? std::optional(reply(present_.ports[port])) : std::nullopt;
  }
  if (id == CfgMsg::kId) {
    const std::size_t index = ublox_message_index(MessageId{frame.payload[0], frame.payload[1]});
    if (index == ublox_messages().size()) {
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
  if (id == CfgGnssHead::kId) {
    const std::span<std::uint8_t> all = reply_;
    write_payload(present_.gnss, all.first(CfgGnssHead::kLength));
    std::size_t at = CfgGnssHead::kLength;
    for (const auto& block : present_.systems) {
      write_payload(block, all.subspan(at, CfgGnssBlock::kLength));
      at += CfgGnssBlock::kLength;
    }
    return all.first(at);
  }
  if (id == CfgRate::kId) return reply(present_.rate);
  if (id == CfgNav5::kId) return reply(present_.nav5);
  if (id == CfgNavx5::kId) return reply(present_.navx5);
  if (id == CfgNmea::kId) return reply(present_.nmea);
  if (id == CfgSbas::kId) return reply(present_.sbas);
  if (id == CfgAnt::kId) return reply(present_.antenna);
  if (id == CfgRxm::kId) return reply(present_.power);
  return std::nullopt;
}

bool UbloxConfiguration::set(const FrameView& frame) {
  const MessageId id = frame.id;
  if (id == CfgPrt::kId) return set_ports(frame.payload);
  if (id == CfgMsg::kId) return set_message(frame.payload);
  if (id == CfgInf::kId) return set_information(frame.payload);
  if (id == CfgGnssHead::kId) return set_systems(frame.payload);
  if (id == CfgCfg::kId) return set_store(frame.payload);
  if (const auto wanted = decode<CfgRate>(frame); wanted.ok()) return set_rate(*wanted);
  if (const auto wanted = decode<CfgNav5>(frame); wanted.ok()) return set_navigation(*wanted);
  if (const auto wanted = decode<CfgNavx5>(frame); wanted.ok()) return set_expert(*wanted);
  if (const auto wanted = decode<CfgNmea>(frame); wanted.ok()) {
    if (wanted->version != 0x21 && wanted->version != 0x23) {
      return false;
    }
    present_.nmea = *wanted;
    return true;
  }
  if (const auto wanted = decode<CfgSbas>(frame); wanted.ok()) {
    present_.sbas = *wanted;
    return true;
  }
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
  if (const auto wanted = decode<CfgTp5>(frame); wanted.ok()) {
    if (wanted->index >= present_.pulses.size()) {
      return false;
    }
    present_.pulses[wanted->index] = *wanted;
    return true;
  }
  return false;
}

bool UbloxConfiguration::set_port(const CfgPrt& port) {
  if (port.port >= present_.ports.size()) {
    return false;
  }
  const bool uart = port.port == kPortUart1;
  if (uart && ((port.mode & kFramingMask) != kFraming8N1 ||
               std::ranges::find(ublox_bauds(), port.baud) == ublox_bauds().end())) {
    return false;
  }
  CfgPrt& present = present_.ports[port.port];
  present = port;
  present.input_protocols &= kInputProtocols;
  present.output_protocols &= kOutputProtocols;
  return true;
}

bool UbloxConfiguration::set_ports(Payload payload) {
  if (payload.empty() || payload.size() % CfgPrt::kLength != 0) {
    return false;
  }
  const State before = present_;
  for (std::size_t at = 0; at < payload.size(); at += CfgPrt::kLength) {
    if (!set_port(read_payload<CfgPrt>(payload.subspan(at)))) {
      present_ = before;
      return false;
    }
  }
  return true;
}

bool UbloxConfiguration::set_rate(std::size_t message_index, std::size_t port, std::uint8_t rate) {
  if (message_index >= ublox_messages().size() || port >= kPorts ||
      (rate != 0 && ublox_messages()[message_index].greatest_bytes == 0)) {
    return false;
  }
  present_.rates[message_index][port] = rate;
  return true;
}

bool UbloxConfiguration::set_message(Payload payload) {
  if (payload.size() != 3 && payload.size() != CfgMsg::kLength) {
    return false;
  }
  const std::size_t index = ublox_message_index(MessageId{payload[0], payload[1]});
  if (payload.size() == 3) {
    return set_rate(index, kPortUart1, payload[2]);
  }
  const auto wanted = read_payload<CfgMsg>(payload);
  const bool any = std::ranges::any_of(wanted.rates, [](std::uint8_t rate) { return rate != 0; });
  if (index == ublox_messages().size() || (any && ublox_messages()[index].greatest_bytes == 0)) {
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

bool UbloxConfiguration::set_rate(const CfgRate& wanted) {
  if (wanted.measurement_period_ms < kShortestPeriod_ms || wanted.time_reference > 1) {
    return false;
  }
  present_.rate = wanted;
  present_.rate.navigation_ratio = 1;  // protocols below 18 know no other
  return true;
}

bool UbloxConfiguration::set_navigation(const CfgNav5& wanted) {
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
  if (has(6)) next.static_hold_cmps = wanted.static_hold_cmps;
  if (has(7)) next.differential_timeout_s = wanted.differential_timeout_s;
  if (next.fix_mode < 1 || next.fix_mode > 3 || next.dynamic_model > 8 || next.dynamic_model == 1) {
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
  for (std::size_t at = CfgGnssHead::kLength; at < payload.size(); at += CfgGnssBlock::kLength) {
    const auto block = read_payload<CfgGnssBlock>(payload.subspan(at));
    const auto found = std::ranges::find(wanted, block.system, &CfgGnssBlock::system);
    if (found != wanted.end()) {
      *found = block;
    } else if ((block.flags & 1U) != 0) {
      return false;  // a system that the chip does not have
    }
  }
  const auto enabled = [&](std::uint8_t system) {
    return (std::ranges::find(wanted, system, &CfgGnssBlock::system)->flags & 1U) != 0;
  };
  // One radio path: GLONASS on its own, or the others.
  const bool others = enabled(kGps) || enabled(kSbas) || enabled(kQzss);
  if ((enabled(kGlonass) && others) || (!enabled(kGlonass) && !enabled(kGps))) {
    return false;
  }
  present_.systems = wanted;
  present_.gnss.used_channels = std::min(head.used_channels, present_.gnss.hardware_channels);
  return true;
}

bool UbloxConfiguration::set_store(Payload payload) {
  if (payload.size() != CfgCfg::kLength && payload.size() != CfgCfg::kLength + 1) {
    return false;
  }
  const auto masks = read_payload<CfgCfg>(payload);
  const auto copy = [](const State& from, State& to, std::uint32_t mask) {
    if ((mask & kIoPort) != 0) to.ports = from.ports;
    if ((mask & kMessages) != 0) to.rates = from.rates;
    if ((mask & kInformation) != 0) to.information = from.information;
    if ((mask & kNavigation) != 0) {
      to.rate = from.rate;
      to.nav5 = from.nav5;
      to.navx5 = from.navx5;
      to.nmea = from.nmea;
      to.pulses = from.pulses;
      to.sbas = from.sbas;
    }
    if ((mask & kReceiver) != 0) {
      to.power = from.power;
      to.gnss = from.gnss;
      to.systems = from.systems;
    }
    if ((mask & kAntenna) != 0) to.antenna = from.antenna;
  };
  copy(default_, saved_, masks.clear_mask);
  copy(present_, saved_, masks.save_mask);
  copy(saved_, present_, masks.load_mask);
  return true;
}

bool UbloxConfiguration::text_enabled(unsigned kind_bit) const {
  return (present_.information[1].masks[kPortUart1] >> kind_bit & 1U) != 0;
}

bool UbloxConfiguration::gps_enabled() const {
  return (present_.systems[0].flags & 1U) != 0;
}

}  // namespace rigwire::emulators
