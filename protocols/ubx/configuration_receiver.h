// The receiver as a whole (configuration, class 0x06), in wire units: start, store, power, pulses,
// antenna, interference, logging.
//
// Source: u-blox M8 receiver description, UBX-13003221 R28, section 32.10 "UBX-CFG"; lengths and
// defaults checked against a complete poll of a NEO-7P. A poll is a frame of the same class and id
// with an empty payload, or with the selector that the comment names.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <tuple>

#include "protocols/ubx/layout.h"

namespace rigwire::protocols::ubx {

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

/// CFG-CFG with the optional device mask.
struct CfgCfgDevices : CfgCfg {
  static constexpr MessageId kId{0x06, 0x09};
  static constexpr std::size_t kLength = CfgCfg::kLength + 1 /*devices*/;

  std::uint8_t devices = 0;  ///< b0 battery-backed memory, b1 flash, b2 EEPROM, b4 SPI flash.

  static constexpr auto fields() {
    return std::tuple_cat(CfgCfg::fields(), std::make_tuple(at(12, &CfgCfgDevices::devices)));
  }
  friend bool operator==(const CfgCfgDevices&, const CfgCfgDevices&) = default;
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

  static constexpr auto fields() {
    return std::make_tuple(at(0, &CfgPm2::version), at(2, &CfgPm2::maximum_start_s),
                           at(4, &CfgPm2::flags), at(8, &CfgPm2::update_period_ms),
                           at(12, &CfgPm2::search_period_ms), at(16, &CfgPm2::grid_offset_ms),
                           at(20, &CfgPm2::on_time_s), at(22, &CfgPm2::minimum_acquisition_s),
                           at(24, &CfgPm2::reserved));
  }
  friend bool operator==(const CfgPm2&, const CfgPm2&) = default;
};

/// CFG-PMS: one of the predefined power modes. u-blox 8.
struct CfgPms {
  static constexpr MessageId kId{0x06, 0x86};
  static constexpr std::size_t kLength = 2 /*version, mode*/ + 2 * 2 /*interval*/ + 2 /*reserved*/;

  std::uint8_t version = 0;
  std::uint8_t mode = 0;  ///< 0 full power, 1 balanced, 2 interval, 3..5 aggressive.
  std::uint16_t period_s = 0;
  std::uint16_t on_time_s = 0;

  static constexpr auto fields() {
    return std::make_tuple(at(0, &CfgPms::version), at(1, &CfgPms::mode), at(2, &CfgPms::period_s),
                           at(4, &CfgPms::on_time_s));
  }
  friend bool operator==(const CfgPms&, const CfgPms&) = default;
};

/// CFG-ITFM: interference monitor.
struct CfgItfm {
  static constexpr MessageId kId{0x06, 0x39};
  static constexpr std::size_t kLength = 2 * 4 /*settings*/;

  /// b0-3 broadband, b4-8 continuous wave threshold in dB, b31 enabled.
  std::uint32_t settings = 0;
  std::uint32_t settings2 = 0;  ///< b12-13 antenna: 0 unknown, 1 passive, 2 active.

  static constexpr auto fields() {
    return std::make_tuple(at(0, &CfgItfm::settings), at(4, &CfgItfm::settings2));
  }
  friend bool operator==(const CfgItfm&, const CfgItfm&) = default;
};

/// CFG-LOGFILTER: data logger.
struct CfgLogfilter {
  static constexpr MessageId kId{0x06, 0x47};
  static constexpr std::size_t kLength =
      2 /*version, flags*/ + 2 * 2 /*times*/ + 2 /*speed*/ + 4 /*distance*/;

  std::uint8_t version = 1;
  std::uint8_t flags = 0;  ///< b0 recording, b2 all of the filter is to be set.
  std::uint16_t minimum_interval_s = 0;
  std::uint16_t time_threshold_s = 0;
  std::uint16_t speed_threshold_mps = 0;
  std::uint32_t distance_threshold_m = 0;

  static constexpr auto fields() {
    return std::make_tuple(
        at(0, &CfgLogfilter::version), at(1, &CfgLogfilter::flags),
        at(2, &CfgLogfilter::minimum_interval_s), at(4, &CfgLogfilter::time_threshold_s),
        at(6, &CfgLogfilter::speed_threshold_mps), at(8, &CfgLogfilter::distance_threshold_m));
  }
  friend bool operator==(const CfgLogfilter&, const CfgLogfilter&) = default;
};

/// CFG-RINV: the head of the remote inventory, followed by up to 30 bytes.
struct CfgRinvHead {
  static constexpr MessageId kId{0x06, 0x34};
  static constexpr std::size_t kLength = 1 /*flags*/;

  std::uint8_t flags = 0;  ///< b0 put out at start, b1 binary.

  static constexpr auto fields() { return std::make_tuple(at(0, &CfgRinvHead::flags)); }
  friend bool operator==(const CfgRinvHead&, const CfgRinvHead&) = default;
};

}  // namespace rigwire::protocols::ubx
