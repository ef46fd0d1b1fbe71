#include "protocols/ubx/configuration_keys.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <initializer_list>
#include <string>
#include <vector>

namespace rigwire::protocols::ubx {
namespace {

/// What one count means.
struct Count {
  double scale = 1.0;
  std::string_view unit;
};

/// Limits of the number on the wire.
struct Limits {
  std::int64_t lower = 0;
  std::int64_t upper = 0;
};

constexpr Limits whole_range(KeyType type) {
  switch (type) {
    case KeyType::l:
      return {0, 1};
    case KeyType::u1:
    case KeyType::x1:
    case KeyType::e1:
      return {0, 0xFF};
    case KeyType::u2:
    case KeyType::x2:
      return {0, 0xFFFF};
    case KeyType::u4:
      return {0, 0xFFFFFFFF};
    case KeyType::i1:
      return {-0x80, 0x7F};
    case KeyType::i2:
      return {-0x8000, 0x7FFF};
    case KeyType::i4:
      return {-0x80000000LL, 0x7FFFFFFF};
    case KeyType::x8:
    case KeyType::r4:
    case KeyType::r8:
      break;
  }
  return {0, 0};
}

constexpr ConfigurationKey flag(std::uint32_t id, std::string_view name, bool initial) {
  return {id, KeyType::l, name, initial ? 1U : 0U, 0, 1, 0, 1.0, {}};
}
/// One of a list of numbers below 64.
constexpr ConfigurationKey choice(std::uint32_t id, std::string_view name, std::uint64_t initial,
                                  std::initializer_list<unsigned> allowed) {
  std::uint64_t choices = 0;
  for (const unsigned value : allowed) {
    choices |= std::uint64_t{1} << value;
  }
  return {id, KeyType::e1, name, initial, 0, 63, choices, 1.0, {}};
}
/// A number of the type's whole range.
constexpr ConfigurationKey number(std::uint32_t id, KeyType type, std::string_view name,
                                  std::uint64_t initial, const Count& count = {}) {
  const Limits limits = whole_range(type);
  return {id, type, name, initial, limits.lower, limits.upper, 0, count.scale, count.unit};
}
constexpr ConfigurationKey bounded(std::uint32_t id, KeyType type, std::string_view name,
                                   std::uint64_t initial, const Limits& limits,
                                   const Count& count = {}) {
  return {id, type, name, initial, limits.lower, limits.upper, 0, count.scale, count.unit};
}
constexpr ConfigurationKey real4(std::uint32_t id, std::string_view name, float initial,
                                 const Count& count = {}) {
  return number(id, KeyType::r4, name, std::bit_cast<std::uint32_t>(initial), count);
}
constexpr ConfigurationKey real8(std::uint32_t id, std::string_view name, double initial,
                                 const Count& count = {}) {
  return number(id, KeyType::r8, name, std::bit_cast<std::uint64_t>(initial), count);
}

// Clang deduces no std::array of so many.
constexpr ConfigurationKey kKeys[] = {
    // Interfaces, antenna supervision, texts and identity
    number(0x20510001, KeyType::u1, "CFG-I2C-ADDRESS", 132),
    flag(0x10510002, "CFG-I2C-EXTENDEDTIMEOUT", false),
    flag(0x10510003, "CFG-I2C-ENABLED", true),
    bounded(0x40520001, KeyType::u4, "CFG-UART1-BAUDRATE", 38400, {4800, 921600}),
    choice(0x20520002, "CFG-UART1-STOPBITS", 1, {0, 1, 2, 3}),
    choice(0x20520003, "CFG-UART1-DATABITS", 0, {0, 1}),
    choice(0x20520004, "CFG-UART1-PARITY", 0, {0, 1, 2}),
    flag(0x10520005, "CFG-UART1-ENABLED", true),
    bounded(0x40530001, KeyType::u4, "CFG-UART2-BAUDRATE", 38400, {4800, 921600}),
    choice(0x20530002, "CFG-UART2-STOPBITS", 1, {0, 1, 2, 3}),
    choice(0x20530003, "CFG-UART2-DATABITS", 0, {0, 1}),
    choice(0x20530004, "CFG-UART2-PARITY", 0, {0, 1, 2}),
    flag(0x10530005, "CFG-UART2-ENABLED", true),
    number(0x20640001, KeyType::u1, "CFG-SPI-MAXFF", 50),
    flag(0x10640002, "CFG-SPI-CPOLARITY", false),
    flag(0x10640003, "CFG-SPI-CPHASE", false),
    flag(0x10640005, "CFG-SPI-EXTENDEDTIMEOUT", false),
    flag(0x10640006, "CFG-SPI-ENABLED", false),
    flag(0x10650001, "CFG-USB-ENABLED", true),
    flag(0x10650002, "CFG-USB-SELFPOW", true),
    number(0x3065000A, KeyType::u2, "CFG-USB-VENDOR_ID", 5446),
    number(0x3065000B, KeyType::u2, "CFG-USB-PRODUCT_ID", 425),
    number(0x3065000C, KeyType::u2, "CFG-USB-POWER", 0, {1.0, "mA"}),
    number(0x5065000D, KeyType::x8, "CFG-USB-VENDOR_STR0", 0x4120786f6c622d75),
    number(0x5065000E, KeyType::x8, "CFG-USB-VENDOR_STR1", 0x2e777777202d2047),
    number(0x5065000F, KeyType::x8, "CFG-USB-VENDOR_STR2", 0x632e786f6c622d75),
    number(0x50650010, KeyType::x8, "CFG-USB-VENDOR_STR3", 0x0000000000006d6f),
    number(0x50650011, KeyType::x8, "CFG-USB-PRODUCT_STR0", 0x4720786f6c622d75),
    number(0x50650012, KeyType::x8, "CFG-USB-PRODUCT_STR1", 0x656365722053534e),
    number(0x50650013, KeyType::x8, "CFG-USB-PRODUCT_STR2", 0x0000000072657669),
    number(0x50650014, KeyType::x8, "CFG-USB-PRODUCT_STR3", 0x0000000000000000),
    number(0x50650015, KeyType::x8, "CFG-USB-SERIAL_NO_STR0", 0x0000000000000000),
    number(0x50650016, KeyType::x8, "CFG-USB-SERIAL_NO_STR1", 0x0000000000000000),
    number(0x50650017, KeyType::x8, "CFG-USB-SERIAL_NO_STR2", 0x0000000000000000),
    number(0x50650018, KeyType::x8, "CFG-USB-SERIAL_NO_STR3", 0x0000000000000000),
    flag(0x10710001, "CFG-I2CINPROT-UBX", true),
    flag(0x10710002, "CFG-I2CINPROT-NMEA", true),
    flag(0x10710004, "CFG-I2CINPROT-RTCM3X", true),
    flag(0x10710005, "CFG-I2CINPROT-SPARTN", true),
    flag(0x10720001, "CFG-I2COUTPROT-UBX", true),
    flag(0x10720002, "CFG-I2COUTPROT-NMEA", true),
    flag(0x10720004, "CFG-I2COUTPROT-RTCM3X", true),
    flag(0x10730001, "CFG-UART1INPROT-UBX", true),
    flag(0x10730002, "CFG-UART1INPROT-NMEA", true),
    flag(0x10730004, "CFG-UART1INPROT-RTCM3X", true),
    flag(0x10730005, "CFG-UART1INPROT-SPARTN", true),
    flag(0x10740001, "CFG-UART1OUTPROT-UBX", true),
    flag(0x10740002, "CFG-UART1OUTPROT-NMEA", true),
    flag(0x10740004, "CFG-UART1OUTPROT-RTCM3X", true),
    flag(0x10750001, "CFG-UART2INPROT-UBX", true),
    flag(0x10750002, "CFG-UART2INPROT-NMEA", false),
    flag(0x10750004, "CFG-UART2INPROT-RTCM3X", true),
    flag(0x10750005, "CFG-UART2INPROT-SPARTN", true),
    flag(0x10760001, "CFG-UART2OUTPROT-UBX", false),
    flag(0x10760002, "CFG-UART2OUTPROT-NMEA", false),
    flag(0x10760004, "CFG-UART2OUTPROT-RTCM3X", true),
    flag(0x10770001, "CFG-USBINPROT-UBX", true),
    flag(0x10770002, "CFG-USBINPROT-NMEA", true),
    flag(0x10770004, "CFG-USBINPROT-RTCM3X", true),
    flag(0x10770005, "CFG-USBINPROT-SPARTN", true),
    flag(0x10780001, "CFG-USBOUTPROT-UBX", true),
    flag(0x10780002, "CFG-USBOUTPROT-NMEA", true),
    flag(0x10780004, "CFG-USBOUTPROT-RTCM3X", true),
    flag(0x10790001, "CFG-SPIINPROT-UBX", true),
    flag(0x10790002, "CFG-SPIINPROT-NMEA", true),
    flag(0x10790004, "CFG-SPIINPROT-RTCM3X", true),
    flag(0x10790005, "CFG-SPIINPROT-SPARTN", true),
    flag(0x107A0001, "CFG-SPIOUTPROT-UBX", true),
    flag(0x107A0002, "CFG-SPIOUTPROT-NMEA", true),
    flag(0x107A0004, "CFG-SPIOUTPROT-RTCM3X", true),
    number(0x20920001, KeyType::x1, "CFG-INFMSG-UBX_I2C", 0x00),
    number(0x20920002, KeyType::x1, "CFG-INFMSG-UBX_UART1", 0x00),
    number(0x20920003, KeyType::x1, "CFG-INFMSG-UBX_UART2", 0x00),
    number(0x20920004, KeyType::x1, "CFG-INFMSG-UBX_USB", 0x00),
    number(0x20920005, KeyType::x1, "CFG-INFMSG-UBX_SPI", 0x00),
    number(0x20920006, KeyType::x1, "CFG-INFMSG-NMEA_I2C", 0x07),
    number(0x20920007, KeyType::x1, "CFG-INFMSG-NMEA_UART1", 0x07),
    number(0x20920008, KeyType::x1, "CFG-INFMSG-NMEA_UART2", 0x07),
    number(0x20920009, KeyType::x1, "CFG-INFMSG-NMEA_USB", 0x07),
    number(0x2092000A, KeyType::x1, "CFG-INFMSG-NMEA_SPI", 0x07),
    flag(0x10A20001, "CFG-TXREADY-ENABLED", false),
    flag(0x10A20002, "CFG-TXREADY-POLARITY", false),
    number(0x20A20003, KeyType::u1, "CFG-TXREADY-PIN", 0),
    number(0x30A20004, KeyType::u2, "CFG-TXREADY-THRESHOLD", 0),
    choice(0x20A20005, "CFG-TXREADY-INTERFACE", 0, {0, 1}),
    flag(0x10A3002E, "CFG-HW-ANT_CFG_VOLTCTRL", false),
    flag(0x10A3002F, "CFG-HW-ANT_CFG_SHORTDET", false),
    flag(0x10A30030, "CFG-HW-ANT_CFG_SHORTDET_POL", true),
    flag(0x10A30031, "CFG-HW-ANT_CFG_OPENDET", false),
    flag(0x10A30032, "CFG-HW-ANT_CFG_OPENDET_POL", true),
    flag(0x10A30033, "CFG-HW-ANT_CFG_PWRDOWN", false),
    flag(0x10A30034, "CFG-HW-ANT_CFG_PWRDOWN_POL", true),
    flag(0x10A30035, "CFG-HW-ANT_CFG_RECOVER", false),
    number(0x20A30036, KeyType::u1, "CFG-HW-ANT_SUP_SWITCH_PIN", 16),
    number(0x20A30037, KeyType::u1, "CFG-HW-ANT_SUP_SHORT_PIN", 15),
    number(0x20A30038, KeyType::u1, "CFG-HW-ANT_SUP_OPEN_PIN", 14),
    number(0x30A3003C, KeyType::u2, "CFG-HW-ANT_ON_SHORT_US", 500),
    choice(0x20A30054, "CFG-HW-ANT_SUP_ENGINE", 0, {0, 1}),
    number(0x20A30055, KeyType::u1, "CFG-HW-ANT_SUP_SHORT_THR", 0, {1.0, "mV"}),
    number(0x20A30056, KeyType::u1, "CFG-HW-ANT_SUP_OPEN_THR", 0, {1.0, "mV"}),
    flag(0x10C70001, "CFG-RINV-DUMP", false),
    flag(0x10C70002, "CFG-RINV-BINARY", false),
    number(0x20C70003, KeyType::u1, "CFG-RINV-DATA_SIZE", 22),
    number(0x50C70004, KeyType::x8, "CFG-RINV-CHUNK0", 0x203a656369746f4e),
    number(0x50C70005, KeyType::x8, "CFG-RINV-CHUNK1", 0x2061746164206f6e),
    number(0x50C70006, KeyType::x8, "CFG-RINV-CHUNK2", 0x0000216465766173),
    number(0x50C70007, KeyType::x8, "CFG-RINV-CHUNK3", 0x0000000000000000),
    flag(0x10F60009, "CFG-SEC-CFG_LOCK", false),
    number(0x30F6000A, KeyType::u2, "CFG-SEC-CFG_LOCK_UNLOCKGRP1", 0),
    number(0x30F6000B, KeyType::u2, "CFG-SEC-CFG_LOCK_UNLOCKGRP2", 0),
    flag(0x10F60051, "CFG-SEC-JAMDET_SENSITIVITY_HI", true),
    flag(0x10F6005D, "CFG-SEC-SPOOFDET_SIM_SIG_DIS", false),
    // Navigation, satellites and signals, NMEA
    choice(0x20110011, "CFG-NAVSPG-FIXMODE", 2, {1, 2, 3}),
    flag(0x10110013, "CFG-NAVSPG-INIFIX3D", false),
    number(0x30110017, KeyType::u2, "CFG-NAVSPG-WKNROLLOVER", 2320),
    choice(0x2011001C, "CFG-NAVSPG-UTCSTANDARD", 0, {0, 3, 5, 6, 7, 8, 9}),
    choice(0x20110021, "CFG-NAVSPG-DYNMODEL", 0, {0, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}),
    flag(0x10110025, "CFG-NAVSPG-ACKAIDING", false),
    flag(0x10110061, "CFG-NAVSPG-USE_USRDAT", false),
    real8(0x50110062, "CFG-NAVSPG-USRDAT_MAJA", 6378137.0, {1.0, "m"}),
    real8(0x50110063, "CFG-NAVSPG-USRDAT_FLAT", 298.25722356300002502),
    real4(0x40110064, "CFG-NAVSPG-USRDAT_DX", 0.0F, {1.0, "m"}),
    real4(0x40110065, "CFG-NAVSPG-USRDAT_DY", 0.0F, {1.0, "m"}),
    real4(0x40110066, "CFG-NAVSPG-USRDAT_DZ", 0.0F, {1.0, "m"}),
    real4(0x40110067, "CFG-NAVSPG-USRDAT_ROTX", 0.0F, {1.0, "arcsec"}),
    real4(0x40110068, "CFG-NAVSPG-USRDAT_ROTY", 0.0F, {1.0, "arcsec"}),
    real4(0x40110069, "CFG-NAVSPG-USRDAT_ROTZ", 0.0F, {1.0, "arcsec"}),
    real4(0x4011006A, "CFG-NAVSPG-USRDAT_SCALE", 0.0F, {1.0, "ppm"}),
    number(0x201100A1, KeyType::u1, "CFG-NAVSPG-INFIL_MINSVS", 3),
    number(0x201100A2, KeyType::u1, "CFG-NAVSPG-INFIL_MAXSVS", 32),
    number(0x201100A3, KeyType::u1, "CFG-NAVSPG-INFIL_MINCNO", 6, {1.0, "dBHz"}),
    bounded(0x201100A4, KeyType::i1, "CFG-NAVSPG-INFIL_MINELEV", 10, {-90, 90}, {1.0, "deg"}),
    number(0x201100AA, KeyType::u1, "CFG-NAVSPG-INFIL_NCNOTHRS", 0),
    number(0x201100AB, KeyType::u1, "CFG-NAVSPG-INFIL_CNOTHRS", 0),
    number(0x301100B1, KeyType::u2, "CFG-NAVSPG-OUTFIL_PDOP", 250, {0.1, ""}),
    number(0x301100B2, KeyType::u2, "CFG-NAVSPG-OUTFIL_TDOP", 250, {0.1, ""}),
    number(0x301100B3, KeyType::u2, "CFG-NAVSPG-OUTFIL_PACC", 100, {1.0, "m"}),
    number(0x301100B4, KeyType::u2, "CFG-NAVSPG-OUTFIL_TACC", 350, {1.0, "m"}),
    number(0x301100B5, KeyType::u2, "CFG-NAVSPG-OUTFIL_FACC", 150, {0.01, "m/s"}),
    number(0x401100C1, KeyType::i4, "CFG-NAVSPG-CONSTR_ALT", 0, {0.01, "m"}),
    number(0x401100C2, KeyType::u4, "CFG-NAVSPG-CONSTR_ALTVAR", 10000, {0.0001, "m^2"}),
    number(0x201100C4, KeyType::u1, "CFG-NAVSPG-CONSTR_DGNSSTO", 60, {1.0, "s"}),
    flag(0x101100D7, "CFG-NAVSPG-PL_ENA", true),
    flag(0x101100DD, "CFG-NAVSPG-ONLY_AUTHDATA", false),
    number(0x301100DE, KeyType::u2, "CFG-NAVSPG-MAX_TIMETRUSTED_ACC", 9, {1.0, "s"}),
    choice(0x20140011, "CFG-NAVHPG-DGNSSMODE", 3, {2, 3, 5}),
    flag(0x10170001, "CFG-NAV2-OUT_ENABLED", false),
    flag(0x10170002, "CFG-NAV2-SBAS_USE_INTEGRITY", false),
    flag(0x10170003, "CFG-NAV2-NAVSPG_ONLY_AUTHDATA", false),
    bounded(0x30210001, KeyType::u2, "CFG-RATE-MEAS", 1000, {25, 65535}, {0.001, "s"}),
    bounded(0x30210002, KeyType::u2, "CFG-RATE-NAV", 1, {1, 127}),
    choice(0x20210003, "CFG-RATE-TIMEREF", 1, {0, 1, 2, 3, 4}),
    number(0x20250038, KeyType::u1, "CFG-MOT-GNSSSPEED_THRS", 0, {0.01, "m/s"}),
    number(0x3025003B, KeyType::u2, "CFG-MOT-GNSSDIST_THRS", 0, {1.0, "m"}),
    flag(0x10310001, "CFG-SIGNAL-GPS_L1CA_ENA", true),
    flag(0x10310003, "CFG-SIGNAL-GPS_L2C_ENA", true),
    flag(0x10310005, "CFG-SIGNAL-SBAS_L1CA_ENA", true),
    flag(0x10310007, "CFG-SIGNAL-GAL_E1_ENA", true),
    flag(0x1031000A, "CFG-SIGNAL-GAL_E5B_ENA", true),
    flag(0x1031000D, "CFG-SIGNAL-BDS_B1_ENA", true),
    flag(0x1031000E, "CFG-SIGNAL-BDS_B2_ENA", true),
    flag(0x10310012, "CFG-SIGNAL-QZSS_L1CA_ENA", true),
    flag(0x10310014, "CFG-SIGNAL-QZSS_L1S_ENA", false),
    flag(0x10310015, "CFG-SIGNAL-QZSS_L2C_ENA", true),
    flag(0x10310018, "CFG-SIGNAL-GLO_L1_ENA", true),
    flag(0x1031001A, "CFG-SIGNAL-GLO_L2_ENA", true),
    flag(0x1031001F, "CFG-SIGNAL-GPS_ENA", true),
    flag(0x10310020, "CFG-SIGNAL-SBAS_ENA", true),
    flag(0x10310021, "CFG-SIGNAL-GAL_ENA", true),
    flag(0x10310022, "CFG-SIGNAL-BDS_ENA", true),
    flag(0x10310024, "CFG-SIGNAL-QZSS_ENA", true),
    flag(0x10310025, "CFG-SIGNAL-GLO_ENA", true),
    flag(0x10340014, "CFG-BDS-USE_GEO_PRN", false),
    flag(0x10350005, "CFG-GAL-USE_OSNMA", false),
    number(0x20350007, KeyType::u1, "CFG-GAL-OSNMA_MINTAGLENGTH", 80),
    flag(0x10350009, "CFG-GAL-OSNMA_TIMESYNC", true),
    flag(0x10360002, "CFG-SBAS-USE_TESTMODE", false),
    flag(0x10360003, "CFG-SBAS-USE_RANGING", true),
    flag(0x10360004, "CFG-SBAS-USE_DIFFCORR", true),
    flag(0x10360005, "CFG-SBAS-USE_INTEGRITY", false),
    number(0x50360006, KeyType::x8, "CFG-SBAS-PRNSCANMASK", 0x000000000003ab88),
    flag(0x10360007, "CFG-SBAS-USE_IONOONLY", false),
    number(0x30360008, KeyType::x2, "CFG-SBAS-ACCEPT_NOT_IN_PRNMASK", 0x0000),
    flag(0x10370005, "CFG-QZSS-USE_SLAS_DGNSS", true),
    flag(0x10370006, "CFG-QZSS-USE_SLAS_TESTMODE", false),
    flag(0x10370007, "CFG-QZSS-USE_SLAS_RAIM_UNCORR", false),
    number(0x30370008, KeyType::u2, "CFG-QZSS-SLAS_MAX_BASELINE", 350, {1.0, "km"}),
    choice(0x20930001, "CFG-NMEA-PROTVER", 42, {21, 23, 40, 41, 42}),
    choice(0x20930002, "CFG-NMEA-MAXSVS", 0, {0, 8, 12, 16}),
    flag(0x10930003, "CFG-NMEA-COMPAT", false),
    flag(0x10930004, "CFG-NMEA-CONSIDER", true),
    flag(0x10930005, "CFG-NMEA-LIMIT82", false),
    flag(0x10930006, "CFG-NMEA-HIGHPREC", false),
    choice(0x20930007, "CFG-NMEA-SVNUMBERING", 0, {0, 1}),
    flag(0x10930011, "CFG-NMEA-FILT_GPS", false),
    flag(0x10930012, "CFG-NMEA-FILT_SBAS", false),
    flag(0x10930013, "CFG-NMEA-FILT_GAL", false),
    flag(0x10930015, "CFG-NMEA-FILT_QZSS", false),
    flag(0x10930016, "CFG-NMEA-FILT_GLO", false),
    flag(0x10930017, "CFG-NMEA-FILT_BDS", false),
    flag(0x10930021, "CFG-NMEA-OUT_INVFIX", false),
    flag(0x10930022, "CFG-NMEA-OUT_MSKFIX", false),
    flag(0x10930023, "CFG-NMEA-OUT_INVTIME", false),
    flag(0x10930024, "CFG-NMEA-OUT_INVDATE", false),
    flag(0x10930025, "CFG-NMEA-OUT_ONLYGPS", false),
    flag(0x10930026, "CFG-NMEA-OUT_FROZENCOG", false),
    choice(0x20930031, "CFG-NMEA-MAINTALKERID", 0, {0, 1, 2, 3, 4, 5, 7}),
    choice(0x20930032, "CFG-NMEA-GSVTALKERID", 0, {0, 1}),
    number(0x30930033, KeyType::u2, "CFG-NMEA-BDSTALKERID", 0),
    // Fixed position, RTCM, time pulse, geofences, log, odometer
    choice(0x20030001, "CFG-TMODE-MODE", 0, {0, 1, 2}),
    choice(0x20030002, "CFG-TMODE-POS_TYPE", 0, {0, 1}),
    number(0x40030003, KeyType::i4, "CFG-TMODE-ECEF_X", 0, {1.0, "cm"}),
    number(0x40030004, KeyType::i4, "CFG-TMODE-ECEF_Y", 0, {1.0, "cm"}),
    number(0x40030005, KeyType::i4, "CFG-TMODE-ECEF_Z", 0, {1.0, "cm"}),
    bounded(0x20030006, KeyType::i1, "CFG-TMODE-ECEF_X_HP", 0, {-99, 99}, {0.1, "mm"}),
    bounded(0x20030007, KeyType::i1, "CFG-TMODE-ECEF_Y_HP", 0, {-99, 99}, {0.1, "mm"}),
    bounded(0x20030008, KeyType::i1, "CFG-TMODE-ECEF_Z_HP", 0, {-99, 99}, {0.1, "mm"}),
    bounded(0x40030009, KeyType::i4, "CFG-TMODE-LAT", 0, {-900000000, 900000000}, {1e-7, "deg"}),
    bounded(0x4003000A, KeyType::i4, "CFG-TMODE-LON", 0, {-1800000000, 1800000000}, {1e-7, "deg"}),
    number(0x4003000B, KeyType::i4, "CFG-TMODE-HEIGHT", 0, {1.0, "cm"}),
    bounded(0x2003000C, KeyType::i1, "CFG-TMODE-LAT_HP", 0, {-99, 99}, {1e-9, "deg"}),
    bounded(0x2003000D, KeyType::i1, "CFG-TMODE-LON_HP", 0, {-99, 99}, {1e-9, "deg"}),
    bounded(0x2003000E, KeyType::i1, "CFG-TMODE-HEIGHT_HP", 0, {-99, 99}, {0.1, "mm"}),
    number(0x4003000F, KeyType::u4, "CFG-TMODE-FIXED_POS_ACC", 0, {0.1, "mm"}),
    number(0x40030010, KeyType::u4, "CFG-TMODE-SVIN_MIN_DUR", 0, {1.0, "s"}),
    number(0x40030011, KeyType::u4, "CFG-TMODE-SVIN_ACC_LIMIT", 0, {0.1, "mm"}),
    number(0x30050001, KeyType::i2, "CFG-TP-ANT_CABLEDELAY", 50, {1e-9, "s"}),
    number(0x40050002, KeyType::u4, "CFG-TP-PERIOD_TP1", 1000000, {1e-6, "s"}),
    number(0x40050003, KeyType::u4, "CFG-TP-PERIOD_LOCK_TP1", 1000000, {1e-6, "s"}),
    number(0x40050004, KeyType::u4, "CFG-TP-LEN_TP1", 0, {1e-6, "s"}),
    number(0x40050005, KeyType::u4, "CFG-TP-LEN_LOCK_TP1", 100000, {1e-6, "s"}),
    number(0x40050006, KeyType::i4, "CFG-TP-USER_DELAY_TP1", 0, {1e-9, "s"}),
    flag(0x10050007, "CFG-TP-TP1_ENA", true),
    flag(0x10050008, "CFG-TP-SYNC_GNSS_TP1", true),
    flag(0x10050009, "CFG-TP-USE_LOCKED_TP1", true),
    flag(0x1005000A, "CFG-TP-ALIGN_TO_TOW_TP1", true),
    flag(0x1005000B, "CFG-TP-POL_TP1", true),
    choice(0x2005000C, "CFG-TP-TIMEGRID_TP1", 0, {0, 1, 2, 3, 4}),
    choice(0x20050023, "CFG-TP-PULSE_DEF", 0, {0, 1}),
    number(0x40050024, KeyType::u4, "CFG-TP-FREQ_TP1", 1, {1.0, "Hz"}),
    number(0x40050025, KeyType::u4, "CFG-TP-FREQ_LOCK_TP1", 1, {1.0, "Hz"}),
    real8(0x5005002A, "CFG-TP-DUTY_TP1", 0.0, {1.0, "%"}),
    real8(0x5005002B, "CFG-TP-DUTY_LOCK_TP1", 10.0, {1.0, "%"}),
    choice(0x20050030, "CFG-TP-PULSE_LENGTH_DEF", 1, {0, 1}),
    choice(0x20050035, "CFG-TP-DRSTR_TP1", 1, {0, 1, 2, 3}),
    number(0x30090001, KeyType::u2, "CFG-RTCM-DF003_OUT", 0),
    number(0x30090008, KeyType::u2, "CFG-RTCM-DF003_IN", 0),
    choice(0x20090009, "CFG-RTCM-DF003_IN_FILTER", 0, {0, 1, 2}),
    flag(0x10220001, "CFG-ODO-USE_ODO", false),
    flag(0x10220002, "CFG-ODO-USE_COG", false),
    flag(0x10220003, "CFG-ODO-OUTLPVEL", false),
    flag(0x10220004, "CFG-ODO-OUTLPCOG", false),
    choice(0x20220005, "CFG-ODO-PROFILE", 0, {0, 1, 2, 3, 4}),
    number(0x20220021, KeyType::u1, "CFG-ODO-COGMAXSPEED", 10, {1e-1, "m/s"}),
    number(0x20220022, KeyType::u1, "CFG-ODO-COGMAXPOSACC", 50),
    number(0x20220031, KeyType::u1, "CFG-ODO-VELLPGAIN", 153),
    number(0x20220032, KeyType::u1, "CFG-ODO-COGLPGAIN", 76),
    choice(0x20240011, "CFG-GEOFENCE-CONFLVL", 0, {0, 1, 2, 3, 4, 5}),
    flag(0x10240012, "CFG-GEOFENCE-USE_PIO", false),
    choice(0x20240013, "CFG-GEOFENCE-PINPOL", 0, {0, 1}),
    number(0x20240014, KeyType::u1, "CFG-GEOFENCE-PIN", 3),
    flag(0x10240020, "CFG-GEOFENCE-USE_FENCE1", false),
    number(0x40240021, KeyType::i4, "CFG-GEOFENCE-FENCE1_LAT", 0, {1e-7, "deg"}),
    number(0x40240022, KeyType::i4, "CFG-GEOFENCE-FENCE1_LON", 0, {1e-7, "deg"}),
    number(0x40240023, KeyType::u4, "CFG-GEOFENCE-FENCE1_RAD", 0, {0.01, "m"}),
    flag(0x10240030, "CFG-GEOFENCE-USE_FENCE2", false),
    number(0x40240031, KeyType::i4, "CFG-GEOFENCE-FENCE2_LAT", 0, {1e-7, "deg"}),
    number(0x40240032, KeyType::i4, "CFG-GEOFENCE-FENCE2_LON", 0, {1e-7, "deg"}),
    number(0x40240033, KeyType::u4, "CFG-GEOFENCE-FENCE2_RAD", 0, {0.01, "m"}),
    flag(0x10240040, "CFG-GEOFENCE-USE_FENCE3", false),
    number(0x40240041, KeyType::i4, "CFG-GEOFENCE-FENCE3_LAT", 0, {1e-7, "deg"}),
    number(0x40240042, KeyType::i4, "CFG-GEOFENCE-FENCE3_LON", 0, {1e-7, "deg"}),
    number(0x40240043, KeyType::u4, "CFG-GEOFENCE-FENCE3_RAD", 0, {0.01, "m"}),
    flag(0x10240050, "CFG-GEOFENCE-USE_FENCE4", false),
    number(0x40240051, KeyType::i4, "CFG-GEOFENCE-FENCE4_LAT", 0, {1e-7, "deg"}),
    number(0x40240052, KeyType::i4, "CFG-GEOFENCE-FENCE4_LON", 0, {1e-7, "deg"}),
    number(0x40240053, KeyType::u4, "CFG-GEOFENCE-FENCE4_RAD", 0, {0.01, "m"}),
    choice(0x20A70001, "CFG-SPARTN-USE_SOURCE", 0, {0, 1}),
    flag(0x10DE0002, "CFG-LOGFILTER-RECORD_ENA", false),
    flag(0x10DE0004, "CFG-LOGFILTER-APPLY_ALL_FILTERS", false),
    number(0x30DE0005, KeyType::u2, "CFG-LOGFILTER-MIN_INTERVAL", 0, {1.0, "s"}),
    number(0x30DE0006, KeyType::u2, "CFG-LOGFILTER-TIME_THRS", 0, {1.0, "s"}),
    number(0x30DE0007, KeyType::u2, "CFG-LOGFILTER-SPEED_THRS", 0, {1.0, "m/s"}),
    number(0x40DE0008, KeyType::u4, "CFG-LOGFILTER-POSITION_THRS", 0, {1.0, "m"}),
};

// CFG-MSGOUT. Classes and ids: HPG 1.50 interface description, sections 2.6, 3.8 and 4.2
// (overviews); the class of the second navigation solution's sentences from pyubx2.
constexpr std::array<MessageRateKeys, 115> kMessages{{
    {0x20910006, "UBX_NAV_PVT", {0x01, 0x07}},
    {0x20910010, "UBX_NAV_ORB", {0x01, 0x34}},
    {0x20910015, "UBX_NAV_SAT", {0x01, 0x35}},
    {0x2091001A, "UBX_NAV_STATUS", {0x01, 0x03}},
    {0x20910024, "UBX_NAV_POSECEF", {0x01, 0x01}},
    {0x20910029, "UBX_NAV_POSLLH", {0x01, 0x02}},
    {0x2091002E, "UBX_NAV_HPPOSECEF", {0x01, 0x13}},
    {0x20910033, "UBX_NAV_HPPOSLLH", {0x01, 0x14}},
    {0x20910038, "UBX_NAV_DOP", {0x01, 0x04}},
    {0x2091003D, "UBX_NAV_VELECEF", {0x01, 0x11}},
    {0x20910042, "UBX_NAV_VELNED", {0x01, 0x12}},
    {0x20910047, "UBX_NAV_TIMEGPS", {0x01, 0x20}},
    {0x2091004C, "UBX_NAV_TIMEGLO", {0x01, 0x23}},
    {0x20910051, "UBX_NAV_TIMEBDS", {0x01, 0x24}},
    {0x20910056, "UBX_NAV_TIMEGAL", {0x01, 0x25}},
    {0x2091005B, "UBX_NAV_TIMEUTC", {0x01, 0x21}},
    {0x20910060, "UBX_NAV_TIMELS", {0x01, 0x26}},
    {0x20910065, "UBX_NAV_CLOCK", {0x01, 0x22}},
    {0x2091006A, "UBX_NAV_SBAS", {0x01, 0x32}},
    {0x2091007E, "UBX_NAV_ODO", {0x01, 0x09}},
    {0x20910083, "UBX_NAV_COV", {0x01, 0x36}},
    {0x20910088, "UBX_NAV_SVIN", {0x01, 0x3B}},
    {0x2091008D, "UBX_NAV_RELPOSNED", {0x01, 0x3C}},
    {0x20910092, "UBX_TIM_VRFY", {0x0D, 0x06}},
    {0x209100A1, "UBX_NAV_GEOFENCE", {0x01, 0x39}},
    {0x209100A6, "NMEA_ID_DTM", {0xF0, 0x0A}},
    {0x209100AB, "NMEA_ID_RMC", {0xF0, 0x04}, 1},
    {0x209100B0, "NMEA_ID_VTG", {0xF0, 0x05}, 1},
    {0x209100B5, "NMEA_ID_GNS", {0xF0, 0x0D}},
    {0x209100BA, "NMEA_ID_GGA", {0xF0, 0x00}, 1},
    {0x209100BF, "NMEA_ID_GSA", {0xF0, 0x02}, 1},
    {0x209100C4, "NMEA_ID_GSV", {0xF0, 0x03}, 1},
    {0x209100C9, "NMEA_ID_GLL", {0xF0, 0x01}, 1},
    {0x209100CE, "NMEA_ID_GRS", {0xF0, 0x06}},
    {0x209100D3, "NMEA_ID_GST", {0xF0, 0x07}},
    {0x209100D8, "NMEA_ID_ZDA", {0xF0, 0x08}},
    {0x209100DD, "NMEA_ID_GBS", {0xF0, 0x09}},
    {0x209100E7, "NMEA_ID_VLW", {0xF0, 0x0F}},
    {0x209100EC, "PUBX_ID_POLYP", {0xF1, 0x00}},
    {0x209100F1, "PUBX_ID_POLYS", {0xF1, 0x03}},
    {0x209100F6, "PUBX_ID_POLYT", {0xF1, 0x04}},
    {0x2091015F, "UBX_NAV_EOE", {0x01, 0x61}},
    {0x20910178, "UBX_TIM_TM2", {0x0D, 0x03}},
    {0x2091017D, "UBX_TIM_TP", {0x0D, 0x01}},
    {0x20910187, "UBX_MON_RXR", {0x0A, 0x21}},
    {0x20910196, "UBX_MON_MSGPP", {0x0A, 0x06}},
    {0x2091019B, "UBX_MON_TXBUF", {0x0A, 0x08}},
    {0x209101A0, "UBX_MON_RXBUF", {0x0A, 0x07}},
    {0x209101A5, "UBX_MON_IO", {0x0A, 0x02}},
    {0x209101B4, "UBX_MON_HW", {0x0A, 0x09}},
    {0x209101B9, "UBX_MON_HW2", {0x0A, 0x0B}},
    {0x20910204, "UBX_RXM_MEASX", {0x02, 0x14}},
    {0x20910231, "UBX_RXM_SFRBX", {0x02, 0x13}},
    {0x20910259, "UBX_LOG_INFO", {0x21, 0x08}},
    {0x2091025E, "UBX_RXM_RLM", {0x02, 0x59}},
    {0x20910268, "UBX_RXM_RTCM", {0x02, 0x32}},
    {0x209102A4, "UBX_RXM_RAWX", {0x02, 0x15}},
    {0x209102BD, "RTCM_3X_TYPE1005", {0xF5, 0x05}},
    {0x209102CC, "RTCM_3X_TYPE1077", {0xF5, 0x4D}},
    {0x209102D1, "RTCM_3X_TYPE1087", {0xF5, 0x57}},
    {0x209102D6, "RTCM_3X_TYPE1127", {0xF5, 0x7F}},
    {0x209102FE, "RTCM_3X_TYPE4072_0", {0xF5, 0xFE}},
    {0x20910303, "RTCM_3X_TYPE1230", {0xF5, 0xE6}},
    {0x20910318, "RTCM_3X_TYPE1097", {0xF5, 0x61}},
    {0x20910336, "UBX_NAV_SLAS", {0x01, 0x42}},
    {0x20910345, "UBX_NAV_SIG", {0x01, 0x43}},
    {0x2091034F, "UBX_MON_COMMS", {0x0A, 0x36}},
    {0x20910354, "UBX_MON_HW3", {0x0A, 0x37}},
    {0x20910359, "UBX_MON_RF", {0x0A, 0x38}},
    {0x2091035E, "RTCM_3X_TYPE1074", {0xF5, 0x4A}},
    {0x20910363, "RTCM_3X_TYPE1084", {0xF5, 0x54}},
    {0x20910368, "RTCM_3X_TYPE1094", {0xF5, 0x5E}},
    {0x2091036D, "RTCM_3X_TYPE1124", {0xF5, 0x7C}},
    {0x20910381, "RTCM_3X_TYPE4072_1", {0xF5, 0xFD}},
    {0x20910386, "UBX_NAV_TIMEQZSS", {0x01, 0x27}},
    {0x2091038B, "UBX_MON_SPAN", {0x0A, 0x31}},
    {0x209103A8, "UBX_NAV_TIMETRUSTED", {0x01, 0x64}},
    {0x20910400, "NMEA_ID_RLM", {0xF0, 0x0B}},
    {0x20910415, "UBX_NAV_PL", {0x01, 0x62}},
    {0x20910430, "UBX_NAV2_CLOCK", {0x29, 0x22}},
    {0x20910435, "UBX_NAV2_COV", {0x29, 0x36}},
    {0x20910465, "UBX_NAV2_DOP", {0x29, 0x04}},
    {0x20910475, "UBX_NAV2_ODO", {0x29, 0x09}},
    {0x20910480, "UBX_NAV2_POSECEF", {0x29, 0x01}},
    {0x20910485, "UBX_NAV2_POSLLH", {0x29, 0x02}},
    {0x20910490, "UBX_NAV2_PVT", {0x29, 0x07}},
    {0x20910495, "UBX_NAV2_SAT", {0x29, 0x35}},
    {0x20910500, "UBX_NAV2_SBAS", {0x29, 0x32}},
    {0x20910505, "UBX_NAV2_SIG", {0x29, 0x43}},
    {0x20910510, "UBX_NAV2_SLAS", {0x29, 0x42}},
    {0x20910515, "UBX_NAV2_STATUS", {0x29, 0x03}},
    {0x20910520, "UBX_NAV2_SVIN", {0x29, 0x3B}},
    {0x20910525, "UBX_NAV2_TIMEBDS", {0x29, 0x24}},
    {0x20910530, "UBX_NAV2_TIMEGAL", {0x29, 0x25}},
    {0x20910535, "UBX_NAV2_TIMEGLO", {0x29, 0x23}},
    {0x20910540, "UBX_NAV2_TIMEGPS", {0x29, 0x20}},
    {0x20910545, "UBX_NAV2_TIMELS", {0x29, 0x26}},
    {0x20910550, "UBX_NAV2_TIMEUTC", {0x29, 0x21}},
    {0x20910555, "UBX_NAV2_VELECEF", {0x29, 0x11}},
    {0x20910560, "UBX_NAV2_VELNED", {0x29, 0x12}},
    {0x20910565, "UBX_NAV2_EOE", {0x29, 0x61}},
    {0x20910575, "UBX_NAV2_TIMEQZSS", {0x29, 0x27}},
    {0x20910605, "UBX_RXM_SPARTN", {0x02, 0x33}},
    {0x20910634, "UBX_SEC_SIG", {0x27, 0x09}},
    {0x20910652, "NMEA_NAV2_ID_RMC", {0xF7, 0x04}},
    {0x20910657, "NMEA_NAV2_ID_VTG", {0xF7, 0x05}},
    {0x2091065C, "NMEA_NAV2_ID_GNS", {0xF7, 0x0D}},
    {0x20910661, "NMEA_NAV2_ID_GGA", {0xF7, 0x00}},
    {0x20910666, "NMEA_NAV2_ID_GSA", {0xF7, 0x02}},
    {0x20910670, "NMEA_NAV2_ID_GLL", {0xF7, 0x01}},
    {0x2091067F, "NMEA_NAV2_ID_ZDA", {0xF7, 0x08}},
    {0x20910689, "UBX_SEC_SIGLOG", {0x27, 0x10}},
    {0x2091069D, "UBX_MON_SYS", {0x0A, 0x39}},
    {0x209106B6, "UBX_RXM_COR", {0x02, 0x34}},
    {0x209106CA, "UBX_SEC_OSNMA", {0x27, 0x0A}},
}};

constexpr std::array<std::string_view, kMessageRatePorts> kPortSuffixes{"_I2C", "_UART1", "_UART2",
                                                                        "_USB", "_SPI"};

/// All rows in one, with the names of the message rates spelled out.
class Table {
 public:
  Table() {
    names_.reserve(kMessages.size() * kMessageRatePorts);
    for (const MessageRateKeys& message : kMessages) {
      for (std::uint32_t port = 0; port < kMessageRatePorts; ++port) {
        names_.push_back(
            std::string("CFG-MSGOUT-").append(message.name).append(kPortSuffixes[port]));
        keys_.push_back({message.first + port,
                         KeyType::u1,
                         names_.back(),
                         message.initial,
                         0,
                         0xFF,
                         0,
                         1.0,
                         {}});
      }
    }
    std::ranges::sort(keys_, {}, &ConfigurationKey::id);
  }
  [[nodiscard]] const std::vector<ConfigurationKey>& keys() const { return keys_; }

