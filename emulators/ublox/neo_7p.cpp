// The u-blox NEO-7P: protocol 14.00, firmware 1.00 (71863).
//
// Source: complete poll of a NEO-7P's default configuration, and its texts at power-on.
#include <array>

#include "emulators/ublox/profile.h"
#include "protocols/ubx/navigation.h"

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
constexpr std::size_t kTrackable = 16;  // more than 24 slots ever show at once

template <class Message>
constexpr UbloxMessage produced(std::string_view name, std::size_t repeated = 0) {
  return {Message::kId, name, ubx::frame_size<Message>() + repeated, false};
}
constexpr UbloxMessage sentence(std::uint8_t id, std::string_view name, std::size_t bytes) {
  return {{0xF0, id}, name, bytes, true};
}
constexpr UbloxMessage known(std::uint8_t message_class, std::uint8_t id) {
  return {{message_class, id}, {}, 0, message_class >= 0xF0};
}

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
    sentence(0x08, "ZDA", kZda),
    produced<ubx::NavSol>("NAV-SOL"),
    produced<ubx::NavSvinfoHead>("NAV-SVINFO", kTrackable* ubx::NavSvinfoChannel::kLength),
    produced<ubx::NavDop>("NAV-DOP"),
    produced<ubx::NavTimegps>("NAV-TIMEGPS"),
    produced<ubx::NavTimeutc>("NAV-TIMEUTC"),
    produced<ubx::NavClock>("NAV-CLOCK"),
    UbloxMessage{{0x0A, 0x09}, "MON-HW", 68, false},
    known(0x01, 0x31),
    known(0x01, 0x32),
    known(0x01, 0x60),
    known(0x02, 0x10),
    known(0x02, 0x11),
    known(0x02, 0x13),
    known(0x02, 0x20),
    known(0x02, 0x30),
    known(0x02, 0x31),
    known(0x0A, 0x02),
    known(0x0A, 0x06),
    known(0x0A, 0x07),
    known(0x0A, 0x08),
    known(0x0A, 0x0B),
    known(0x0A, 0x21),
    known(0x0B, 0x01),
    known(0x0B, 0x30),
    known(0x0B, 0x31),
    known(0x0B, 0x32),
    known(0x0B, 0x33),
    known(0x0D, 0x01),
    known(0x0D, 0x03),
    known(0x21, 0x08),
    known(0xF0, 0x06),
    known(0xF0, 0x07),
    known(0xF0, 0x09),
    known(0xF0, 0x0A),
    known(0xF0, 0x0D),
    known(0xF1, 0x00),
    known(0xF1, 0x03),
    known(0xF1, 0x04),
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
