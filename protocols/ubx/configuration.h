// Configuration (class 0x06) and its acknowledgement (class 0x05), in wire units. A poll is a frame
// of the same class and id with an empty payload, or with the selector that the comment names.
//
// Sources: u-blox M8 receiver description, UBX-13003221 R28, sections 32.8 "UBX-ACK" and 32.10
// "UBX-CFG"; lengths and defaults checked against a complete poll of a NEO-7P. CFG-VALSET, VALGET
// and VALDEL: key_values.h.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <tuple>

#include "protocols/ubx/layout.h"

namespace rigwire::protocols::ubx {

/// ACK-ACK: the request `message_class`, `message_id` was carried out.
struct AckAck {
  static constexpr MessageId kId{0x05, 0x01};
  static constexpr std::size_t kLength = 2 /*id of the request*/;

  std::uint8_t message_class = 0;
  std::uint8_t message_id = 0;

  static constexpr auto fields(auto& m) { return std::tie(m.message_class, m.message_id); }
};

/// ACK-NAK: it was refused.
struct AckNak {
  static constexpr MessageId kId{0x05, 0x00};
  static constexpr std::size_t kLength = 2 /*id of the request*/;

  std::uint8_t message_class = 0;
  std::uint8_t message_id = 0;

  static constexpr auto fields(auto& m) { return std::tie(m.message_class, m.message_id); }
};

/// Ports of CFG-PRT and columns of CFG-MSG and CFG-INF.
inline constexpr std::size_t kPortDdc = 0;
inline constexpr std::size_t kPortUart1 = 1;
inline constexpr std::size_t kPortUart2 = 2;
inline constexpr std::size_t kPortUsb = 3;
inline constexpr std::size_t kPortSpi = 4;
inline constexpr std::size_t kPorts = 6;  ///< Columns; the last one is reserved.
/// Protocol masks of CFG-PRT.
inline constexpr std::uint16_t kProtocolUbx = 0x0001;
inline constexpr std::uint16_t kProtocolNmea = 0x0002;
inline constexpr std::uint16_t kProtocolRtcm2 = 0x0004;
inline constexpr std::uint16_t kProtocolRtcm3 = 0x0020;

/// CFG-PRT: one port. Selector: port. A set may carry several blocks.
struct CfgPrt {
  static constexpr MessageId kId{0x06, 0x00};
  static constexpr std::size_t kLength = 1 /*port*/ + 1 /*reserved*/ + 2 /*ready pin*/ +
                                         8 /*mode, speed*/ + 4 /*protocols*/ +
                                         4 /*flags, reserved*/;

  std::uint8_t port = 0;
  std::uint16_t ready_pin = 0;
  std::uint32_t mode = 0;  ///< UART: b6-7 length, b9-11 parity, b12-13 stop bits; 0x08C0 = 8N1.
  std::uint32_t baud = 0;
  std::uint16_t input_protocols = 0;
  std::uint16_t output_protocols = 0;
  std::uint16_t flags = 0;

  static constexpr auto fields(auto& m) {
    return std::tie(m.port, gap<1>, m.ready_pin, m.mode, m.baud, m.input_protocols,
                    m.output_protocols, m.flags, gap<2>);
  }
};

/// CFG-MSG, all ports. Selector: class, id. A set of three bytes names the rate of the present
/// port.
struct CfgMsg {
  static constexpr MessageId kId{0x06, 0x01};
  static constexpr std::size_t kLength = 2 /*id*/ + 6 /*rates*/;

  std::uint8_t message_class = 0;
  std::uint8_t message_id = 0;
  std::array<std::uint8_t, 6> rates{};  ///< Every n-th epoch, by port; 0 = off.

  static constexpr auto fields(auto& m) { return std::tie(m.message_class, m.message_id, m.rates); }
};

/// CFG-INF: one protocol. Selector: protocol. A set may carry several blocks.
struct CfgInf {
  static constexpr MessageId kId{0x06, 0x02};
  static constexpr std::size_t kLength = 4 /*protocol*/ + 6 /*masks*/;

  std::uint8_t protocol = 0;  ///< 0 UBX, 1 NMEA.
  std::array<std::uint8_t, 6>
      masks{};  ///< By port: b0 error, b1 warning, b2 notice, b3 test, b4 debug.

