#include "protocols/gige_vision/genicam.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <charconv>
#include <cstdio>

#include "protocols/markup.h"

namespace rigwire::protocols::gige_vision {
namespace {

constexpr std::string_view kDevicePort = "Device";
constexpr unsigned kHighestBit = 31;

std::string hex(std::uint64_t value, std::string_view prefix = "0x") {
  std::array<char, 16> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value, 16).ptr;
  std::string text(digits.data(), end);
  std::ranges::transform(text, text.begin(), [](char c) {
    return c >= 'a' && c <= 'f' ? static_cast<char>(c - 'a' + 'A') : c;
  });
  return std::string(prefix) + text;
}

/// Shortest text that reads back as the same number.
std::string decimal(double value) {
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
  return {digits.data(), end};
}

std::string register_name(std::string_view feature) {
  return std::string(feature) + "Reg";
}

/// A name as the schema allows it for attributes of the whole description: letters, digits and
/// underscores, a letter first.
std::string plain_name(std::string_view text) {
  std::string name;
  for (const char c : text) {
    const bool letter = (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z');
    const bool digit = c >= '0' && c <= '9';
    if (name.empty() && !letter) {
      name += 'x';
    }
    name += letter || digit ? c : '_';
  }
  return name;
}

/// FNV-1a (Fowler, Noll, Vo), 64 bits.
std::uint64_t hash(std::string_view text) {
  std::uint64_t value = 0xCBF2'9CE4'8422'2325U;
  for (const char c : text) {
    value = (value ^ static_cast<std::uint8_t>(c)) * 0x0000'0100'0000'01B3U;
  }
  return value;
}

/// Two numbers in the form of a GUID, 8-4-4-4-12.
std::string guid(std::uint64_t high, std::uint64_t low) {
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%08X-%04X-%04X-%04X-%012llX",
                static_cast<unsigned>(high >> 32U), static_cast<unsigned>((high >> 16U) & 0xFFFFU),
                static_cast<unsigned>(high & 0xFFFFU), static_cast<unsigned>(low >> 48U),
                static_cast<unsigned long long>(low & 0xFFFF'FFFF'FFFFU));
  return text.data();
}

std::string_view access_mode(Access access) {
  switch (access) {
    case Access::read_only:
      return "RO";
    case Access::write_only:
      return "WO";
    case Access::read_write:
      return "RW";
  }
  return {};
}

std::string_view visibility_name(Visibility visibility) {
  switch (visibility) {
    case Visibility::beginner:
      return "Beginner";
    case Visibility::expert:
      return "Expert";
    case Visibility::guru:
      return "Guru";
    case Visibility::invisible:
      return "Invisible";
  }
  return {};
}

const Feature& find(std::span<const Feature> features, std::string_view name) {
  const auto found = std::ranges::find(features, name, &Feature::name);
  assert(found != features.end());
  return *found;
}

/// Values of a selector.
std::uint32_t selections(std::span<const Feature> features, const Place& place) {
  if (place.selector.empty()) {
    return 1;
  }
  const auto& kind = std::get<EnumerationFeature>(find(features, place.selector).kind);
  std::int64_t highest = 0;
  for (const Entry& entry : kind.entries) {
    highest = std::max(highest, entry.value);
  }
  return static_cast<std::uint32_t>(highest + 1);
}

/// Elements in the order that the schema prescribes.
class Writer {
 public:
  explicit Writer(std::span<const Feature> features) : features_(features) {}

  void categories() {
    std::vector<std::string_view> names;
    for (const Feature& feature : features_) {
      if (!feature.category.empty() && std::ranges::find(names, feature.category) == names.end()) {
        names.push_back(feature.category);
      }
    }
    open("Category", "Root", true);
    for (const std::string_view name : names) {
      element("pFeature", name);
    }
    close("Category");
    for (const std::string_view name : names) {
      open("Category", name, true);
      for (const Feature& feature : features_) {
        if (feature.category == name) {
          element("pFeature", feature.name);
        }
      }
      close("Category");
    }
  }

  void feature(const Feature& feature) {
    std::visit([this, &feature](const auto& kind) { node(feature, kind); }, feature.kind);
    if (feature.place && !std::holds_alternative<StringFeature>(feature.kind)) {
      value_register(feature);
    }
  }

