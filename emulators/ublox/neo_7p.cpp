// The u-blox NEO-7P: protocol 14.00, firmware 1.00 (71863).
//
// Source: complete poll of a NEO-7P's default configuration, and its texts at power-on.
#include <array>

#include "emulators/ublox/message_rows.h"
#include "emulators/ublox/profile.h"
#include "protocols/ubx/aiding.h"
#include "protocols/ubx/monitor.h"
#include "protocols/ubx/navigation.h"
#include "protocols/ubx/raw_measurements.h"
#include "protocols/ubx/timing.h"

namespace rigwire::emulators {
namespace {

namespace ubx = protocols::ubx;

// Longest forms: three digits of knots, five of altitude; GSV of 16 satellites.
constexpr std::size_t kRmc = 76;
constexpr std::size_t kVtg = 46;
constexpr std::size_t kGga = 84;
constexpr std::size_t kGsa = 69;
constexpr std::size_t kGsv = 4 /*pages*/ * 70;
constexpr std::size_t kGll = 53;
constexpr std::size_t kZda = 40;
constexpr std::size_t kGst = 72;
constexpr std::size_t kGbs = 64;
constexpr std::size_t kGrs = 32 + 12 /*slots*/ * 7;
constexpr std::size_t kDtm = 48;
constexpr std::size_t kGns = 90;
constexpr std::size_t kPubx00 = 130;
constexpr std::size_t kPubx03 = 20 + 16 /*satellites*/ * 20;
constexpr std::size_t kPubx04 = 72;
constexpr std::size_t kTrackable = 16;  // more than 24 slots ever show at once

constexpr std::array kMessages{
    produced<ubx::NavPvt>("NAV-PVT"),
    produced<ubx::NavPosecef>("NAV-POSECEF"),
    produced<ubx::NavPosllh>("NAV-POSLLH"),
    produced<ubx::NavStatus>("NAV-STATUS"),
    produced<ubx::NavVelecef>("NAV-VELECEF"),
    produced<ubx::NavVelned>("NAV-VELNED"),
    sentence(0x04, "RMC", kRmc),
    sentence(0x05, "VTG", kVtg),
    sentence(0x00, "GGA", kGga),
    sentence(0x02, "GSA", kGsa),
    sentence(0x03, "GSV", kGsv),
    sentence(0x01, "GLL", kGll),
    sentence(0x07, "GST", kGst),
    sentence(0x08, "ZDA", kZda),
    sentence(0x09, "GBS", kGbs),
    sentence(0x06, "GRS", kGrs),
    sentence(0x0A, "DTM", kDtm),
    sentence(0x0D, "GNS", kGns),
    proprietary(0x00, "PUBX,00", kPubx00),
    proprietary(0x03, "PUBX,03", kPubx03),
    proprietary(0x04, "PUBX,04", kPubx04),
    produced<ubx::NavSol>("NAV-SOL"),
    produced<ubx::NavSvinfoHead>("NAV-SVINFO", kTrackable* ubx::NavSvinfoChannel::kLength),
    produced<ubx::NavDop>("NAV-DOP"),
    produced<ubx::NavTimegps>("NAV-TIMEGPS"),
    produced<ubx::NavTimeutc>("NAV-TIMEUTC"),
    produced<ubx::NavClock>("NAV-CLOCK"),
    listed(ubx::NavSbasHead::kId, "NAV-SBAS",
           ubx::NavSbasHead::kLength + kTrackable * ubx::NavSbasBlock::kLength),
    produced<ubx::NavDgpsHead>("NAV-DGPS"),
    produced<ubx::NavAopstatus>("NAV-AOPSTATUS"),
    produced<ubx::MonHw>("MON-HW"),
    produced<ubx::MonHw2>("MON-HW2"),
    listed(ubx::MonIoHead::kId, "MON-IO", ubx::kMonitorPorts* ubx::MonIoPort::kLength),
    produced<ubx::MonMsgpp>("MON-MSGPP"),
    produced<ubx::MonRxbuf>("MON-RXBUF"),
    produced<ubx::MonTxbuf>("MON-TXBUF"),
    unasked(produced<ubx::MonRxr>("MON-RXR")),
    listed(ubx::RxmRawHead::kId, "RXM-RAW",
           ubx::RxmRawHead::kLength + kTrackable * ubx::RxmRawBlock::kLength),
    unasked(listed(ubx::RxmSfrb::kId, "RXM-SFRB",
                   kTrackable* ubx::frame_size<ubx::RxmSfrb>() - ubx::kOverheadBytes)),
    listed(ubx::RxmSvsiHead::kId, "RXM-SVSI",
           ubx::RxmSvsiHead::kLength + 32 * ubx::RxmSvsiBlock::kLength),
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
