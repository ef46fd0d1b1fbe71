// Monitor (0x0A), configuration (0x06) and acknowledge (0x05) messages of protocol 14, in wire
// units.
//
// Source: u-blox M8 receiver description, UBX-13003221 R28, sections 32.10 "UBX-CFG", 32.16
// "UBX-MON", 32.9 "UBX-ACK"; lengths and defaults checked against a complete poll of a NEO-7P. A
// poll is a frame of the same class and id with an empty payload, or with the selector that the
// comment names.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <tuple>

#include "protocols/ubx/layout.h"

namespace rigwire::protocols::ubx {

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

/// MON-VER: the head, followed by extensions of 30 characters each.
struct MonVerHead {
  static constexpr MessageId kId{0x0A, 0x04};
  static constexpr std::size_t kLength = 30 /*software*/ + 10 /*hardware*/;

  std::array<std::uint8_t, 30> software{};  ///< Text, padded with zeros.
  std::array<std::uint8_t, 10> hardware{};

  static constexpr auto fields() {
    return std::make_tuple(at(0, &MonVerHead::software), at(30, &MonVerHead::hardware));
  }
  friend bool operator==(const MonVerHead&, const MonVerHead&) = default;
};

/// MON-VER: one extension.
struct MonVerExtension {
  static constexpr std::size_t kLength = 30 /*text*/;

  std::array<std::uint8_t, 30> text{};

  static constexpr auto fields() { return std::make_tuple(at(0, &MonVerExtension::text)); }
  friend bool operator==(const MonVerExtension&, const MonVerExtension&) = default;
};

/// MON-HW in the 60-byte form of u-blox 7.
struct MonHw {
  static constexpr MessageId kId{0x0A, 0x09};
  static constexpr std::size_t kLength = 16 /*pins*/ + 8 /*noise, antenna, flags*/ +
                                         4 /*used pins*/ + 20 /*functions, jamming*/ +
                                         12 /*interrupt, pull*/;

  std::uint32_t pin_select = 0;
  std::uint32_t pin_bank = 0;
  std::uint32_t pin_direction = 0;
  std::uint32_t pin_value = 0;
  std::uint16_t noise_per_ms = 0;
  std::uint16_t gain_control = 0;   ///< 0..8191.
  std::uint8_t antenna_status = 0;  ///< 2 = good.
  std::uint8_t antenna_power = 0;   ///< 1 = on.
  std::uint8_t flags = 0;           ///< b0 real-time clock calibrated.
  std::uint32_t used_mask = 0;
  std::array<std::uint8_t, 17> pin_function{};
  std::uint8_t jamming_indicator = 0;
  std::uint32_t pin_interrupt = 0;
  std::uint32_t pull_high = 0;
  std::uint32_t pull_low = 0;

  static constexpr auto fields() {
    return std::make_tuple(
        at(0, &MonHw::pin_select), at(4, &MonHw::pin_bank), at(8, &MonHw::pin_direction),
        at(12, &MonHw::pin_value), at(16, &MonHw::noise_per_ms), at(18, &MonHw::gain_control),
        at(20, &MonHw::antenna_status), at(21, &MonHw::antenna_power), at(22, &MonHw::flags),
        at(24, &MonHw::used_mask), at(28, &MonHw::pin_function), at(45, &MonHw::jamming_indicator),
        at(48, &MonHw::pin_interrupt), at(52, &MonHw::pull_high), at(56, &MonHw::pull_low));
  }
  friend bool operator==(const MonHw&, const MonHw&) = default;
};

/// ACK-ACK: the request `message_class`, `message_id` was carried out.
struct AckAck {
  static constexpr MessageId kId{0x05, 0x01};
  static constexpr std::size_t kLength = 2 /*id of the request*/;

  std::uint8_t message_class = 0;
  std::uint8_t message_id = 0;

