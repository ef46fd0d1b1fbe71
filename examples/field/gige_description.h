// What a GigE Vision camera says of itself: its GenICam description (EMVA, GenApi schema 1.0 and
// 1.1), from which a client learns by a feature's name where its value lies. So a camera of another
// maker, whose registers are elsewhere, needs no other program.
//
// Read is what cameras need for settings and readings: features (Integer, Float, Enumeration,
// Boolean, Command, StringReg) that lead by pValue to a register (IntReg, MaskedIntReg, FloatReg,
// StringReg) with fixed addresses, or with a pIndex whose offset counts by a selector's value. Not
// read: values that the description computes (Converter, SwissKnife) and addresses that it computes
// (pAddress); find() says so.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace rigwire::field {

/// The description cannot be read, or has no such feature; what() says which and why.
class DescriptionError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct GigeFeature {
  enum class Kind : std::uint8_t { integer, real, enumeration, boolean, command, text };

  Kind kind = Kind::integer;
  std::string name;
  /// Nothing lies in the device: the description itself gives the value.
  std::optional<double> constant;
  std::uint32_t address = 0;
  std::uint32_t length = 0;  ///< Bytes: 1 .. 8 of numbers.
  bool little_endian = false;
  bool is_signed = false;
  /// Bits of the value, counted from the least significant one.
  unsigned lowest_bit = 0;
  unsigned highest_bit = 63;
  /// Set: the value lies in this chunk of a picture, at `address`.
  std::optional<std::uint32_t> chunk;
  /// Distance of the registers of neighbouring values of the selector; 0: there is one register.
  std::uint32_t stride = 0;
  std::map<std::string, std::int64_t, std::less<>> entries;  ///< Entries of an enumeration.
  std::int64_t on_value = 1;
  std::int64_t off_value = 0;
  std::int64_t command_value = 1;

  /// Decodes the number in the feature's own bytes. Precondition: bytes.size() == length <= 8, no
  /// text.
  [[nodiscard]] double decode(const std::uint8_t* bytes) const;
  /// The bytes with the number in them; what is beside its bits stays as in `bytes`.
  void encode(double number, std::uint8_t* bytes) const;
  /// What the text means to this feature: a number, an entry, 0 or 1. Throws DescriptionError with
  /// what was found and what is allowed.
  [[nodiscard]] double value_of(std::string_view text) const;
  /// Part of a word that is shared with other features, so that writing needs reading before.
  [[nodiscard]] bool partial() const { return kind != Kind::real && highest_bit < 8 * length - 1; }
};

class GigeDescription {
 public:
  /// Throws DescriptionError when the text is no description.
  explicit GigeDescription(std::string_view xml);

  [[nodiscard]] bool has(std::string_view feature) const { return nodes_.contains(feature); }
  /// Throws DescriptionError: unknown, or not of the kinds above.
  [[nodiscard]] GigeFeature find(std::string_view feature) const;

 private:
  struct Node {
    std::string type;
    std::multimap<std::string, std::string, std::less<>> children;
    std::uint32_t stride = 0;  ///< Address step of pIndex.
    std::map<std::string, std::int64_t, std::less<>> entries;
  };

  [[nodiscard]] const Node& node(std::string_view name) const;
  void place(const Node& in_register, GigeFeature& feature) const;

  std::map<std::string, Node, std::less<>> nodes_;
};

/// Content of a camera's URL register: "Local:NAME;ADDRESS;SIZE", both hexadecimal.
struct GigeUrl {
  std::uint32_t address = 0;
  std::uint32_t size = 0;
};
/// Throws DescriptionError for a description that is not in the camera, zipped, or longer than
/// 4 MiB.
[[nodiscard]] GigeUrl read_gige_url(std::string_view text);

}  // namespace rigwire::field