  void ports() {
    open("Port", kDevicePort, true);
    close("Port");
    std::vector<std::uint32_t> chunks;
    for (const Feature& feature : features_) {
      if (feature.place && feature.place->chunk &&
          std::ranges::find(chunks, *feature.place->chunk) == chunks.end()) {
        chunks.push_back(*feature.place->chunk);
        open("Port", port(*feature.place), false);
        element("ChunkID", hex(*feature.place->chunk, ""));
        close("Port");
      }
    }
  }

  [[nodiscard]] std::string take() { return std::move(text_); }

 private:
  static std::string port(const Place& place) {
    return place.chunk ? "Chunk" + hex(*place.chunk, "") + "Port" : std::string(kDevicePort);
  }

  void open(std::string_view tag, std::string_view name, bool standard) {
    text_ += '<';
    text_ += tag;
    text_ += " Name=\"";
    text_ += name;
    text_ += standard ? "\" NameSpace=\"Standard\">\n" : "\" NameSpace=\"Custom\">\n";
  }
  void close(std::string_view tag) {
    text_ += "</";
    text_ += tag;
    text_ += ">\n";
  }
  void element(std::string_view tag, std::string_view content) {
    text_ += '<';
    text_ += tag;
    text_ += '>';
    text_ += escape_markup(content);
    text_ += "</";
    text_ += tag;
    text_ += ">\n";
  }
  void optional_element(std::string_view tag, std::string_view content) {
    if (!content.empty()) {
      element(tag, content);
    }
  }

  /// What every feature says first.
  void preamble(const Feature& feature) {
    optional_element("Description", feature.text);
    element("Visibility", visibility_name(feature.visibility));
    if (feature.locked_by_stream) {
      element("pIsLocked", "TLParamsLocked");
    }
  }
  void value_of(const Feature& feature) {
    if (feature.place) {
      element("pValue", register_name(feature.name));
    } else {
      element("Value", "0");
    }
  }
  void selected_by(const Feature& selector) {
    for (const Feature& feature : features_) {
      if (feature.place && feature.place->selector == selector.name) {
        element("pSelected", feature.name);
      }
    }
  }

  void node(const Feature& feature, const IntegerFeature& kind) {
    open("Integer", feature.name, true);
    preamble(feature);
    value_of(feature);
    element("Min", std::to_string(kind.minimum));
    if (kind.maximum_of.empty()) {
      element("Max", std::to_string(kind.maximum));
    } else {
      element("pMax", kind.maximum_of);
    }
    if (kind.increment != 1) {
      element("Inc", std::to_string(kind.increment));
    }
    optional_element("Unit", kind.unit);
    optional_element("Representation", kind.representation);
    close("Integer");
  }
  void node(const Feature& feature, const FloatFeature& kind) {
    open("Float", feature.name, true);
    preamble(feature);
    value_of(feature);
    element("Min", decimal(kind.minimum));
    if (kind.maximum_of.empty()) {
      element("Max", decimal(kind.maximum));
    } else {
      element("pMax", kind.maximum_of);
    }
    optional_element("Unit", kind.unit);
    close("Float");
  }
  void node(const Feature& feature, const EnumerationFeature& kind) {
    open("Enumeration", feature.name, true);
    preamble(feature);
    for (const Entry& entry : kind.entries) {
      open("EnumEntry", entry.name, true);
      element("Value", std::to_string(entry.value));
      close("EnumEntry");
    }
    value_of(feature);
    selected_by(feature);
    close("Enumeration");
  }
  void node(const Feature& feature, const BooleanFeature&) {
    open("Boolean", feature.name, true);
    preamble(feature);
    value_of(feature);
    element("OnValue", "1");
    element("OffValue", "0");
    close("Boolean");
  }
  void node(const Feature& feature, const CommandFeature& kind) {
    open("Command", feature.name, true);
    preamble(feature);
    value_of(feature);
    element("CommandValue", std::to_string(kind.value));
    close("Command");
  }
  void node(const Feature& feature, const StringFeature&) {
    open("StringReg", feature.name, true);
    preamble(feature);
    place(feature);
    close("StringReg");
  }

