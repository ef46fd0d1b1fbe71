// CFG-VALSET, CFG-VALGET and CFG-VALDEL: configuration by lists of keys and values.
//
// Source: u-blox F9 HPG 1.50 interface description, UBXDOC-963802114-12815, sections 3.10.23 to
// 3.10.25 and 6 "Configuration interface".
//
//   VALSET  version 0|1, layers, transaction (version 1), reserved, { key U4, value } ...
//   VALGET  request:  version 0, layer, position U2, { key U4 } ...
//           reply:    version 1, layer, position U2, { key U4, value } ...
//   VALDEL  version 0|1, layers, transaction (version 1), reserved, { key U4 } ...
//
// A value has as many bytes as its key says (value_bytes()), least significant first.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "protocols/result.h"
#include "protocols/ubx/configuration_keys.h"
#include "protocols/ubx/frame.h"

namespace rigwire::protocols::ubx {

inline constexpr MessageId kCfgValset{0x06, 0x8A};
inline constexpr MessageId kCfgValget{0x06, 0x8B};
inline constexpr MessageId kCfgValdel{0x06, 0x8C};

/// Layers as CFG-VALSET and CFG-VALDEL mask them.
inline constexpr std::uint8_t kLayerMaskRam = 0x01;
inline constexpr std::uint8_t kLayerMaskBattery = 0x02;
inline constexpr std::uint8_t kLayerMaskFlash = 0x04;
/// Layers as CFG-VALGET numbers them.
inline constexpr std::uint8_t kLayerRam = 0;
inline constexpr std::uint8_t kLayerBattery = 1;
inline constexpr std::uint8_t kLayerFlash = 2;
inline constexpr std::uint8_t kLayerDefault = 7;

/// Most items of one message.
inline constexpr std::size_t kMaximumConfigurationItems = 64;
inline constexpr std::size_t kKeyListHeadBytes = 4 /*version, layer, transaction or position*/;
/// The longest payload of all three.
inline constexpr std::size_t kLongestKeyList =
    kKeyListHeadBytes + kMaximumConfigurationItems * (4 /*key*/ + 8 /*value*/);

enum class Transaction : std::uint8_t { none = 0, start = 1, ongoing = 2, apply = 3 };

struct KeyValue {
  std::uint32_t key = 0;
  std::uint64_t value = 0;  ///< The bytes as they are; signed numbers are not extended.

  friend bool operator==(const KeyValue&, const KeyValue&) = default;
};

/// VALSET or VALDEL. `list` points into the frame; it is sound: read it with KeyValueReader or
/// KeyReader.
struct KeyChange {
  std::uint8_t version = 0;
  std::uint8_t layers = 0;
  Transaction transaction = Transaction::none;
  std::span<const std::uint8_t> list;
  std::size_t count = 0;
};

/// VALGET: the request's keys, for KeyReader, or the answer's keys and values, for KeyValueReader.
struct KeyQuery {
  std::uint8_t layer = 0;      ///< Layer as received; kLayerRam and the following ones exist.
  std::uint16_t position = 0;  ///< Number of items to skip at the beginning.
  std::span<const std::uint8_t> list;
  std::size_t count = 0;
};

/// Malformed when the message is another one, of an unknown version, cut within a key or value, has
/// a key of no size, or more than kMaximumConfigurationItems keys.
[[nodiscard]] Decoded<KeyChange> decode_valset(const FrameView& frame);
[[nodiscard]] Decoded<KeyChange> decode_valdel(const FrameView& frame);
[[nodiscard]] Decoded<KeyQuery> decode_valget(const FrameView& frame);
/// VALGET's reply, for clients.
[[nodiscard]] Decoded<KeyQuery> decode_valget_reply(const FrameView& frame);

/// Walks a list of keys and values; stops at the first one that is cut or has no size.
class KeyValueReader {
 public:
  explicit KeyValueReader(std::span<const std::uint8_t> list) : rest_(list) {}

  [[nodiscard]] std::optional<KeyValue> next();
  /// Whether everything was read.
  [[nodiscard]] bool finished() const { return rest_.empty(); }

 private:
  std::span<const std::uint8_t> rest_;
};

/// Walks a list of keys; a cut one ends it.
class KeyReader {
 public:
  explicit KeyReader(std::span<const std::uint8_t> list) : rest_(list) {}

  [[nodiscard]] std::optional<std::uint32_t> next();

 private:
  std::span<const std::uint8_t> rest_;
};

/// Builds a payload of one of the three messages in place. What does not fit is refused and leaves
/// the payload as it is.
class KeyListWriter {
 public:
  explicit KeyListWriter(std::span<std::uint8_t> out) : out_(out) {}

  bool head(std::uint8_t version, std::uint8_t layer, std::uint16_t rest);
  bool key(std::uint32_t key);
  bool value(const KeyValue& pair);

  [[nodiscard]] std::span<const std::uint8_t> payload() const { return out_.first(size_); }

 private:
  std::span<std::uint8_t> out_;
  std::size_t size_ = 0;
};

}  // namespace rigwire::protocols::ubx
