// The description that a device gives of itself: GenICam's XML of features and the registers behind
// them (EMVA, GenApi schema 1.1; names of features after SFNC, the Standard Features Naming
// Convention). One table of features makes the XML and the register map, so that they cannot
// disagree.
//
// A feature has a register of its own, a few bits of one, or one register for each value of a
// selector; registers are most significant byte first. Since the schema is 1.1, clients read and
// write them with READMEM and WRITEMEM.
//
//   <Integer Name="Width"> ... <pValue>WidthReg</pValue> <Min>16</Min> <pMax>WidthMax</pMax> ...
//   <IntReg Name="WidthReg"> <Address>0xA010</Address> <Length>4</Length> ...
//
// A client may keep what it has read only of features that are `constant`; the others may change
// with a write to another feature.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "protocols/gige_vision/bootstrap.h"

namespace rigwire::protocols::gige_vision {

enum class Visibility : std::uint8_t { beginner, expert, guru, invisible };

/// Bits of a register of four bytes, counted from the least significant one.
struct BitRange {
  unsigned lowest = 0;
  unsigned highest = 0;
};

/// Where a feature's value lies.
struct Place {
  std::uint32_t address = 0;
  std::uint32_t length = 4;
  Access access = Access::read_write;
  std::optional<BitRange> bits;
  /// Name of an enumeration whose values count from 0: the feature has a register for each of them,
  /// `stride` bytes apart.
  std::string_view selector;
  std::uint32_t stride = 0;
  /// Within this chunk of a picture, at `address`, instead of in the device.
  std::optional<std::uint32_t> chunk;
};

struct IntegerFeature {
  std::int64_t minimum = 0;
  std::int64_t maximum = 0xFFFF'FFFF;
  std::int64_t increment = 1;
  std::string_view maximum_of = {};  ///< Name of the integer feature that holds it at present.
  std::string_view unit = {};
  std::string_view representation =
      {};  ///< "HexNumber", "IPV4Address", "MACAddress"; empty: linear.
};
struct FloatFeature {
  double minimum = 0.0;
  double maximum = 0.0;
  std::string_view maximum_of = {};  ///< Name of the float feature that holds it at present.
  std::string_view unit = {};
};
struct Entry {
  std::int64_t value = 0;
  std::string_view name;
};
struct EnumerationFeature {
  std::vector<Entry> entries;
};
/// 1 and 0.
struct BooleanFeature {};
/// Done when 1 is written, unless it says otherwise.
struct CommandFeature {
  std::uint32_t value = 1;
};
struct StringFeature {};

using FeatureKind = std::variant<IntegerFeature, FloatFeature, EnumerationFeature, BooleanFeature,
                                 CommandFeature, StringFeature>;

struct Feature {
  std::string_view name;
  std::string_view category;  ///< Empty: it is in no list.
  Visibility visibility = Visibility::beginner;
  std::string_view text;  ///< One sentence.
  FeatureKind kind;
  /// Nothing: an integer that the client keeps to itself, 0 at first.
  std::optional<Place> place;
  bool constant = false;
  /// A client must not change it while it streams (TLParamsLocked).
  bool locked_by_stream = false;
};

struct DescriptionIdentity {
  std::string_view vendor;
  std::string_view model;
  std::string_view text;
};

/// The description; its length is a multiple of 4, since clients read whole words. Precondition:
/// names are unique, selectors and limits name features of the list.
[[nodiscard]] std::string write_description(const DescriptionIdentity& identity,
                                            std::span<const Feature> features);

/// Returns the content of the URL register for a description of `size` bytes at `address`:
/// "Local:camera.xml;10000;8A40".
[[nodiscard]] std::string local_url(std::string_view file, std::uint32_t address, std::size_t size);

/// A register of the map; `feature` indexes the list of features.
struct FeatureRegister {
  RegisterRow row;
  std::size_t feature = 0;
  std::uint32_t selected = 0;  ///< Value of the selector, 0 without one.
};
/// Registers of all features that are not among the bootstrap registers, in order of their
/// addresses. Precondition: as above; none overlaps another.
[[nodiscard]] std::vector<FeatureRegister> feature_registers(std::span<const Feature> features);

}  // namespace rigwire::protocols::gige_vision