  static constexpr auto fields(auto& m) { return std::tie(m.protocol, gap<3>, m.masks); }
};

/// CfgNmea::flags.
inline constexpr std::uint8_t kNmeaCompatible = 0x01;  ///< Four decimals of minutes.
inline constexpr std::uint8_t kNmeaConsider = 0x02;
inline constexpr std::uint8_t kNmeaLimit82 = 0x04;
inline constexpr std::uint8_t kNmeaHighPrecision = 0x08;

/// CFG-NMEA in the 12-byte form of u-blox 7; the 20-byte form of u-blox 8 and later goes on with
/// the talker of BeiDou, two letters (zeros = "GB"), and six reserved bytes.
struct CfgNmea {
  static constexpr MessageId kId{0x06, 0x17};
  static constexpr std::size_t kLength =
      4 /*filter, version, satellites, flags*/ + 4 /*systems*/ + 4 /*numbering, talkers, version*/;

  /// b0 failed, b1 invalid positions, b2 times, b3 dates, b4 GPS only, b5 frozen course.
  std::uint8_t filter = 0;
  /// 0x21 = 2.1, 0x23 = 2.3; the longer form also 0x40, 0x41, 0x4B = 4.11.
  std::uint8_t version = 0;
  std::uint8_t maximum_satellites = 0;  ///< By talker; 0 = no limit.
  std::uint8_t flags = 0;               ///< kNmeaCompatible, ...
  /// b0 GPS, b1 SBAS, b2 Galileo, b4 QZSS, b5 GLONASS, b6 BeiDou.
  std::uint32_t systems_to_filter = 0;
  std::uint8_t satellite_numbering = 0;  ///< 0 strict, 1 extended.
  std::uint8_t main_talker = 0;          ///< 0 by systems, 1 GP, 2 GL, 3 GN, 4 GA, 5 GB, 6 GQ.
  std::uint8_t gsv_talker = 0;           ///< 0 by system, 1 the main talker.
  std::uint8_t message_version = 0;      ///< 0; 1 in the 20-byte form.

  static constexpr auto fields(auto& m) {
    return std::tie(m.filter, m.version, m.maximum_satellites, m.flags, m.systems_to_filter,
                    m.satellite_numbering, m.main_talker, m.gsv_talker, m.message_version);
  }
};

/// CFG-USB.
struct CfgUsb {
  static constexpr MessageId kId{0x06, 0x1B};
  static constexpr std::size_t kLength = 8 /*ids*/ + 4 /*power, flags*/ + 3 * 32 /*texts*/;

  std::uint16_t vendor_id = 0;
  std::uint16_t product_id = 0;
  std::uint16_t reserved = 1;
  std::uint16_t power_consumption_ma = 0;
  std::uint16_t flags = 0;                ///< b0 enumerate again, b1 self-powered.
  std::array<std::uint8_t, 32> vendor{};  ///< Texts, padded with zeros.
  std::array<std::uint8_t, 32> product{};
  std::array<std::uint8_t, 32> serial_number{};

  static constexpr auto fields(auto& m) {
    return std::tie(m.vendor_id, m.product_id, gap<2>, m.reserved, m.power_consumption_ma, m.flags,
                    m.vendor, m.product, m.serial_number);
  }
};

/// CFG-RATE.
struct CfgRate {
  static constexpr MessageId kId{0x06, 0x08};
  static constexpr std::size_t kLength = 3 * 2 /*fields*/;

  std::uint16_t measurement_period_ms = 0;
  std::uint16_t navigation_ratio = 0;
  std::uint16_t time_reference = 0;  ///< 0 UTC, 1 GPS.

  static constexpr auto fields(auto& m) {
    return std::tie(m.measurement_period_ms, m.navigation_ratio, m.time_reference);
  }
};

/// CFG-NAV5.
struct CfgNav5 {
  static constexpr MessageId kId{0x06, 0x24};
  static constexpr std::size_t kLength = 36 /*with reserved bytes*/;

  std::uint16_t mask = 0;          ///< Fields that a set message applies.
  std::uint8_t dynamic_model = 0;  ///< 0 portable, 4 automotive, ...
  std::uint8_t fix_mode = 0;       ///< 1 2D only, 2 3D only, 3 automatic.
  std::int32_t fixed_altitude_cm = 0;
  std::uint32_t fixed_altitude_variance_e4m2 = 0;
  std::int8_t minimum_elevation_deg = 0;
  std::uint8_t dead_reckoning_limit_s = 0;
  std::uint16_t position_dilution_mask_e1 = 0;
  std::uint16_t time_dilution_mask_e1 = 0;
  std::uint16_t position_accuracy_mask_m = 0;
  std::uint16_t time_accuracy_mask_m = 0;
  std::uint8_t static_hold_cmps = 0;
  std::uint8_t differential_timeout_s = 0;
  std::uint8_t cn0_satellites = 0;
  std::uint8_t cn0_threshold_dbhz = 0;
  std::uint16_t static_hold_distance_m = 0;
  std::uint8_t utc_standard = 0;

