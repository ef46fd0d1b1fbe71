// Heads of the key-value configuration, CFG-VALSET, CFG-VALGET, CFG-VALDEL (class 0x06): protocol
// 23.01 and later. What follows them are keys, or keys with values (key_values.h).
//
// Source: ZED-F9P interface description HPG 1.50, UBXDOC-963802114-12815, sections 3.10.23
// to 3.10.25.
#pragma once

#include <cstddef>
#include <cstdint>
#include <tuple>

#include "protocols/ubx/layout.h"

namespace rigwire::protocols::ubx {

/// Layers as CFG-VALSET and CFG-VALDEL mask them.
inline constexpr std::uint8_t kLayerMaskRam = 0x01;
inline constexpr std::uint8_t kLayerMaskBattery = 0x02;
inline constexpr std::uint8_t kLayerMaskFlash = 0x04;
/// Layers as CFG-VALGET numbers them.
inline constexpr std::uint8_t kLayerRam = 0;
inline constexpr std::uint8_t kLayerBattery = 1;
inline constexpr std::uint8_t kLayerFlash = 2;
inline constexpr std::uint8_t kLayerDefault = 7;
/// Steps of a transaction, of version 1 of CFG-VALSET and CFG-VALDEL.
inline constexpr std::uint8_t kTransactionNone = 0;
inline constexpr std::uint8_t kTransactionStart = 1;
inline constexpr std::uint8_t kTransactionGoOn = 2;
inline constexpr std::uint8_t kTransactionApply = 3;
/// Most items of one message.
inline constexpr std::size_t kMaximumConfigurationItems = 64;

/// CFG-VALSET: followed by keys with their values.
struct CfgValsetHead {
  static constexpr MessageId kId{0x06, 0x8A};
  static constexpr std::size_t kLength = 4 /*fields*/;

  std::uint8_t version = 0;      ///< 1 with transactions.
  std::uint8_t layers = 0;       ///< kLayerMaskRam, ...
  std::uint8_t transaction = 0;  ///< kTransactionNone, ...; ignored by version 0.

  static constexpr auto fields() {
    return std::make_tuple(at(0, &CfgValsetHead::version), at(1, &CfgValsetHead::layers),
                           at(2, &CfgValsetHead::transaction));
  }
  friend bool operator==(const CfgValsetHead&, const CfgValsetHead&) = default;
};

/// CFG-VALGET: the request (version 0) is followed by keys, the answer (version 1) by keys with
/// values.
struct CfgValgetHead {
  static constexpr MessageId kId{0x06, 0x8B};
  static constexpr std::size_t kLength = 4 /*fields*/;

  std::uint8_t version = 0;
  std::uint8_t layer = 0;      ///< kLayerRam, ...
  std::uint16_t position = 0;  ///< So many items are left out at the beginning.

  static constexpr auto fields() {
    return std::make_tuple(at(0, &CfgValgetHead::version), at(1, &CfgValgetHead::layer),
                           at(2, &CfgValgetHead::position));
  }
  friend bool operator==(const CfgValgetHead&, const CfgValgetHead&) = default;
};

/// CFG-VALDEL: followed by keys.
struct CfgValdelHead {
  static constexpr MessageId kId{0x06, 0x8C};
  static constexpr std::size_t kLength = 4 /*fields*/;

  std::uint8_t version = 0;      ///< 1 with transactions.
  std::uint8_t layers = 0;       ///< kLayerMaskBattery, kLayerMaskFlash.
  std::uint8_t transaction = 0;  ///< kTransactionNone, ...; ignored by version 0.

  static constexpr auto fields() {
    return std::make_tuple(at(0, &CfgValdelHead::version), at(1, &CfgValdelHead::layers),
                           at(2, &CfgValdelHead::transaction));
  }
  friend bool operator==(const CfgValdelHead&, const CfgValdelHead&) = default;
};

}  // namespace rigwire::protocols::ubx
