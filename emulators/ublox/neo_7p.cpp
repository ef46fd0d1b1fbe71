// The u-blox NEO-7P: protocol 14.00, firmware 1.00 (71863).
//
// Source: complete poll of a NEO-7P's default configuration, and its texts at power-on.
#include <array>

#include "emulators/ublox/message_rows.h"
#include "protocols/ubx/aiding.h"
#include "protocols/ubx/raw_measurements.h"
#include "protocols/ubx/timing.h"

namespace rigwire::emulators {
namespace {

namespace ubx = protocols::ubx;

constexpr std::size_t kTrackable = 16;  // more than 24 slots ever show at once

// Longest forms: three digits of knots, five of altitude; GSV of 16 satellites.
constexpr SentenceLengths kLongest{.rmc = 76,
                                   .gga = 84,
                                   .gsa = 69,
                                   .gsv = 4 /*pages*/ * 70,
                                   .gll = 53,
                                   .gbs = 64,
                                   .grs = 32 + 12 /*slots*/ * 7,
                                   .gns = 90,
                                   .pubx03 = 20 + 16 /*satellites*/ * 20};

constexpr std::array kFix{
    produced<ubx::NavPvt>("NAV-PVT"),         produced<ubx::NavPosecef>("NAV-POSECEF"),
    produced<ubx::NavPosllh>("NAV-POSLLH"),   produced<ubx::NavStatus>("NAV-STATUS"),
    produced<ubx::NavVelecef>("NAV-VELECEF"), produced<ubx::NavVelned>("NAV-VELNED"),
};
constexpr std::array kMore{
    produced<ubx::NavSol>("NAV-SOL"),
    listed<ubx::NavSvinfoHead, ubx::NavSvinfoChannel>("NAV-SVINFO", kTrackable),
    produced<ubx::NavDop>("NAV-DOP"),
    produced<ubx::NavTimegps>("NAV-TIMEGPS"),
    produced<ubx::NavTimeutc>("NAV-TIMEUTC"),
    produced<ubx::NavClock>("NAV-CLOCK"),
    listed<ubx::NavSbasHead, ubx::NavSbasBlock>("NAV-SBAS", kTrackable),
    produced<ubx::NavDgpsHead>("NAV-DGPS"),
    produced<ubx::NavAopstatus>("NAV-AOPSTATUS"),
};
constexpr std::array kRaw{
    listed<ubx::RxmRawHead, ubx::RxmRawBlock>("RXM-RAW", kTrackable),
    unasked(listed(ubx::RxmSfrb::kId, "RXM-SFRB",
                   kTrackable* ubx::frame_size<ubx::RxmSfrb>() - ubx::kOverheadBytes)),
    listed<ubx::RxmSvsiHead, ubx::RxmSvsiBlock>("RXM-SVSI", 32),
    produced<ubx::AidIni>("AID-INI"),
    listed({0x0B, 0x30}, "AID-ALM", 32 * 48 - ubx::kOverheadBytes),
    listed({0x0B, 0x31}, "AID-EPH", 32 * 112 - ubx::kOverheadBytes),
    listed({0x02, 0x30}, "RXM-ALM", 32 * 48 - ubx::kOverheadBytes),
    listed({0x02, 0x31}, "RXM-EPH", 32 * 112 - ubx::kOverheadBytes),
    produced<ubx::TimTm2>("TIM-TM2"),
    produced<ubx::TimTp>("TIM-TP"),
    on_demand(version_row()),
    on_demand(produced<ubx::AidHui>("AID-HUI")),
    silent(0x02, 0x13),
    silent(0x0B, 0x32),
    silent(0x0B, 0x33),
    silent(0x21, 0x08),
};

constexpr auto kMessages = joined(kFix, all_sentences(kLongest), kMore, kHardware, kRaw);

constexpr std::array<std::string_view, 6> kExtensions{"1.00 (59842)", "PROTVER 14.00",
                                                      "FIS 0xEF4015", "MOD NEO-7P-0",
                                                      "PPP RAW 1.01", "GPS;SBAS;GLO;QZSS"};

constexpr std::array<std::string_view, 11> kBanner{
    "u-blox ag - www.u-blox.com",
    "HW  UBX-G70xx   00070000 FF7FFFFFo",
    "EXT CORE 1.00 (71863) Jul 15 2013 15:48:11",
    "ROM BASE 1.00 (59842) Jun 27 2012 17:43:52",
    "MOD NEO-7P-0",
    "PROTVER 14.00",
    "PPP RAW 1.01",
    "ANTSUPERV=AC SD PDoS SR",
    "ANTSTATUS=OK",
    "FIS 0xEF4015 found",
    "LLC FFFFFFFF-FFFFFFFF-FFFFFFFF-FFFFFFFF-FFFFFFFD",
};

constexpr std::array<SystemChannels, 4> kSystems{{
    {GnssSystem::gps, 4, 255, true, 0},
    {GnssSystem::sbas, 1, 3, true, 0},
    {GnssSystem::qzss, 0, 3, true, 0},
    {GnssSystem::glonass, 8, 255, false, 0},
}};

constexpr std::array<std::uint8_t, 2> kNmeaVersions{0x21, 0x23};

}  // namespace

const UbloxProfile& ublox_neo_7p() {
  static const UbloxProfile profile{
      .name = "NEO-7P",
      .software = "1.00 (71863)",
      .hardware = "00070000",
      .extensions = kExtensions,
      .banner = kBanner,
      .messages = kMessages,
      .systems = kSystems,
      .nmea_versions = kNmeaVersions,
  };
  return profile;
}

}  // namespace rigwire::emulators