  static constexpr auto fields(auto& m) {
    return std::tie(m.mask, m.dynamic_model, m.fix_mode, m.fixed_altitude_cm,
                    m.fixed_altitude_variance_e4m2, m.minimum_elevation_deg,
                    m.dead_reckoning_limit_s, m.position_dilution_mask_e1, m.time_dilution_mask_e1,
                    m.position_accuracy_mask_m, m.time_accuracy_mask_m, m.static_hold_cmps,
                    m.differential_timeout_s, m.cn0_satellites, m.cn0_threshold_dbhz, gap<2>,
                    m.static_hold_distance_m, m.utc_standard, gap<5>);
  }
};

/// CFG-NAVX5: the fields that protocols 14 and 18 document, but for dead reckoning.
struct CfgNavx5 {
  static constexpr MessageId kId{0x06, 0x23};
  static constexpr std::size_t kLength = 40 /*with reserved bytes*/;

  std::uint16_t version = 0;
  std::uint16_t mask1 = 0;
  std::uint32_t mask2 = 0;
  std::uint8_t minimum_satellites = 0;
  std::uint8_t maximum_satellites = 0;
  std::uint8_t minimum_cn0_dbhz = 0;
  std::uint8_t initial_fix_3d = 0;
  std::uint8_t acknowledge_aiding = 0;
  std::uint16_t week_rollover = 0;
  std::uint8_t attenuation_compensation = 0;  ///< u-blox 8: 0 off, 255 automatic, else dBHz.
  std::uint8_t precise_point_positioning = 0;
  std::uint8_t autonomous_orbits = 0;
  std::uint16_t maximum_orbit_error_m = 0;
  // Not zero as delivered.
  std::array<std::uint8_t, 2> reserved1{};
  std::uint8_t reserved2 = 0;
  std::array<std::uint8_t, 2> reserved3{};
  std::array<std::uint8_t, 5> reserved4{};
  std::array<std::uint8_t, 2> reserved5{};
  std::array<std::uint8_t, 8> reserved6{};

  static constexpr auto fields(auto& m) {
    return std::tie(m.version, m.mask1, m.mask2, m.reserved1, m.minimum_satellites,
                    m.maximum_satellites, m.minimum_cn0_dbhz, m.reserved2, m.initial_fix_3d,
                    m.reserved3, m.acknowledge_aiding, m.week_rollover, m.attenuation_compensation,
                    m.reserved4, m.precise_point_positioning, m.autonomous_orbits, m.reserved5,
                    m.maximum_orbit_error_m, m.reserved6);
  }
};

/// CfgOdo::flags.
inline constexpr std::uint8_t kOdoUse = 0x01;
inline constexpr std::uint8_t kOdoLowSpeedCourse = 0x02;
inline constexpr std::uint8_t kOdoFilteredSpeed = 0x04;
inline constexpr std::uint8_t kOdoFilteredCourse = 0x08;

/// CFG-ODO: odometer and low-pass filters of speed and course. u-blox 8 and later.
struct CfgOdo {
  static constexpr MessageId kId{0x06, 0x1E};
  static constexpr std::size_t kLength =
      4 /*version*/ + 8 /*flags, profile, reserved*/ + 4 /*low speed*/ + 4 /*gains*/;

  std::uint8_t version = 0;
  std::uint8_t flags = 0;                  ///< kOdoUse, ...
  std::uint8_t profile = 0;                ///< 0 running, 1 cycling, 2 swimming, 3 car, 4 custom.
  std::array<std::uint8_t, 6> reserved{};  ///< Not zero as delivered.
  std::uint8_t course_speed_dmps = 0;      ///< Max speed for the low-speed course filter.
  std::uint8_t course_accuracy_m = 0;      ///< Max position accuracy for the course filter.
  std::uint8_t speed_gain = 0;             ///< 0 heavy .. 255 weak filtering.
  std::uint8_t course_gain = 0;            ///< Course filter: 0 heavy .. 255 weak.

  static constexpr auto fields(auto& m) {
    return std::tie(m.version, gap<3>, m.flags, m.profile, m.reserved, m.course_speed_dmps,
                    m.course_accuracy_m, gap<2>, m.speed_gain, m.course_gain, gap<2>);
  }
};

/// CFG-SBAS.
struct CfgSbas {
  static constexpr MessageId kId{0x06, 0x16};
  static constexpr std::size_t kLength = 4 /*use*/ + 4 /*satellites*/;

