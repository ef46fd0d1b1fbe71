// The u-blox NEO-M8N: protocol 18.00, firmware SPG 3.01 in flash; and the NEO-M8T, the timing
// receiver of the same generation that reports its raw measurements: protocol 22.00, firmware
// TIM 1.10.
//
// Source: u-blox M8 receiver description, UBX-13003221 R28, sections 2.1.2 (texts at power-on),
// 2.1.4 (MON-VER), 32 (messages) and appendix C (defaults). Where chapter 31 and appendix C.12 give
// different NMEA versions, C.12 is followed: 4.0. Order within an epoch: recordings. Texts of the
// NEO-M8T: what such receivers answered to others; its timing messages (survey-in, TIM-SVIN ...)
// are not emulated.
#include <array>
#include <span>

#include "emulators/ublox/configuration_state.h"
#include "emulators/ublox/message_rows.h"
#include "protocols/ubx/aiding.h"
#include "protocols/ubx/identity.h"
#include "protocols/ubx/raw_measurements.h"
#include "protocols/ubx/timing.h"

namespace rigwire::emulators {
namespace {

namespace ubx = protocols::ubx;

constexpr std::size_t kSatellites = kModernSatellites;

// Longest forms with NMEA 4.1: several systems, each with its own GSA and GSV.
constexpr SentenceLengths kLongest{.rmc = 80,
                                   .gga = 84,
                                   .gsa = 3 /*systems*/ * 71,
                                   .gsv = 8 /*pages*/ * 70,
                                   .gll = 53,
                                   .gbs = 70,
                                   .grs = 3 /*systems*/ * (36 + 12 /*slots*/ * 7),
                                   .gns = 96,
                                   .pubx03 = 20 + kSatellites * 18};

constexpr std::array kFix{
    produced<ubx::NavPvt92>("NAV-PVT"),
    listed<ubx::NavOrbHead, ubx::NavOrbBlock>("NAV-ORB", kSatellites),
    listed<ubx::NavSatHead, ubx::NavSatBlock>("NAV-SAT", kSatellites),
    produced<ubx::NavPosecef>("NAV-POSECEF"),
    produced<ubx::NavPosllh>("NAV-POSLLH"),
    produced<ubx::NavStatus>("NAV-STATUS"),
    produced<ubx::NavSol>("NAV-SOL"),
};
constexpr std::array kVelocity{
    listed<ubx::NavSvinfoHead, ubx::NavSvinfoChannel>("NAV-SVINFO", kSatellites),
    produced<ubx::NavDop>("NAV-DOP"),
    produced<ubx::NavVelecef>("NAV-VELECEF"),
    produced<ubx::NavVelned>("NAV-VELNED"),
};
constexpr std::array kState{
    produced<ubx::NavDgpsHead>("NAV-DGPS"),
    produced<ubx::NavAopstatus>("NAV-AOPSTATUS"),
    produced<ubx::NavOdo>("NAV-ODO"),
    unasked(produced<ubx::NavEoe>("NAV-EOE")),
};
constexpr auto kMeasured =
    joined(kFix, all_sentences(kLongest), kVelocity, kModernTimes, kState, kHardware);

constexpr std::array kSubframes{
    unasked(listed({0x02, 0x13}, "RXM-SFRBX", kSatellites * 56 - ubx::kOverheadBytes)),
    listed({0x02, 0x20}, "RXM-SVSI", 8 + 6 * kSatellites),
    listed({0x0B, 0x30}, "AID-ALM", 32 * 48 - ubx::kOverheadBytes),
    listed({0x0B, 0x31}, "AID-EPH", 32 * 112 - ubx::kOverheadBytes),
    produced<ubx::TimTm2>("TIM-TM2"),
    produced<ubx::TimTp>("TIM-TP"),
    produced<ubx::LogInfo>("LOG-INFO"),
};
constexpr std::array kSilent{
    on_demand(produced<ubx::AidHui>("AID-HUI")),
    on_demand(produced<ubx::AidIni>("AID-INI")),
    silent(0x01, 0x39),
    silent(0x02, 0x14),
    silent(0x02, 0x59),
    silent(0x0B, 0x33),
    silent(0x0D, 0x06),
    silent(0xF0, 0x0F),
};

constexpr auto kReceived = joined(kSubframes, kModernIdentity, kSilent);

constexpr auto kMessages = joined(kMeasured, kReceived);
/// The raw measurements come last but for the subframes, as recordings show.
constexpr auto kTimingMessages = joined(
    kMeasured, std::array{listed<ubx::RxmRawxHead, ubx::RxmRawxBlock>("RXM-RAWX", kSatellites)},
    kReceived);
static_assert(kTimingMessages.size() <= kMaximumMessages);

/// Returns the texts at power-on that MON-VER repeats.
constexpr std::span<const std::string_view> extensions(std::span<const std::string_view> banner) {
  return banner.subspan(3 /*maker, hardware, software*/, 7);
}

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

constexpr std::array<std::string_view, 14> kTimingBanner{
    "u-blox AG - www.u-blox.com",
    "HW UBX-M8030 00080000",
    "EXT CORE 3.01 (111141)",
    "ROM BASE 2.01 (75331)",
    "FWVER=TIM 1.10",
    "PROTVER=22.00",
    "MOD=NEO-M8T-0",
    "FIS=0xEF4015 (100111)",
    "GPS;GLO;GAL;BDS",
    "SBAS;IMES;QZSS",
    "GNSS OTP=GPS;GLO",
    "LLC=FFFFFFFF-FFFFFFEC-FFFFFFFF-FFFFFFBF-FFFFFF68",
    "ANTSUPERV=AC SD PDoS SR",
    "ANTSTATUS=OK",
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
  set_modern_expert(s.navx5);
  s.navx5.minimum_cn0_dbhz = 6;
  s.navx5.precise_point_positioning = 0;
  s.sbas = {1, 3, 3, 0, 0x0007A389};  // PRN 120, 123, 127-129, 133, 135-138
  s.ports[ubx::kPortSpi].input_protocols = 0;
  s.ports[ubx::kPortSpi].output_protocols = 0;
}

}  // namespace

const UbloxProfile& ublox_neo_m8t() {
  static const UbloxProfile profile = [] {
    UbloxProfile timing = ublox_neo_m8();
    timing.name = "NEO-M8T";
    timing.protocol_e2 = 2200;
    timing.software = "EXT CORE 3.01 (111141)";
    timing.extensions = extensions(kTimingBanner);
    timing.banner = kTimingBanner;
    timing.messages = kTimingMessages;
    return timing;
  }();
  return profile;
}

const UbloxProfile& ublox_neo_m8() {
  static const UbloxProfile profile{
      .name = "NEO-M8N",
      .generation = 8,
      .protocol_e2 = 1800,
      .software = "EXT CORE 3.01 (107900)",
      .hardware = "00080000",
      .extensions = extensions(kBanner),
      .banner = kBanner,
      .messages = kMessages,
      .systems = kSystems,
      .channels = 32,
      .radio_paths = 2,
      .nmea_version = 0x40,
      .nmea_versions = kNmeaVersions,
      .cfg_nmea_bytes = 20,
      .navigation_ratio = true,
      .odometer = true,
      .power_modes = true,
      .logger = true,
      .chip_generation = 4,
      .status_flags = 0x00,
      .first_week = 1867,
      .default_leap_seconds = 16,
      .front_end = {.noise_per_ms = 95.0,
                    .gain_control = 2'106.0,
                    .jamming_floor = 3,
                    .jamming_span = 19},
      .adjust_defaults = adjust_defaults,
  };
  return profile;
}

}  // namespace rigwire::emulators