  static constexpr auto fields() {
    return std::make_tuple(at(0, &AckAck::message_class), at(1, &AckAck::message_id));
  }
  friend bool operator==(const AckAck&, const AckAck&) = default;
};

/// ACK-NAK: it was refused.
struct AckNak {
  static constexpr MessageId kId{0x05, 0x00};
  static constexpr std::size_t kLength = 2 /*id of the request*/;

  std::uint8_t message_class = 0;
  std::uint8_t message_id = 0;

  static constexpr auto fields() {
    return std::make_tuple(at(0, &AckNak::message_class), at(1, &AckNak::message_id));
  }
  friend bool operator==(const AckNak&, const AckNak&) = default;
};

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

  static constexpr auto fields() {
    return std::make_tuple(at(0, &CfgPrt::port), at(2, &CfgPrt::ready_pin), at(4, &CfgPrt::mode),
                           at(8, &CfgPrt::baud), at(12, &CfgPrt::input_protocols),
                           at(14, &CfgPrt::output_protocols), at(16, &CfgPrt::flags));
  }
  friend bool operator==(const CfgPrt&, const CfgPrt&) = default;
};

/// CFG-MSG, all ports. Selector: class, id. A set of three bytes names the rate of the present
/// port.
struct CfgMsg {
  static constexpr MessageId kId{0x06, 0x01};
  static constexpr std::size_t kLength = 2 /*id*/ + 6 /*rates*/;

  std::uint8_t message_class = 0;
  std::uint8_t message_id = 0;
  std::array<std::uint8_t, 6> rates{};  ///< Every n-th epoch, by port; 0 = off.

  static constexpr auto fields() {
    return std::make_tuple(at(0, &CfgMsg::message_class), at(1, &CfgMsg::message_id),
                           at(2, &CfgMsg::rates));
  }
  friend bool operator==(const CfgMsg&, const CfgMsg&) = default;
};

/// CFG-INF: one protocol. Selector: protocol. A set may carry several blocks.
struct CfgInf {
  static constexpr MessageId kId{0x06, 0x02};
  static constexpr std::size_t kLength = 4 /*protocol*/ + 6 /*masks*/;

  std::uint8_t protocol = 0;  ///< 0 UBX, 1 NMEA.
  std::array<std::uint8_t, 6>
      masks{};  ///< By port: b0 error, b1 warning, b2 notice, b3 test, b4 debug.

  static constexpr auto fields() {
    return std::make_tuple(at(0, &CfgInf::protocol), at(4, &CfgInf::masks));
  }
  friend bool operator==(const CfgInf&, const CfgInf&) = default;
};

/// CFG-RST.
struct CfgRst {
  static constexpr MessageId kId{0x06, 0x04};
  static constexpr std::size_t kLength = 2 /*what to clear*/ + 2 /*mode*/;

  std::uint16_t clear_mask = 0;  ///< 0 hot, 1 warm, 0xFFFF cold.
  std::uint8_t mode = 0;         ///< 0, 1, 4 reset; 2 GNSS only; 8 stop, 9 start GNSS.

  static constexpr auto fields() {
    return std::make_tuple(at(0, &CfgRst::clear_mask), at(2, &CfgRst::mode));
  }
  friend bool operator==(const CfgRst&, const CfgRst&) = default;
};

/// CFG-RATE.
struct CfgRate {
  static constexpr MessageId kId{0x06, 0x08};
  static constexpr std::size_t kLength = 3 * 2 /*fields*/;

  std::uint16_t measurement_period_ms = 0;
  std::uint16_t navigation_ratio = 0;
  std::uint16_t time_reference = 0;  ///< 0 UTC, 1 GPS.

  static constexpr auto fields() {
    return std::make_tuple(at(0, &CfgRate::measurement_period_ms),
                           at(2, &CfgRate::navigation_ratio), at(4, &CfgRate::time_reference));
  }
  friend bool operator==(const CfgRate&, const CfgRate&) = default;
};