  std::uint8_t mode = 0;
  std::uint8_t usage = 0;
  std::uint8_t maximum_satellites = 0;
  std::uint8_t scan_mode2 = 0;
  std::uint32_t scan_mode1 = 0;

  static constexpr auto fields(auto& m) {
    return std::tie(m.mode, m.usage, m.maximum_satellites, m.scan_mode2, m.scan_mode1);
  }
};

/// CfgTmode3::flags: the mode in b0-7, and whether the position is geodetic.
inline constexpr std::uint16_t kTmodeGeodetic = 0x0100;
inline constexpr std::uint8_t kTmodeSurvey = 1;
inline constexpr std::uint8_t kTmodeFixed = 2;

/// CFG-TMODE3: the receiver as a base station. F9.
struct CfgTmode3 {
  static constexpr MessageId kId{0x06, 0x71};
  static constexpr std::size_t kLength = 4 /*version, flags*/ + 12 /*position*/ + 4 /*its rest*/ +
                                         12 /*accuracy, survey*/ + 8 /*reserved*/;

  std::uint8_t version = 0;
  std::uint16_t flags = 0;
  std::array<std::int32_t, 3> position{};      ///< cm, or 1e-7 deg twice and cm.
  std::array<std::int8_t, 3> position_rest{};  ///< -99..99: 0.1 mm, or 1e-9 deg twice and 0.1 mm.
  std::uint32_t accuracy_e4m = 0;              ///< Accuracy of the fixed position.
  std::uint32_t survey_least_duration_s = 0;
  std::uint32_t survey_accuracy_limit_e4m = 0;

  [[nodiscard]] constexpr std::uint8_t mode() const {
    return static_cast<std::uint8_t>(flags & 0xFFU);
  }
  friend bool operator==(const CfgTmode3&, const CfgTmode3&) = default;

  static constexpr auto fields(auto& m) {
    return std::tie(m.version, gap<1>, m.flags, m.position, m.position_rest, gap<1>, m.accuracy_e4m,
                    m.survey_least_duration_s, m.survey_accuracy_limit_e4m, gap<8>);
  }
};

/// CFG-GNSS: the head, followed by `blocks` blocks.
struct CfgGnssHead {
  static constexpr MessageId kId{0x06, 0x3E};
  static constexpr std::size_t kLength = 4 /*fields*/;

  std::uint8_t version = 0;
  std::uint8_t hardware_channels = 0;
  std::uint8_t used_channels = 0;
  std::uint8_t blocks = 0;

  static constexpr auto fields(auto& m) {
    return std::tie(m.version, m.hardware_channels, m.used_channels, m.blocks);
  }
  [[nodiscard]] constexpr std::size_t block_count() const { return blocks; }
};

/// CFG-GNSS: one system.
struct CfgGnssBlock {
  static constexpr std::size_t kLength = 4 /*channels*/ + 4 /*flags*/;

  std::uint8_t system = 0;  ///< 0 GPS, 1 SBAS, 5 QZSS, 6 GLONASS.
  std::uint8_t reserved_channels = 0;
  std::uint8_t maximum_channels = 0;
  std::uint32_t flags = 0;  ///< b0 enabled.

  static constexpr auto fields(auto& m) {
    return std::tie(m.system, m.reserved_channels, m.maximum_channels, gap<1>, m.flags);
  }
};

/// CFG-DAT as it is answered: the datum with its number and name.
struct CfgDat {
  static constexpr MessageId kId{0x06, 0x06};
  static constexpr std::size_t kLength =
      2 /*number*/ + 6 /*name*/ + 2 * 8 /*ellipsoid*/ + 7 * 4 /*shift, rotation, scale*/;

  std::uint16_t number = 0;            ///< 0 WGS-84, 0xFFFF set by the user.
  std::array<std::uint8_t, 6> name{};  ///< Text, padded with zeros.
  double major_axis_m = 0.0;
  double inverse_flattening = 0.0;
  std::array<float, 3> shift_m{};
  std::array<float, 3> rotation_arcsec{};
  float scale_ppm = 0.0F;

  static constexpr auto fields(auto& m) {
    return std::tie(m.number, m.name, m.major_axis_m, m.inverse_flattening, m.shift_m,
                    m.rotation_arcsec, m.scale_ppm);
  }
};

/// CFG-RST.
struct CfgRst {
  static constexpr MessageId kId{0x06, 0x04};
  static constexpr std::size_t kLength = 2 /*what to clear*/ + 2 /*mode*/;

