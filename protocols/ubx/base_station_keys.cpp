// Fixed position, RTCM, time pulse, geofences, log, odometer: rows of configuration_keys.h.
#include <array>

#include "protocols/ubx/configuration_key_rows.h"

namespace rigwire::protocols::ubx::detail {
namespace {

constexpr std::array kKeys{
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

}  // namespace

std::span<const ConfigurationKey> base_station_keys() {
  return kKeys;
}

}  // namespace rigwire::protocols::ubx::detail
