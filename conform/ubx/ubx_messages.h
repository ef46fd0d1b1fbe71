// What the documents say that UBX messages carry: names, types and order of their fields, as
// text. Written from the documents for the checks alone; whoever sends these messages in this
// project has a table of its own (protocols/ubx/), so that a slip in one is seen against the other.
//
// Documents: u-blox M8 receiver description, UBX-13003221 R28, section 32; u-blox F9 HPG 1.50
// interface description, UBXDOC-963802114-12815, section 3. What only u-blox 7 has (RXM-RAW, the
// shorter NAV-PVT) is from recordings of such receivers; its own document is not at hand.
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
  /// "iTOW:U4 _:U1*2 numCh:U1 [svid:U1 flags:X1]": name, type as the documents write it, how many;
  /// "_" is reserved. In brackets what is repeated to the end of the message. Behind a "|" what
  /// older receivers leave out.
  std::string_view fields;
  /// That says how often the brackets come; empty: as often as the length has it.
  std::string_view count = {};
  UbxPoll poll = UbxPoll::empty;
  std::string_view selector = {};  ///< Bytes of the poll's payload.
};

[[nodiscard]] std::span<const UbxMessage> ubx_messages();
/// Null for what no document here describes.
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
  /// Its length is one that the message has, and the count agrees with it.
  [[nodiscard]] bool whole() const { return whole_; }
  /// What lengths it may have: "84 or 92 bytes", "8 bytes and 12 for each of numCh".
  [[nodiscard]] std::string lengths() const;

  [[nodiscard]] bool has(std::string_view field) const;
  /// Of a field that it has (precondition), in wire units; of an array the `index`-th.
  [[nodiscard]] double value(std::string_view field, std::size_t index = 0) const;
  /// Of the repeated part.
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
    std::size_t offset = 0;  ///< Of the first of its elements; in a block from its begin.
    std::size_t count = 1;
  };
  [[nodiscard]] const Field* find(const std::vector<Field>& in, std::string_view name) const;
  [[nodiscard]] double read(const Field& field, std::size_t at) const;
  [[nodiscard]] std::string text(const Field& field, std::size_t base) const;

  const UbxMessage* message_ = nullptr;
  std::vector<std::uint8_t> bytes_;
  std::vector<Field> head_;
  std::vector<Field> block_;
  std::size_t shorter_bytes_ = 0;  ///< Of the head that older receivers send; 0: there is none.
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