  std::uint16_t clear_mask = 0;  ///< 0 hot, 1 warm, 0xFFFF cold.
  std::uint8_t mode = 0;         ///< 0, 1, 4 reset; 2 GNSS only; 8 stop, 9 start GNSS.

  static constexpr auto fields(auto& m) { return std::tie(m.clear_mask, m.mode, gap<1>); }
};

/// CFG-CFG without the optional device mask.
struct CfgCfg {
  static constexpr MessageId kId{0x06, 0x09};
  static constexpr std::size_t kLength = 3 * 4 /*masks*/;

  std::uint32_t clear_mask = 0;
  std::uint32_t save_mask = 0;
  std::uint32_t load_mask = 0;

  static constexpr auto fields(auto& m) { return std::tie(m.clear_mask, m.save_mask, m.load_mask); }
};

/// CFG-RXM.
struct CfgRxm {
  static constexpr MessageId kId{0x06, 0x11};
  static constexpr std::size_t kLength = 2 /*fields*/;

  std::uint8_t reserved = 8;
  std::uint8_t low_power_mode = 0;

  static constexpr auto fields(auto& m) { return std::tie(m.reserved, m.low_power_mode); }
};

/// CFG-ANT.
struct CfgAnt {
  static constexpr MessageId kId{0x06, 0x13};
  static constexpr std::size_t kLength = 2 * 2 /*fields*/;

  std::uint16_t flags = 0;
  std::uint16_t pins = 0;

  static constexpr auto fields(auto& m) { return std::tie(m.flags, m.pins); }
};

/// CFG-TP5: one time pulse. Selector: index.
struct CfgTp5 {
  static constexpr MessageId kId{0x06, 0x31};
  static constexpr std::size_t kLength =
      4 /*index*/ + 4 /*delays*/ + 16 /*periods, pulses*/ + 8 /*delay, flags*/;

  std::uint8_t index = 0;
  std::uint8_t version = 0;
  std::int16_t cable_delay_ns = 0;
  std::int16_t group_delay_ns = 0;
  std::uint32_t period = 0;  ///< us, or Hz by the flags.
  std::uint32_t period_locked = 0;
  std::uint32_t pulse = 0;  ///< us, or 2^-32 by the flags.
  std::uint32_t pulse_locked = 0;
  std::int32_t user_delay_ns = 0;
  std::uint32_t flags = 0;

  static constexpr auto fields(auto& m) {
    return std::tie(m.index, m.version, gap<2>, m.cable_delay_ns, m.group_delay_ns, m.period,
                    m.period_locked, m.pulse, m.pulse_locked, m.user_delay_ns, m.flags);
  }
};

/// CFG-PM2 in the 44-byte form: power save mode.
struct CfgPm2 {
  static constexpr MessageId kId{0x06, 0x3B};
  static constexpr std::size_t kLength =
      4 /*version*/ + 4 /*flags*/ + 12 /*periods*/ + 4 /*times*/ + 20 /*reserved*/;

  std::uint8_t version = 1;
  std::uint8_t maximum_start_s = 0;
  std::uint32_t flags = 0;
  std::uint32_t update_period_ms = 0;
  std::uint32_t search_period_ms = 0;
  std::uint32_t grid_offset_ms = 0;
  std::uint16_t on_time_s = 0;
  std::uint16_t minimum_acquisition_s = 0;
  std::array<std::uint8_t, 20> reserved{};  ///< Not zero as delivered.

  static constexpr auto fields(auto& m) {
    return std::tie(m.version, gap<1>, m.maximum_start_s, gap<1>, m.flags, m.update_period_ms,
                    m.search_period_ms, m.grid_offset_ms, m.on_time_s, m.minimum_acquisition_s,
                    m.reserved);
  }
};

/// CFG-PMS: one of the predefined power modes. u-blox 8.
struct CfgPms {
  static constexpr MessageId kId{0x06, 0x86};
  static constexpr std::size_t kLength = 2 /*version, mode*/ + 2 * 2 /*interval*/ + 2 /*reserved*/;

  std::uint8_t version = 0;
  std::uint8_t mode = 0;  ///< 0 full power, 1 balanced, 2 interval, 3..5 aggressive.
  std::uint16_t period_s = 0;
  std::uint16_t on_time_s = 0;

  static constexpr auto fields(auto& m) {
    return std::tie(m.version, m.mode, m.period_s, m.on_time_s, gap<2>);
  }
};

}  // namespace rigwire::protocols::ubx