 private:
  std::vector<std::string> names_;
  std::vector<ConfigurationKey> keys_{std::begin(kKeys), std::end(kKeys)};
};

std::int64_t signed_value(KeyType type, std::uint64_t value) {
  switch (type) {
    case KeyType::i1:
      return std::bit_cast<std::int8_t>(static_cast<std::uint8_t>(value));
    case KeyType::i2:
      return std::bit_cast<std::int16_t>(static_cast<std::uint16_t>(value));
    case KeyType::i4:
      return std::bit_cast<std::int32_t>(static_cast<std::uint32_t>(value));
    default:
      return static_cast<std::int64_t>(value);
  }
}

}  // namespace

bool is_allowed(const ConfigurationKey& key, std::uint64_t value) {
  switch (key.type) {
    case KeyType::r4:
      return std::isfinite(std::bit_cast<float>(static_cast<std::uint32_t>(value)));
    case KeyType::r8:
      return std::isfinite(std::bit_cast<double>(value));
    case KeyType::x8:
      return true;
    default:
      break;
  }
  const std::int64_t number = signed_value(key.type, value);
  return number >= key.lower && number <= key.upper &&
         (key.choices == 0 || (key.choices >> static_cast<unsigned>(number) & 1U) != 0);
}

std::span<const ConfigurationKey> configuration_keys() {
  static const Table kTable;
  return kTable.keys();
}

std::size_t key_index(std::uint32_t id) {
  const auto keys = configuration_keys();
  const auto found = std::ranges::lower_bound(keys, id, {}, &ConfigurationKey::id);
  return found != keys.end() && found->id == id ? static_cast<std::size_t>(found - keys.begin())
                                                : keys.size();
}

std::size_t key_index(std::string_view name) {
  const auto keys = configuration_keys();
  return static_cast<std::size_t>(std::ranges::find(keys, name, &ConfigurationKey::name) -
                                  keys.begin());
}

std::span<const MessageRateKeys> message_rate_keys() {
  return kMessages;
}

}  // namespace rigwire::protocols::ubx
