// What the documents say that UBX messages carry: names, types and order of their fields, as
// text. Written from the documents for the checks alone; the code of this project that sends these
// messages has a table of its own (protocols/ubx/), so that an error in one shows against the
// other.
//
// Documents: u-blox M8 receiver description, UBX-13003221 R28, section 32; u-blox F9 HPG 1.50
// interface description, UBXDOC-963802114-12815, section 3. What only u-blox 7 has (RXM-RAW, the
// shorter NAV-PVT) is from recordings of such receivers; its own document was not available.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "protocols/ubx/frame.h"

namespace rigwire::conform {

enum class UbxDocument : std::uint8_t { m8, f9, recordings };

/// How a message is asked for.
enum class UbxPoll : std::uint8_t {
  empty,     ///< Without a payload.
  selected,  ///< With `selector`.
  none       ///< Not at all: it comes by itself, or is a command.
};

struct UbxMessage {
  protocols::ubx::MessageId id;
  std::string_view name;  ///< "NAV-PVT".
  UbxDocument document = UbxDocument::m8;
  std::string_view section;
  /// "iTOW:U4 _:U1*2 numCh:U1 [svid:U1 flags:X1]": name, type as in the documents, number of
  /// elements; "_" is reserved. Brackets enclose what is repeated to the end of the message. After
  /// a "|": fields that older receivers omit.
  std::string_view fields;
  /// Name of the field with the number of repetitions of the brackets; empty: the length determines
  /// it.
  std::string_view count = {};
  UbxPoll poll = UbxPoll::empty;
  std::string_view selector = {};  ///< Bytes of the poll's payload.
};

[[nodiscard]] std::span<const UbxMessage> ubx_messages();
/// Returns null for a message that no document here describes.
[[nodiscard]] const UbxMessage* ubx_message(protocols::ubx::MessageId id);
[[nodiscard]] const UbxMessage* ubx_message(std::string_view name);
[[nodiscard]] std::string source_of(const UbxMessage& message);

/// A payload read by its table.
class UbxPayload {
 public:
  UbxPayload() = default;
  UbxPayload(const UbxMessage& message, std::vector<std::uint8_t> bytes);

  [[nodiscard]] const UbxMessage& message() const { return *message_; }
  [[nodiscard]] const std::vector<std::uint8_t>& bytes() const { return bytes_; }
  /// Returns whether its length is allowed and agrees with the count.
  [[nodiscard]] bool whole() const { return whole_; }
  /// Returns the allowed lengths: "84 or 92 bytes", "8 bytes and 12 for each of numCh".
  [[nodiscard]] std::string lengths() const;

  [[nodiscard]] bool has(std::string_view field) const;
  /// Returns the value of a field that the message has (precondition), in wire units; of an array
  /// the `index`-th element.
  [[nodiscard]] double value(std::string_view field, std::size_t index = 0) const;
  /// Returns the number of repetitions of the repeated part.
  [[nodiscard]] std::size_t blocks() const { return blocks_; }
  [[nodiscard]] double value_in(std::size_t block, std::string_view field) const;
  /// Bits of a bit field.
  [[nodiscard]] unsigned bits(std::string_view field, unsigned first, unsigned count = 1) const;
  [[nodiscard]] unsigned bits_in(std::size_t block, std::string_view field, unsigned first,
                                 unsigned count = 1) const;
  /// "NAV-DOP: iTOW 1000, gDOP 110"; of blocks the first ones.
  [[nodiscard]] std::string words() const;

 private:
  struct Field {
    std::string_view name;
    std::string_view type;
    std::size_t offset = 0;  ///< Offset of its first element; in a block from the block's begin.
    std::size_t count = 1;
  };
  [[nodiscard]] const Field* find(const std::vector<Field>& in, std::string_view name) const;
  [[nodiscard]] double read(const Field& field, std::size_t at) const;
  [[nodiscard]] std::string text(const Field& field, std::size_t base) const;

  const UbxMessage* message_ = nullptr;
  std::vector<std::uint8_t> bytes_;
  std::vector<Field> head_;
  std::vector<Field> block_;
  std::size_t shorter_bytes_ = 0;  ///< Length of the head of older receivers; 0: none.
  std::size_t head_bytes_ = 0;
  std::size_t block_bytes_ = 0;
  std::size_t blocks_ = 0;
  bool whole_ = false;
};

/// A frame's message in words: by its table, or class, id and length.
[[nodiscard]] std::string ubx_words(protocols::ubx::MessageId id,
                                    std::span<const std::uint8_t> payload);
/// "NAV-PVT", or "class 01, id 7F".
[[nodiscard]] std::string ubx_name(protocols::ubx::MessageId id);

}  // namespace rigwire::conform
