#include "emulators/ublox/key_map.h"

#include <algorithm>
#include <array>
#include <span>
#include <type_traits>

#include "protocols/ubx/configuration_keys.h"

namespace rigwire::emulators {
namespace {

namespace ubx = protocols::ubx;
using State = UbloxConfigurationState;

/// A field of the state that is also an item.
struct Binding {
  std::uint32_t key = 0;
  std::uint64_t (*read)(const State& state) = nullptr;
  void (*write)(State& state, std::uint64_t value) = nullptr;
};

// kField is a lambda from a state to a reference to one of its integers.

template <auto kField>
constexpr Binding whole(std::uint32_t key) {
  return {key,
          [](const State& s) -> std::uint64_t {
            using Integer = std::remove_cvref_t<decltype(kField(s))>;
            return static_cast<std::make_unsigned_t<Integer>>(kField(s));
          },
          [](State& s, std::uint64_t value) {
            using Integer = std::remove_cvref_t<decltype(kField(s))>;
            kField(s) = static_cast<Integer>(value);
          }};
}

/// A member of one of the state's messages.
template <auto kMessage, auto kMember>
constexpr auto kMemberOf = [](auto& s) -> auto& {
  return s.*kMessage.*kMember;
};
template <auto kMessage, auto kMember>
constexpr Binding field(std::uint32_t key) {
  return whole<kMemberOf<kMessage, kMember>>(key);
}
/// A member of the first time pulse.
template <auto kMember>
constexpr auto kPulseMember = [](auto& s) -> auto& {
  return s.pulses[0].*kMember;
};
template <auto kMember>
constexpr Binding pulse(std::uint32_t key) {
  return whole<kPulseMember<kMember>>(key);
}

template <auto kField, unsigned kBit, unsigned kWidth = 1>
constexpr Binding bits(std::uint32_t key) {
  constexpr std::uint32_t kMask = (1U << kWidth) - 1U;
  return {key,
          [](const State& s) -> std::uint64_t {
            return static_cast<std::uint32_t>(kField(s)) >> kBit & kMask;
          },
          [](State& s, std::uint64_t value) {
            using Integer = std::remove_cvref_t<decltype(kField(s))>;
            const auto shifted = (static_cast<std::uint32_t>(value) & kMask) << kBit;
            kField(s) = static_cast<Integer>((kField(s) & ~(kMask << kBit)) | shifted);
          }};
}

constexpr unsigned kUbx = 0;
constexpr unsigned kNmea = 1;
constexpr unsigned kRtcm3 = 5;
constexpr unsigned kSpartn = 6;

template <std::size_t kPort>
constexpr auto kInput = [](auto& s) -> auto& {
  return s.ports[kPort].input_protocols;
};
template <std::size_t kPort>
constexpr auto kOutput = [](auto& s) -> auto& {
  return s.ports[kPort].output_protocols;
};
template <std::size_t kPort>
constexpr auto kBaud = [](auto& s) -> auto& {
  return s.ports[kPort].baud;
};

// Framing in the mode word of CFG-PRT: bits 6..7 length, 9..11 parity, 12..13 stop bits.

// CFG-UART-STOPBITS counts halves from 0.5; the mode word has 1, 1.5, 2, 0.5.
template <std::size_t kPort>
constexpr Binding stop_bits(std::uint32_t key) {
  return {key,
          [](const State& s) -> std::uint64_t { return ((s.ports[kPort].mode >> 12U) + 1U) & 3U; },
          [](State& s, std::uint64_t value) {
            const auto code = static_cast<std::uint32_t>(value + 3U) & 3U;
            s.ports[kPort].mode = (s.ports[kPort].mode & ~0x3000U) | code << 12U;
          }};
}
// 0 is eight, 1 seven; in the mode word 3 and 2.
template <std::size_t kPort>
constexpr Binding data_bits(std::uint32_t key) {
  return {key,
          [](const State& s) -> std::uint64_t {
            return (s.ports[kPort].mode >> 6U & 3U) == 3U ? 0U : 1U;
          },
          [](State& s, std::uint64_t value) {
            s.ports[kPort].mode = (s.ports[kPort].mode & ~0xC0U) | (value == 0 ? 0xC0U : 0x80U);
          }};
}
// 0 none, 1 odd, 2 even; in the mode word 4, 1, 0.
template <std::size_t kPort>
constexpr Binding parity(std::uint32_t key) {
  return {key,
          [](const State& s) -> std::uint64_t {
            const auto code = s.ports[kPort].mode >> 9U & 7U;
            return (code & 4U) != 0 ? 0U : code == 1 ? 1U : 2U;
          },
          [](State& s, std::uint64_t value) {
            const std::uint32_t code = value == 0 ? 4U : value == 1 ? 1U : 0U;
            s.ports[kPort].mode = (s.ports[kPort].mode & ~0xE00U) | code << 9U;
          }};
}

// NMEA versions by number of the item and of CFG-NMEA.
constexpr std::array<std::pair<std::uint8_t, std::uint8_t>, 5> kNmeaVersions{
    {{21, 0x21}, {23, 0x23}, {40, 0x40}, {41, 0x41}, {42, 0x4B}}};

constexpr Binding nmea_version(std::uint32_t key) {
  return {key,
          [](const State& s) -> std::uint64_t {
            for (const auto& [item, field] : kNmeaVersions) {
              if (field == s.nmea.version) return item;
            }
            return 0;
          },
          [](State& s, std::uint64_t value) {
            for (const auto& [item, field] : kNmeaVersions) {
              if (item == value) s.nmea.version = field;
            }
          }};
}

constexpr Binding talker_of_beidou(std::uint32_t key) {
  return {key,
          [](const State& s) -> std::uint64_t { return s.nmea_tail[0] | s.nmea_tail[1] << 8U; },
          [](State& s, std::uint64_t value) {
            s.nmea_tail[0] = static_cast<std::uint8_t>(value);
            s.nmea_tail[1] = static_cast<std::uint8_t>(value >> 8U);
          }};
}

constexpr Binding sbas_satellites(std::uint32_t key) {
  return {key,
          [](const State& s) -> std::uint64_t {
            return s.sbas.scan_mode1 | std::uint64_t{s.sbas.scan_mode2} << 32U;
          },
          [](State& s, std::uint64_t value) {
            s.sbas.scan_mode1 = static_cast<std::uint32_t>(value);
            s.sbas.scan_mode2 = static_cast<std::uint8_t>(value >> 32U);
          }};
}

/// A bit of a system's flags in CFG-GNSS: 0 on, 16..23 its signals.
template <GnssSystem kSystem, unsigned kBit>
constexpr Binding system(std::uint32_t key) {
  return {key,
          [](const State& s) -> std::uint64_t {
            const auto found = std::ranges::find(s.systems, static_cast<std::uint8_t>(kSystem),
                                                 &ubx::CfgGnssBlock::system);
            return found == s.systems.end() ? 0U : found->flags >> kBit & 1U;
          },
          [](State& s, std::uint64_t value) {
            const auto found = std::ranges::find(s.systems, static_cast<std::uint8_t>(kSystem),
                                                 &ubx::CfgGnssBlock::system);
            if (found != s.systems.end()) {
              found->flags = (found->flags & ~(1U << kBit)) | (value == 0 ? 0U : 1U << kBit);
            }
          }};
}

template <std::size_t kProtocol, std::size_t kPort>
constexpr auto kMask = [](auto& s) -> auto& {
  return s.information[kProtocol].masks[kPort];
};
/// The items of one port, by its number in CFG-PRT: what goes in and out over it, and its texts.
template <std::size_t kPort>
constexpr std::array<Binding, 9> items_of_port() {
  constexpr std::uint32_t kIn = 0x10710000 + kPort * 0x20000;
  constexpr std::uint32_t kOut = kIn + 0x10000;
  return {bits<kInput<kPort>, kUbx>(kIn + 1),        bits<kInput<kPort>, kNmea>(kIn + 2),
          bits<kInput<kPort>, kRtcm3>(kIn + 4),      bits<kInput<kPort>, kSpartn>(kIn + 5),
          bits<kOutput<kPort>, kUbx>(kOut + 1),      bits<kOutput<kPort>, kNmea>(kOut + 2),
          bits<kOutput<kPort>, kRtcm3>(kOut + 4),    whole<kMask<0, kPort>>(0x20920001 + kPort),
          whole<kMask<1, kPort>>(0x20920006 + kPort)};
}
/// Speed and framing of UART1 and UART2.
template <std::size_t kPort>
constexpr std::array<Binding, 4> items_of_uart() {
  constexpr std::uint32_t kGroup = (0x51 + kPort) << 16U;
  return {whole<kBaud<kPort>>(0x40000001 | kGroup), stop_bits<kPort>(0x20000002 | kGroup),
          data_bits<kPort>(0x20000003 | kGroup), parity<kPort>(0x20000004 | kGroup)};
}

constexpr auto kAntenna = kMemberOf<&State::antenna, &ubx::CfgAnt::flags>;
constexpr auto kAntennaPins = kMemberOf<&State::antenna, &ubx::CfgAnt::pins>;
constexpr auto kPulse = kPulseMember<&ubx::CfgTp5::flags>;
constexpr auto kSentenceFlags = kMemberOf<&State::nmea, &ubx::CfgNmea::flags>;
constexpr auto kSentenceFilter = kMemberOf<&State::nmea, &ubx::CfgNmea::filter>;
constexpr auto kSystemFilter = kMemberOf<&State::nmea, &ubx::CfgNmea::systems_to_filter>;
constexpr auto kOdometer = kMemberOf<&State::odometer, &ubx::CfgOdo::flags>;
constexpr auto kSbasMode = kMemberOf<&State::sbas, &ubx::CfgSbas::mode>;
constexpr auto kSbasUsage = kMemberOf<&State::sbas, &ubx::CfgSbas::usage>;

constexpr auto kBaseFlags = kMemberOf<&State::base, &ubx::CfgTmode3::flags>;
template <auto kArray, std::size_t kIndex>
constexpr auto kElement = [](auto& s) -> auto& {
  return (s.*kArray)[kIndex];
};
template <auto kMember>
constexpr auto kOwn = [](auto& s) -> auto& {
  return s.*kMember;
};

// NOLINTBEGIN(readability-magic-numbers): the numbers are the items' own, see configuration_keys.h
// clang-format off
constexpr std::array kBindings{
    // Rate
    field<&State::rate, &ubx::CfgRate::measurement_period_ms>(0x30210001),
    field<&State::rate, &ubx::CfgRate::navigation_ratio>(0x30210002),
    field<&State::rate, &ubx::CfgRate::time_reference>(0x20210003),
    // Navigation
    field<&State::nav5, &ubx::CfgNav5::fix_mode>(0x20110011),
    field<&State::navx5, &ubx::CfgNavx5::initial_fix_3d>(0x10110013),
    field<&State::navx5, &ubx::CfgNavx5::week_rollover>(0x30110017),
    field<&State::nav5, &ubx::CfgNav5::utc_standard>(0x2011001C),
    field<&State::nav5, &ubx::CfgNav5::dynamic_model>(0x20110021),
    field<&State::navx5, &ubx::CfgNavx5::acknowledge_aiding>(0x10110025),
    field<&State::navx5, &ubx::CfgNavx5::minimum_satellites>(0x201100A1),
    field<&State::navx5, &ubx::CfgNavx5::maximum_satellites>(0x201100A2),
    field<&State::navx5, &ubx::CfgNavx5::minimum_cn0_dbhz>(0x201100A3),
    field<&State::nav5, &ubx::CfgNav5::minimum_elevation_deg>(0x201100A4),
    field<&State::nav5, &ubx::CfgNav5::cn0_satellites>(0x201100AA),
    field<&State::nav5, &ubx::CfgNav5::cn0_threshold_dbhz>(0x201100AB),
    field<&State::nav5, &ubx::CfgNav5::position_dilution_mask_e1>(0x301100B1),
    field<&State::nav5, &ubx::CfgNav5::time_dilution_mask_e1>(0x301100B2),
    field<&State::nav5, &ubx::CfgNav5::position_accuracy_mask_m>(0x301100B3),
    field<&State::nav5, &ubx::CfgNav5::time_accuracy_mask_m>(0x301100B4),
    field<&State::nav5, &ubx::CfgNav5::fixed_altitude_cm>(0x401100C1),
    field<&State::nav5, &ubx::CfgNav5::fixed_altitude_variance_e4m2>(0x401100C2),
    field<&State::nav5, &ubx::CfgNav5::differential_timeout_s>(0x201100C4),
    field<&State::nav5, &ubx::CfgNav5::static_hold_cmps>(0x20250038),
    field<&State::nav5, &ubx::CfgNav5::static_hold_distance_m>(0x3025003B),
    // NMEA
    nmea_version(0x20930001),
    field<&State::nmea, &ubx::CfgNmea::maximum_satellites>(0x20930002),
    bits<kSentenceFlags, 0>(0x10930003),
    bits<kSentenceFlags, 1>(0x10930004),
    bits<kSentenceFlags, 2>(0x10930005),
    bits<kSentenceFlags, 3>(0x10930006),
    field<&State::nmea, &ubx::CfgNmea::satellite_numbering>(0x20930007),
    bits<kSystemFilter, 0>(0x10930011),
    bits<kSystemFilter, 1>(0x10930012),
    bits<kSystemFilter, 2>(0x10930013),
    bits<kSystemFilter, 4>(0x10930015),
    bits<kSystemFilter, 5>(0x10930016),
    bits<kSystemFilter, 6>(0x10930017),
    bits<kSentenceFilter, 0>(0x10930021),
    bits<kSentenceFilter, 1>(0x10930022),
    bits<kSentenceFilter, 2>(0x10930023),
    bits<kSentenceFilter, 3>(0x10930024),
    bits<kSentenceFilter, 4>(0x10930025),
    bits<kSentenceFilter, 5>(0x10930026),
    field<&State::nmea, &ubx::CfgNmea::main_talker>(0x20930031),
    field<&State::nmea, &ubx::CfgNmea::gsv_talker>(0x20930032),
    talker_of_beidou(0x30930033),
    // Odometer
    bits<kOdometer, 0>(0x10220001),
    bits<kOdometer, 1>(0x10220002),
    bits<kOdometer, 2>(0x10220003),
    bits<kOdometer, 3>(0x10220004),
    field<&State::odometer, &ubx::CfgOdo::profile>(0x20220005),
    field<&State::odometer, &ubx::CfgOdo::course_speed_dmps>(0x20220021),
    field<&State::odometer, &ubx::CfgOdo::course_accuracy_m>(0x20220022),
    field<&State::odometer, &ubx::CfgOdo::speed_gain>(0x20220031),
    field<&State::odometer, &ubx::CfgOdo::course_gain>(0x20220032),
    // SBAS
    bits<kSbasMode, 1>(0x10360002),
    bits<kSbasUsage, 0>(0x10360003),
    bits<kSbasUsage, 1>(0x10360004),
    bits<kSbasUsage, 2>(0x10360005),
    sbas_satellites(0x50360006),
    // Systems and signals
    system<GnssSystem::gps, 0>(0x1031001F),
    system<GnssSystem::gps, 16>(0x10310001),
    system<GnssSystem::gps, 20>(0x10310003),
    system<GnssSystem::sbas, 0>(0x10310020),
    system<GnssSystem::sbas, 16>(0x10310005),
    system<GnssSystem::galileo, 0>(0x10310021),
    system<GnssSystem::galileo, 16>(0x10310007),
    system<GnssSystem::galileo, 21>(0x1031000A),
    system<GnssSystem::beidou, 0>(0x10310022),
    system<GnssSystem::beidou, 16>(0x1031000D),
    system<GnssSystem::beidou, 20>(0x1031000E),
    system<GnssSystem::qzss, 0>(0x10310024),
    system<GnssSystem::qzss, 16>(0x10310012),
    system<GnssSystem::qzss, 18>(0x10310014),
    system<GnssSystem::qzss, 20>(0x10310015),
    system<GnssSystem::glonass, 0>(0x10310025),
    system<GnssSystem::glonass, 16>(0x10310018),
    system<GnssSystem::glonass, 20>(0x1031001A),
    // Base station and its messages
    bits<kBaseFlags, 0, 8>(0x20030001),
    bits<kBaseFlags, 8>(0x20030002),
    whole<kElement<&State::base_ecef_cm, 0>>(0x40030003),
    whole<kElement<&State::base_ecef_cm, 1>>(0x40030004),
    whole<kElement<&State::base_ecef_cm, 2>>(0x40030005),
    whole<kElement<&State::base_ecef_rest, 0>>(0x20030006),
    whole<kElement<&State::base_ecef_rest, 1>>(0x20030007),
    whole<kElement<&State::base_ecef_rest, 2>>(0x20030008),
    whole<kElement<&State::base_geodetic, 0>>(0x40030009),
    whole<kElement<&State::base_geodetic, 1>>(0x4003000A),
    whole<kElement<&State::base_geodetic, 2>>(0x4003000B),
    whole<kElement<&State::base_geodetic_rest, 0>>(0x2003000C),
    whole<kElement<&State::base_geodetic_rest, 1>>(0x2003000D),
    whole<kElement<&State::base_geodetic_rest, 2>>(0x2003000E),
    field<&State::base, &ubx::CfgTmode3::accuracy_e4m>(0x4003000F),
    field<&State::base, &ubx::CfgTmode3::survey_least_duration_s>(0x40030010),
    field<&State::base, &ubx::CfgTmode3::survey_accuracy_limit_e4m>(0x40030011),
    whole<kOwn<&State::station_out>>(0x30090001),
    whole<kOwn<&State::station_in>>(0x30090008),
    whole<kOwn<&State::station_filter>>(0x20090009),
    whole<kOwn<&State::carrier_mode>>(0x20140011),
    // Signal security
    whole<kOwn<&State::jamming_sensitive>>(0x10F60051),
    // Antenna supervision
    bits<kAntenna, 0>(0x10A3002E),
    bits<kAntenna, 1>(0x10A3002F),
    bits<kAntenna, 2>(0x10A30031),
    bits<kAntenna, 3>(0x10A30033),
    bits<kAntenna, 4>(0x10A30035),
    bits<kAntennaPins, 0, 5>(0x20A30036),
    bits<kAntennaPins, 5, 5>(0x20A30037),
    bits<kAntennaPins, 10, 5>(0x20A30038),
    // Time pulse
    pulse<&ubx::CfgTp5::cable_delay_ns>(0x30050001),
    pulse<&ubx::CfgTp5::period>(0x40050002),
    pulse<&ubx::CfgTp5::period_locked>(0x40050003),
    pulse<&ubx::CfgTp5::pulse>(0x40050004),
    pulse<&ubx::CfgTp5::pulse_locked>(0x40050005),
    pulse<&ubx::CfgTp5::user_delay_ns>(0x40050006),
    bits<kPulse, 0>(0x10050007),
    bits<kPulse, 1>(0x10050008),
    bits<kPulse, 2>(0x10050009),
    bits<kPulse, 3>(0x20050023),
    bits<kPulse, 4>(0x20050030),
    bits<kPulse, 5>(0x1005000A),
    bits<kPulse, 6>(0x1005000B),
    bits<kPulse, 7, 4>(0x2005000C),
};
// clang-format on
// NOLINTEND(readability-magic-numbers)

}  // namespace

UbloxKeyMap::UbloxKeyMap(const UbloxProfile& profile) : entries_(ubx::configuration_keys().size()) {
  const auto bind = [this](std::span<const Binding> bindings) {
    for (const Binding& binding : bindings) {
      entries_[ubx::key_index(binding.key)] = {.read = binding.read, .write = binding.write};
    }
  };
  bind(kBindings);
  bind(items_of_port<0>());
  bind(items_of_port<1>());
  bind(items_of_port<2>());
  bind(items_of_port<3>());
  bind(items_of_port<4>());
  bind(items_of_uart<1>());
  bind(items_of_uart<2>());
  for (const ubx::MessageRateKeys& keys : ubx::message_rate_keys()) {
    const std::size_t message = message_index(profile, keys.message);
    const bool known = message < profile.messages.size() && profile.messages[message].periodic;
    for (std::uint8_t port = 0; port < ubx::kMessageRatePorts; ++port) {
      Entry& entry = entries_[ubx::key_index(keys.first + port)];
      entry.message = known ? static_cast<std::int16_t>(message) : std::int16_t{-1};
      entry.port = port;
    }
  }
}

bool UbloxKeyMap::bound(std::size_t index) const {
  return entries_[index].read != nullptr || entries_[index].message >= 0;
}

std::uint64_t UbloxKeyMap::read(const UbloxConfigurationState& state, std::size_t index) const {
  const Entry& entry = entries_[index];
  return entry.read != nullptr ? entry.read(state)
                               : state.rates[static_cast<std::size_t>(entry.message)][entry.port];
}

void UbloxKeyMap::write(UbloxConfigurationState& state, std::size_t index,
                        std::uint64_t value) const {
  const Entry& entry = entries_[index];
  if (entry.write != nullptr) {
    entry.write(state, value);
  } else {
    state.rates[static_cast<std::size_t>(entry.message)][entry.port] =
        static_cast<std::uint8_t>(value);
  }
}

}  // namespace rigwire::emulators
