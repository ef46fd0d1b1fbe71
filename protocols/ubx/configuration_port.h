// Ports and what is put out on them (configuration, class 0x06), in wire units.
//
// Source: u-blox M8 receiver description, UBX-13003221 R28, section 32.10 "UBX-CFG": PRT, MSG, INF,
// NMEA, USB; lengths and defaults checked against a complete poll of a NEO-7P. A poll is a frame of
// the same class and id with an empty payload, or with the selector that the comment names.
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

/// CFG-MSG for the port that it arrives on.
struct CfgMsgRate {
  static constexpr MessageId kId{0x06, 0x01};
  static constexpr std::size_t kLength = 2 /*id*/ + 1 /*rate*/;

  std::uint8_t message_class = 0;
  std::uint8_t message_id = 0;
  std::uint8_t rate = 0;  ///< Every n-th epoch; 0 = off.

  static constexpr auto fields() {
    return std::make_tuple(at(0, &CfgMsgRate::message_class), at(1, &CfgMsgRate::message_id),
                           at(2, &CfgMsgRate::rate));
  }
  friend bool operator==(const CfgMsgRate&, const CfgMsgRate&) = default;
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

/// CfgNmea4::flags.
inline constexpr std::uint8_t kNmeaCompatible = 0x01;  ///< Four decimals of minutes.
inline constexpr std::uint8_t kNmeaConsider = 0x02;
inline constexpr std::uint8_t kNmeaLimit82 = 0x04;
inline constexpr std::uint8_t kNmeaHighPrecision = 0x08;

/// CFG-NMEA in its 4-byte form, of before u-blox 7.
struct CfgNmea4 {
  static constexpr MessageId kId{0x06, 0x17};
  static constexpr std::size_t kLength = 4 /*filter, version, satellites, flags*/;

  /// b0 failed, b1 invalid positions, b2 times, b3 dates, b4 GPS only, b5 frozen course.
  std::uint8_t filter = 0;
  /// 0x21 = 2.1, 0x23 = 2.3; longer forms also 0x40, 0x41, 0x4B = 4.11.
  std::uint8_t version = 0;
  std::uint8_t maximum_satellites = 0;  ///< By talker; 0 = no limit.
  std::uint8_t flags = 0;               ///< kNmeaCompatible, ...

  static constexpr auto fields() {
    return std::make_tuple(at(0, &CfgNmea4::filter), at(1, &CfgNmea4::version),
                           at(2, &CfgNmea4::maximum_satellites), at(3, &CfgNmea4::flags));
  }
  friend bool operator==(const CfgNmea4&, const CfgNmea4&) = default;
};

/// CFG-NMEA in the 12-byte form of u-blox 7.
struct CfgNmea : CfgNmea4 {
  static constexpr MessageId kId{0x06, 0x17};
  static constexpr std::size_t kLength =
      CfgNmea4::kLength + 4 /*systems*/ + 4 /*numbering, talkers, version*/;

  /// b0 GPS, b1 SBAS, b2 Galileo, b4 QZSS, b5 GLONASS, b6 BeiDou.
  std::uint32_t systems_to_filter = 0;
  std::uint8_t satellite_numbering = 0;  ///< 0 strict, 1 extended.
  std::uint8_t main_talker = 0;          ///< 0 by systems, 1 GP, 2 GL, 3 GN, 4 GA, 5 GB, 6 GQ.
  std::uint8_t gsv_talker = 0;           ///< 0 by system, 1 the main talker.
  std::uint8_t message_version = 0;      ///< 0; 1 in the 20-byte form.

  static constexpr auto fields() {
    return std::tuple_cat(
        CfgNmea4::fields(),
        std::make_tuple(at(4, &CfgNmea::systems_to_filter), at(8, &CfgNmea::satellite_numbering),
                        at(9, &CfgNmea::main_talker), at(10, &CfgNmea::gsv_talker),
                        at(11, &CfgNmea::message_version)));
  }
  friend bool operator==(const CfgNmea&, const CfgNmea&) = default;
};

/// CFG-NMEA in the 20-byte form of u-blox 8 and later.
struct CfgNmea20 : CfgNmea {
  static constexpr MessageId kId{0x06, 0x17};
  static constexpr std::size_t kLength = CfgNmea::kLength + 2 /*talker*/ + 6 /*reserved*/;

  std::array<std::uint8_t, 2> beidou_talker{};  ///< Two letters; zeros = "GB".

  static constexpr auto fields() {
    return std::tuple_cat(CfgNmea::fields(), std::make_tuple(at(12, &CfgNmea20::beidou_talker)));
  }
  friend bool operator==(const CfgNmea20&, const CfgNmea20&) = default;
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

  static constexpr auto fields() {
    return std::make_tuple(at(0, &CfgUsb::vendor_id), at(2, &CfgUsb::product_id),
                           at(6, &CfgUsb::reserved), at(8, &CfgUsb::power_consumption_ma),
                           at(10, &CfgUsb::flags), at(12, &CfgUsb::vendor),
                           at(44, &CfgUsb::product), at(76, &CfgUsb::serial_number));
  }
  friend bool operator==(const CfgUsb&, const CfgUsb&) = default;
};

}  // namespace rigwire::protocols::ubx