/// CFG-CFG without the optional device mask.
struct CfgCfg {
  static constexpr MessageId kId{0x06, 0x09};
  static constexpr std::size_t kLength = 3 * 4 /*masks*/;

  std::uint32_t clear_mask = 0;
  std::uint32_t save_mask = 0;
  std::uint32_t load_mask = 0;

  static constexpr auto fields() {
    return std::make_tuple(at(0, &CfgCfg::clear_mask), at(4, &CfgCfg::save_mask),
                           at(8, &CfgCfg::load_mask));
  }
  friend bool operator==(const CfgCfg&, const CfgCfg&) = default;
};

/// CFG-RXM.
struct CfgRxm {
  static constexpr MessageId kId{0x06, 0x11};
  static constexpr std::size_t kLength = 2 /*fields*/;

  std::uint8_t reserved = 8;
  std::uint8_t low_power_mode = 0;

  static constexpr auto fields() {
    return std::make_tuple(at(0, &CfgRxm::reserved), at(1, &CfgRxm::low_power_mode));
  }
  friend bool operator==(const CfgRxm&, const CfgRxm&) = default;
};

/// CFG-ANT.
struct CfgAnt {
  static constexpr MessageId kId{0x06, 0x13};
  static constexpr std::size_t kLength = 2 * 2 /*fields*/;

  std::uint16_t flags = 0;
  std::uint16_t pins = 0;

  static constexpr auto fields() {
    return std::make_tuple(at(0, &CfgAnt::flags), at(2, &CfgAnt::pins));
  }
  friend bool operator==(const CfgAnt&, const CfgAnt&) = default;
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

  static constexpr auto fields() {
    return std::make_tuple(at(0, &CfgSbas::mode), at(1, &CfgSbas::usage),
                           at(2, &CfgSbas::maximum_satellites), at(3, &CfgSbas::scan_mode2),
                           at(4, &CfgSbas::scan_mode1));
  }
  friend bool operator==(const CfgSbas&, const CfgSbas&) = default;
};

/// CFG-NMEA in the 12-byte form of u-blox 7.
struct CfgNmea {
  static constexpr MessageId kId{0x06, 0x17};
  static constexpr std::size_t kLength =
      4 /*filter, version, satellites, flags*/ + 4 /*systems*/ + 4 /*numbering, talkers, reserved*/;

  std::uint8_t filter = 0;
  std::uint8_t version = 0;  ///< 0x21 = 2.1, 0x23 = 2.3.
  std::uint8_t maximum_satellites = 0;
  std::uint8_t flags = 0;
  std::uint32_t systems_to_filter = 0;
  std::uint8_t satellite_numbering = 0;
  std::uint8_t main_talker = 0;
  std::uint8_t gsv_talker = 0;

  static constexpr auto fields() {
    return std::make_tuple(at(0, &CfgNmea::filter), at(1, &CfgNmea::version),
                           at(2, &CfgNmea::maximum_satellites), at(3, &CfgNmea::flags),
                           at(4, &CfgNmea::systems_to_filter), at(8, &CfgNmea::satellite_numbering),
                           at(9, &CfgNmea::main_talker), at(10, &CfgNmea::gsv_talker));
  }
  friend bool operator==(const CfgNmea&, const CfgNmea&) = default;
};

/// CFG-NAVX5: the fields that protocol 14 documents.
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
  std::uint8_t precise_point_positioning = 0;
  std::uint8_t autonomous_orbits = 0;
  std::uint16_t maximum_orbit_error_m = 0;

  static constexpr auto fields() {
    return std::make_tuple(
        at(0, &CfgNavx5::version), at(2, &CfgNavx5::mask1), at(4, &CfgNavx5::mask2),
        at(10, &CfgNavx5::minimum_satellites), at(11, &CfgNavx5::maximum_satellites),
        at(12, &CfgNavx5::minimum_cn0_dbhz), at(14, &CfgNavx5::initial_fix_3d),
        at(17, &CfgNavx5::acknowledge_aiding), at(18, &CfgNavx5::week_rollover),
        at(26, &CfgNavx5::precise_point_positioning), at(27, &CfgNavx5::autonomous_orbits),
        at(30, &CfgNavx5::maximum_orbit_error_m));
  }
  friend bool operator==(const CfgNavx5&, const CfgNavx5&) = default;
};