  void place(const Feature& feature) {
    const Place& place = *feature.place;
    element("Address", hex(place.address));
    if (!place.selector.empty()) {
      text_ += "<pIndex Offset=\"" + std::to_string(place.stride) + "\">" +
               register_name(place.selector) + "</pIndex>\n";
    }
    element("Length", std::to_string(place.length));
    element("AccessMode", access_mode(place.access));
    element("pPort", port(place));
    element("Cachable", feature.constant ? "WriteThrough" : "NoCache");
  }

  void value_register(const Feature& feature) {
    const Place& where = *feature.place;
    const bool real = std::holds_alternative<FloatFeature>(feature.kind);
    const std::string_view tag = real ? "FloatReg" : where.bits ? "MaskedIntReg" : "IntReg";
    open(tag, register_name(feature.name), false);
    element("Visibility", visibility_name(Visibility::invisible));
    place(feature);
    // With the most significant byte first, GenICam counts bits from the most significant one.
    if (where.bits) {
      element("LSB", std::to_string(kHighestBit - where.bits->lowest));
      element("MSB", std::to_string(kHighestBit - where.bits->highest));
    }
    if (!real) {
      const auto* const integer = std::get_if<IntegerFeature>(&feature.kind);
      element("Sign", integer != nullptr && integer->minimum < 0 ? "Signed" : "Unsigned");
    }
    element("Endianess", "BigEndian");
    close(tag);
  }

  std::span<const Feature> features_;
  std::string text_;
};

}  // namespace

std::string write_description(const DescriptionIdentity& identity,
                              std::span<const Feature> features) {
  Writer writer(features);
  writer.categories();
  for (const Feature& feature : features) {
    writer.feature(feature);
  }
  writer.ports();
  const std::string nodes = writer.take();

  const std::uint64_t product =
      hash(std::string(identity.vendor) + '/' + std::string(identity.model));
  std::string text = "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<RegisterDescription";
  const auto attribute = [&text](std::string_view name, std::string_view value) {
    text += ' ';
    text += name;
    text += "=\"";
    text += escape_markup(value);
    text += '"';
  };
  attribute("ModelName", plain_name(identity.model));
  attribute("VendorName", plain_name(identity.vendor));
  attribute("ToolTip", identity.text);
  attribute("StandardNameSpace", "GEV");
  attribute("SchemaMajorVersion", "1");
  attribute("SchemaMinorVersion", "1");
  attribute("SchemaSubMinorVersion", "0");
  attribute("MajorVersion", "1");
  attribute("MinorVersion", "0");
  attribute("SubMinorVersion", "0");
  attribute("ProductGuid", guid(product, ~product));
  attribute("VersionGuid", guid(product, hash(nodes)));
  attribute("xmlns", "http://www.genicam.org/GenApi/Version_1_1");
  attribute("xmlns:xsi", "http://www.w3.org/2001/XMLSchema-instance");
  attribute("xsi:schemaLocation",
            "http://www.genicam.org/GenApi/Version_1_1 "
            "http://www.genicam.org/GenApi/GenApiSchema_Version_1_1.xsd");
  text += ">\n" + nodes + "</RegisterDescription>\n";
  text.append((4 - text.size() % 4) % 4, '\n');
  return text;
}

std::string local_url(std::string_view file, std::uint32_t address, std::size_t size) {
  return "Local:" + std::string(file) + ';' + hex(address, "") + ';' + hex(size, "");
}

std::vector<FeatureRegister> feature_registers(std::span<const Feature> features) {
  std::vector<FeatureRegister> registers;
  const auto is_bootstrap = [](std::uint32_t address) {
    return std::ranges::any_of(kBootstrapRegisters, [address](const RegisterRow& row) {
      return address >= row.address && address < row.address + row.length;
    });
  };
  for (std::size_t i = 0; i < features.size(); ++i) {
    const std::optional<Place>& place = features[i].place;
    if (!place || place->chunk || is_bootstrap(place->address)) {
      continue;
    }
    const std::uint32_t count = selections(features, *place);
    for (std::uint32_t selected = 0; selected < count; ++selected) {
      registers.push_back({{features[i].name, place->address + selected * place->stride,
                            place->length, place->access},
                           i,
                           selected});
    }
  }
  std::ranges::sort(registers, {}, [](const FeatureRegister& r) { return r.row.address; });
  return registers;
}

}  // namespace rigwire::protocols::gige_vision
