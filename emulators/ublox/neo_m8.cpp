// The u-blox NEO-M8N: protocol 18.00, firmware SPG 3.01 in flash.
//
// Source: u-blox M8 receiver description, UBX-13003221 R28, sections 2.1.2 (texts at power-on),
// 2.1.3 (MON-VER), 32 (messages) and appendix C (defaults). Where chapter 31 and appendix C.12 give
// different NMEA versions, C.12 is followed: 4.0. Order within an epoch: recordings.
#include <algorithm>
#include <array>

#include "emulators/ublox/configuration_state.h"
#include "emulators/ublox/profile.h"
#include "emulators/ublox/solution_modern.h"

namespace rigwire::emulators {
namespace {

namespace ubx = protocols::ubx;

constexpr std::size_t kFrame = ubx::kOverheadBytes;
constexpr std::size_t kSatellites = 32;  // tracking channels

// Longest forms with NMEA 4.1: several systems, each with its own GSA and GSV.
constexpr std::size_t kRmc = 80;
constexpr std::size_t kVtg = 46;
constexpr std::size_t kGga = 84;
constexpr std::size_t kGsa = 3 /*systems*/ * 71;
constexpr std::size_t kGsv = 8 /*pages*/ * 70;
constexpr std::size_t kGll = 53;
constexpr std::size_t kZda = 40;

constexpr UbloxMessage produced(std::uint8_t message_class, std::uint8_t id, std::string_view name,
                                std::size_t payload) {
  return {{message_class, id}, name, kFrame + payload, false};
}
constexpr UbloxMessage sentence(std::uint8_t id, std::string_view name, std::size_t bytes) {
  return {{0xF0, id}, name, bytes, true};
}
constexpr UbloxMessage known(std::uint8_t message_class, std::uint8_t id) {
  return {{message_class, id}, {}, 0, message_class >= 0xF0};
}

constexpr std::array kMessages{
    produced(0x01, 0x07, "NAV-PVT", 92),
    produced(0x01, 0x34, "NAV-ORB", 8 + 6 * kSatellites),
    produced(0x01, 0x35, "NAV-SAT", 8 + 12 * kSatellites),
    produced(0x01, 0x03, "NAV-STATUS", 16),
    produced(0x01, 0x06, "NAV-SOL", 52),
    produced(0x01, 0x01, "NAV-POSECEF", 20),
    produced(0x01, 0x02, "NAV-POSLLH", 28),
    sentence(0x04, "RMC", kRmc),
    sentence(0x05, "VTG", kVtg),
    sentence(0x00, "GGA", kGga),
    sentence(0x02, "GSA", kGsa),
    sentence(0x03, "GSV", kGsv),
    sentence(0x01, "GLL", kGll),
    sentence(0x08, "ZDA", kZda),
    produced(0x01, 0x30, "NAV-SVINFO", 8 + 12 * kSatellites),
    produced(0x01, 0x04, "NAV-DOP", 18),
    produced(0x01, 0x11, "NAV-VELECEF", 20),
    produced(0x01, 0x12, "NAV-VELNED", 36),
    produced(0x01, 0x20, "NAV-TIMEGPS", 16),
    produced(0x01, 0x21, "NAV-TIMEUTC", 20),
    produced(0x01, 0x26, "NAV-TIMELS", 24),
    produced(0x01, 0x22, "NAV-CLOCK", 20),
    produced(0x01, 0x61, "NAV-EOE", 4),
    produced(0x0A, 0x09, "MON-HW", 60),
    known(0x01, 0x09),
    known(0x01, 0x23),
    known(0x01, 0x24),
    known(0x01, 0x25),
    known(0x01, 0x31),
    known(0x01, 0x32),
    known(0x01, 0x39),
    known(0x01, 0x60),
    known(0x02, 0x13),
    known(0x02, 0x14),
    known(0x02, 0x20),
    known(0x02, 0x59),
    known(0x0A, 0x02),
    known(0x0A, 0x06),
    known(0x0A, 0x07),
    known(0x0A, 0x08),
    known(0x0A, 0x0B),
    known(0x0A, 0x21),
    known(0x0B, 0x30),
    known(0x0B, 0x31),
    known(0x0B, 0x33),
    known(0x0D, 0x01),
    known(0x0D, 0x03),
    known(0x0D, 0x06),
    known(0x21, 0x08),
    known(0xF0, 0x06),
    known(0xF0, 0x07),
    known(0xF0, 0x09),
    known(0xF0, 0x0A),
    known(0xF0, 0x0D),
    known(0xF0, 0x0F),
    known(0xF1, 0x00),
    known(0xF1, 0x03),
    known(0xF1, 0x04),
};
static_assert(kMessages.size() <= kMaximumMessages);

constexpr std::array<std::string_view, 7> kExtensions{
    "ROM BASE 3.01 (107888)", "FWVER=SPG 3.01",  "PROTVER=18.00", "MOD=NEO-M8N-0",
    "FIS=0xEF4015 (100111)",  "GPS;GLO;GAL;BDS", "SBAS;IMES;QZSS"};

constexpr std::array<std::string_view, 15> kBanner{
    "u-blox AG - www.u-blox.com",
    "HW UBX-M8030 00080000",
    "EXT CORE 3.01 (107900)",
    "ROM BASE 3.01 (107888)",
    "FWVER=SPG 3.01",
    "PROTVER=18.00",
    "MOD=NEO-M8N-0",
    "FIS=0xEF4015 (100111)",
    "GPS;GLO;GAL;BDS",
    "SBAS;IMES;QZSS",
    "GNSS OTP=GPS;GLO",
    "LLC=FFFFFFFF-FFFFFFEC-FFFFFFFF-FFFFFFBF-FFFFFF68",
    "ANTSUPERV=AC SD PDoS SR",
    "ANTSTATUS=OK",
    "PF=3FB",
};

// Signals: the first of each system, as the receiver itself answers.
constexpr std::array<SystemChannels, 7> kSystems{{
    {GnssSystem::gps, 8, 16, true, 0x01},
    {GnssSystem::sbas, 1, 3, true, 0x01},
    {GnssSystem::galileo, 4, 8, false, 0x01},
    {GnssSystem::beidou, 8, 16, false, 0x01},
    {GnssSystem::imes, 0, 8, false, 0x01},
    {GnssSystem::qzss, 0, 3, true, 0x01},
    {GnssSystem::glonass, 8, 14, true, 0x01},
}};

constexpr std::array<std::uint8_t, 4> kNmeaVersions{0x21, 0x23, 0x40, 0x41};

void adjust_defaults(UbloxConfigurationState& s) {
  for (auto& information : s.information) {
    information.masks.fill(0);
  }
  constexpr std::array<std::uint8_t, 6> kErrorWarningNotice{7, 7, 0, 7, 7, 0};
  s.information[1].masks = kErrorWarningNotice;
  s.nav5.time_accuracy_mask_m = 350;
  s.navx5.version = 2;
  s.navx5.minimum_cn0_dbhz = 6;
  s.navx5.precise_point_positioning = 0;
  s.sbas = {1, 3, 3, 0, 0x0007A389};  // PRN 120, 123, 127-129, 133, 135-138
  s.ports[ubx::kPortSpi].input_protocols = 0;
  s.ports[ubx::kPortSpi].output_protocols = 0;
}

std::size_t encode(const UbloxSolution& solution, ubx::MessageId id, std::span<std::uint8_t> out) {
  return encode_modern_solution(solution, ublox_neo_m8(), id, out);
}

}  // namespace

const UbloxProfile& ublox_neo_m8() {
  static const UbloxProfile profile{
      .name = "NEO-M8N",
      .generation = 8,
      .protocol_e2 = 1800,
      .software = "EXT CORE 3.01 (107900)",
      .hardware = "00080000",
      .extensions = kExtensions,
      .banner = kBanner,
      .messages = kMessages,
      .systems = kSystems,
      .channels = 32,
      .radio_paths = 2,
      .nmea_version = 0x40,
      .nmea_versions = kNmeaVersions,
      .cfg_nmea_bytes = 20,
      .pvt_bytes = 92,
      .navigation_ratio = true,
      .chip_generation = 4,
      .status_flags = 0x00,
      .first_week = 1867,
      .default_leap_seconds = 16,
      .adjust_defaults = adjust_defaults,
      .encode = encode,
  };
  return profile;
}

}  // namespace rigwire::emulators