/// CFG-NAV5.
struct CfgNav5 {
  static constexpr MessageId kId{0x06, 0x24};
  static constexpr std::size_t kLength = 36 /*with reserved bytes*/;

  std::uint16_t mask = 0;          ///< Which fields a set applies.
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

  static constexpr auto fields() {
    return std::make_tuple(
        at(0, &CfgNav5::mask), at(2, &CfgNav5::dynamic_model), at(3, &CfgNav5::fix_mode),
        at(4, &CfgNav5::fixed_altitude_cm), at(8, &CfgNav5::fixed_altitude_variance_e4m2),
        at(12, &CfgNav5::minimum_elevation_deg), at(13, &CfgNav5::dead_reckoning_limit_s),
        at(14, &CfgNav5::position_dilution_mask_e1), at(16, &CfgNav5::time_dilution_mask_e1),
        at(18, &CfgNav5::position_accuracy_mask_m), at(20, &CfgNav5::time_accuracy_mask_m),
        at(22, &CfgNav5::static_hold_cmps), at(23, &CfgNav5::differential_timeout_s),
        at(24, &CfgNav5::cn0_satellites), at(25, &CfgNav5::cn0_threshold_dbhz),
        at(28, &CfgNav5::static_hold_distance_m), at(30, &CfgNav5::utc_standard));
  }
  friend bool operator==(const CfgNav5&, const CfgNav5&) = default;
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

  static constexpr auto fields() {
    return std::make_tuple(at(0, &CfgTp5::index), at(1, &CfgTp5::version),
                           at(4, &CfgTp5::cable_delay_ns), at(6, &CfgTp5::group_delay_ns),
                           at(8, &CfgTp5::period), at(12, &CfgTp5::period_locked),
                           at(16, &CfgTp5::pulse), at(20, &CfgTp5::pulse_locked),
                           at(24, &CfgTp5::user_delay_ns), at(28, &CfgTp5::flags));
  }
  friend bool operator==(const CfgTp5&, const CfgTp5&) = default;
};

/// CFG-GNSS: the head, followed by `blocks` blocks.
struct CfgGnssHead {
  static constexpr MessageId kId{0x06, 0x3E};
  static constexpr std::size_t kLength = 4 /*fields*/;

  std::uint8_t version = 0;
  std::uint8_t hardware_channels = 0;
  std::uint8_t used_channels = 0;
  std::uint8_t blocks = 0;

  static constexpr auto fields() {
    return std::make_tuple(at(0, &CfgGnssHead::version), at(1, &CfgGnssHead::hardware_channels),
                           at(2, &CfgGnssHead::used_channels), at(3, &CfgGnssHead::blocks));
  }
  friend bool operator==(const CfgGnssHead&, const CfgGnssHead&) = default;
};

/// CFG-GNSS: one system.
struct CfgGnssBlock {
  static constexpr std::size_t kLength = 4 /*channels*/ + 4 /*flags*/;

  std::uint8_t system = 0;  ///< 0 GPS, 1 SBAS, 5 QZSS, 6 GLONASS.
  std::uint8_t reserved_channels = 0;
  std::uint8_t maximum_channels = 0;
  std::uint32_t flags = 0;  ///< b0 enabled.

  static constexpr auto fields() {
    return std::make_tuple(at(0, &CfgGnssBlock::system), at(1, &CfgGnssBlock::reserved_channels),
                           at(2, &CfgGnssBlock::maximum_channels), at(4, &CfgGnssBlock::flags));
  }
  friend bool operator==(const CfgGnssBlock&, const CfgGnssBlock&) = default;
};

}  // namespace rigwire::protocols::ubx
