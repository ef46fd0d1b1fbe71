// The u-blox ZED-F9P: protocol 27.50, firmware HPG 1.50.
//
// Source: u-blox F9 HPG 1.50 interface description, UBXDOC-963802114-12815, sections 1.2
// (versions), 3 (messages) and "Configuration defaults"; lines at power-on and their order from a
// recording of HPG 1.12; order within an epoch: recordings. CFG-GNSS has no documented default:
// its numbers of channels are of no consequence here and not verified.
#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "emulators/ublox/configuration_state.h"
#include "emulators/ublox/message_rows.h"
#include "emulators/ublox/signal_security.h"
#include "protocols/ubx/configuration_keys.h"
#include "protocols/ubx/identity.h"
#include "protocols/ubx/raw_measurements.h"
#include "protocols/ubx/signal_security.h"
#include "protocols/ubx/timing.h"

namespace rigwire::emulators {
namespace {

namespace ubx = protocols::ubx;

constexpr std::size_t kSatellites = kModernSatellites;
constexpr std::size_t kSignals = 2 * kSatellites;

// Longest forms with NMEA 4.11 and high precision: four systems, each with its own GSA and GSV.
constexpr SentenceLengths kLongest{.rmc = 84,
                                   .gga = 94,
                                   .gsa = 4 /*systems*/ * 71,
                                   .gsv = 15 /*pages*/ * 72,
                                   .gll = 57,
                                   .gbs = 70,
                                   .grs = 4 /*systems*/ * (36 + 12 /*slots*/ * 7),
                                   .gns = 96,
                                   .pubx03 = 20 + kSatellites * 18};

constexpr std::array kFix{
    listed<ubx::RxmRawxHead, ubx::RxmRawxBlock>("RXM-RAWX", kSignals),
    produced<ubx::NavPvt92>("NAV-PVT"),
    listed<ubx::NavOrbHead, ubx::NavOrbBlock>("NAV-ORB", kSatellites),
    produced<ubx::NavPosecef>("NAV-POSECEF"),
    produced<ubx::NavPosllh>("NAV-POSLLH"),
    produced<ubx::NavStatus>("NAV-STATUS"),
    produced<ubx::NavHpposecef>("NAV-HPPOSECEF"),
    produced<ubx::NavHpposllh>("NAV-HPPOSLLH"),
    produced<ubx::NavVelecef>("NAV-VELECEF"),
    produced<ubx::NavVelned>("NAV-VELNED"),
};
constexpr std::array kSatellitesInView{
    listed<ubx::NavSatHead, ubx::NavSatBlock>("NAV-SAT", kSatellites),
    listed<ubx::NavSigHead, ubx::NavSigBlock>("NAV-SIG", kSignals),
    produced<ubx::NavDop>("NAV-DOP"),
};
constexpr std::array kState{
    produced<ubx::NavCov>("NAV-COV"),
    produced<ubx::NavOdo>("NAV-ODO"),
    produced<ubx::NavSvin>("NAV-SVIN"),
    produced<ubx::NavRelposned>("NAV-RELPOSNED"),
    unasked(produced<ubx::NavEoe>("NAV-EOE")),
    listed<ubx::MonRfHead, ubx::MonRfBlock>("MON-RF", 2),
    listed<ubx::MonCommsHead, ubx::MonCommsPort>("MON-COMMS", 1),
    listed<ubx::SecSigHead, ubx::SecSigBlock>("SEC-SIG", 8),
    listed<ubx::SecSiglogHead, ubx::SecSiglogEvent>("SEC-SIGLOG", UbloxSignalSecurity::kMostEvents),
};
constexpr std::array kReceived{
    unasked(listed({0x02, 0x13}, "RXM-SFRBX", kSignals * 56 - ubx::kOverheadBytes)),
    unasked(produced<ubx::RxmRtcm>("RXM-RTCM")),
    produced<ubx::LogInfo>("LOG-INFO"),
};
constexpr std::array kPulses{
    produced<ubx::TimTm2>("TIM-TM2"),
    produced<ubx::TimTp>("TIM-TP"),
};

// Payloads of observations with 16 satellites of two signals each.
constexpr std::size_t kShortObservations = (169 + 32 + 16 * 18 + 32 * 48 + 7) / 8;
constexpr std::size_t kFullObservations = (169 + 32 + 16 * 36 + 32 * 80 + 7) / 8;
// In the order of a recorded ZED-F9T as a base station.
constexpr std::array kCorrections{
    correction(0xFE, "RTCM-4072.0", 30),
    correction(0x4A, "RTCM-1074", kShortObservations),
    correction(0x4D, "RTCM-1077", kFullObservations),
    correction(0x54, "RTCM-1084", kShortObservations),
    correction(0x57, "RTCM-1087", kFullObservations),
    correction(0x5E, "RTCM-1094", kShortObservations),
    correction(0x61, "RTCM-1097", kFullObservations),
    correction(0x7C, "RTCM-1124", kShortObservations),
    correction(0x7F, "RTCM-1127", kFullObservations),
    correction(0xE6, "RTCM-1230", 8),
    correction(0x05, "RTCM-1005", 19),
};

constexpr auto kProduced =
    joined(kFix, all_sentences(kLongest), kSatellitesInView, kModernTimes, kState, kHardware,
           kReceived, kModernIdentity, kPulses, kCorrections);

/// What is produced, then everything else that has a rate.
std::vector<UbloxMessage> all_messages() {
  std::vector<UbloxMessage> messages(kProduced.begin(), kProduced.end());
  for (const ubx::MessageRateKeys& keys : ubx::message_rate_keys()) {
    if (std::ranges::find(kProduced, keys.message, &UbloxMessage::id) == kProduced.end()) {
      messages.push_back(silent(keys.message.message_class, keys.message.message_id));
    }
  }
  return messages;
}

constexpr std::array<std::string_view, 11> kBanner{
    "u-blox AG - www.u-blox.com",
    "EXT CORE 1.00 (5949d2)",
    "ROM BASE 0x118B2060",
    "FWVER=HPG 1.50",
    "PROTVER=27.50",
    "MOD=ZED-F9P",
    "GPS;GLO;GAL;BDS",
    "SBAS;QZSS",
    "ANTSUPERV=",
    "ANTSTATUS=DONTKNOW",
    "PF=FDB79",
};

// Signals on at start: both bands, without QZSS L1S.
constexpr std::array<SystemChannels, 6> kSystems{{
    {GnssSystem::gps, 8, 16, true, 0x11},
    {GnssSystem::sbas, 3, 3, true, 0x01},
    {GnssSystem::galileo, 8, 12, true, 0x21},
    {GnssSystem::beidou, 2, 5, true, 0x11},
    {GnssSystem::qzss, 3, 4, true, 0x11},
    {GnssSystem::glonass, 8, 12, true, 0x11},
}};

constexpr std::array<std::uint8_t, 5> kNmeaVersions{0x21, 0x23, 0x40, 0x41, 0x4B};

void adjust_defaults(UbloxConfigurationState& s) {
  for (std::size_t protocol = 0; protocol < s.information.size(); ++protocol) {
    s.information[protocol].masks.fill(protocol == 1 ? 7 : 0);
  }
  constexpr std::uint8_t kOnly3d = 2;
  s.nav5.fix_mode = kOnly3d;
  s.nav5.minimum_elevation_deg = 10;
  s.nav5.time_accuracy_mask_m = 350;
  s.navx5.version = 2;
  set_modern_expert(s.navx5);
  s.navx5.maximum_satellites = 32;
  s.navx5.minimum_cn0_dbhz = 6;
  s.navx5.precise_point_positioning = 0;
  s.sbas = {1, 3, 3, 0, 0x0003AB88};
  s.antenna = {0x0000, 0x39F0};  // nothing supervised; pins 16, 15, 14
  s.pulses[0] = {0, 1, 50, 0, 1'000'000, 1'000'000, 0, 100'000, 0, 0x77};
  const std::uint32_t framing = s.ports[ubx::kPortUart1].mode;
  s.ports[ubx::kPortUart2] = {2, 0, framing, 38'400, 0x0061, 0x0020, 0};
}

}  // namespace

const UbloxProfile& ublox_zed_f9p() {
  static const std::vector<UbloxMessage> messages = all_messages();
  static const UbloxProfile profile{
      .name = "ZED-F9P",
      .generation = 9,
      .protocol_e2 = 2750,
      .software = "EXT CORE 1.00 (5949d2)",
      .hardware = "00190000",
      .extensions = std::span(kBanner).subspan(2 /*maker, software*/, 6),
      .banner = kBanner,
      .messages = messages,
      .systems = kSystems,
      .channels = 60,
      .radio_paths = 4,
      .nmea_version = 0x4B,
      .nmea_versions = kNmeaVersions,
      .cfg_nmea_bytes = 20,
      .shortest_period = std::chrono::milliseconds{25},
      .navigation_ratio = true,
      .carrier_solution = true,
      .odometer = true,
      .key_items = true,
      .logger = true,
      .baud = 38'400,
      .greatest_baud = 921'600,
      .input_protocols = 0x0063,
      .output_protocols = 0x0023,
      .chip_generation = 4,
      .status_flags = 0x00,
      .first_week = 2320,
      .default_leap_seconds = 18,
      .front_end = {.noise_per_ms = 74.0, .gain_control = 5'616.0, .jamming_floor = 8},
      .adjust_defaults = adjust_defaults,
  };
  return profile;
}

}  // namespace rigwire::emulators
