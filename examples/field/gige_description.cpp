#include "field/gige_description.h"

#include <algorithm>
#include <bit>
#include <cctype>
#include <charconv>
#include <cmath>
#include <utility>

namespace rigwire::field {
namespace {

constexpr std::uint32_t kLongestDescription = 4U << 20U;
constexpr unsigned kWordBits = 64;
/// pValue leads from node to node; more than this is a ring.
constexpr int kLongestChain = 8;

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kSpace = " \t\r\n";
  const std::size_t begin = text.find_first_not_of(kSpace);
  return begin == std::string_view::npos
             ? std::string_view{}
             : text.substr(begin, text.find_last_not_of(kSpace) - begin + 1);
}

std::optional<std::int64_t> to_whole(std::string_view text) {
  text = trimmed(text);
  const bool hexadecimal = text.starts_with("0x") || text.starts_with("0X");
  const std::string_view digits = hexadecimal ? text.substr(2) : text;
  std::int64_t value = 0;
  const auto [end, error] =
      std::from_chars(digits.data(), digits.data() + digits.size(), value, hexadecimal ? 16 : 10);
  const bool all = error == std::errc{} && end == digits.data() + digits.size();
  return all && !digits.empty() ? std::optional(value) : std::nullopt;
}

std::optional<double> to_real(std::string_view text) {
  text = trimmed(text);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size() ? std::optional(value)
                                                                  : std::nullopt;
}

/// Elements of a document, one after the other. Entities are left as they are: names, numbers and
/// addresses have none.
class Markup {
 public:
  enum class What : std::uint8_t { begin, end, over };
  struct Item {
    What what = What::over;
    std::string_view tag;
    std::string_view attributes;
    std::string_view text_before;  ///< Since the item before.
    bool empty = false;            ///< <tag/>: begins and ends.
  };

  explicit Markup(std::string_view text) : text_(text) {}

  Item next() {
    const std::size_t begin = at_;
    for (;;) {
      const std::size_t open = text_.find('<', at_);
      if (open == std::string_view::npos) {
        return {};
      }
      if (skip(open, "<!--", "-->") || skip(open, "<?", "?>") || skip(open, "<!", ">")) {
        continue;
      }
      const std::size_t close = text_.find('>', open);
      if (close == std::string_view::npos) {
        throw DescriptionError("description: an element at byte " + std::to_string(open) +
                               " has no end");
      }
      at_ = close + 1;
      std::string_view inside = text_.substr(open + 1, close - open - 1);
      Item item{What::begin, {}, {}, text_.substr(begin, open - begin), false};
      if (inside.starts_with('/')) {
        item.what = What::end;
        inside.remove_prefix(1);
      } else if (inside.ends_with('/')) {
        item.empty = true;
        inside.remove_suffix(1);
      }
      const std::size_t space = inside.find_first_of(" \t\r\n");
      item.tag = inside.substr(0, space);
      item.attributes = space == std::string_view::npos ? "" : inside.substr(space);
      return item;
    }
  }

 private:
  bool skip(std::size_t open, std::string_view from, std::string_view to) {
    if (!text_.substr(open).starts_with(from)) {
      return false;
    }
    const std::size_t end = text_.find(to, open + from.size());
    at_ = end == std::string_view::npos ? text_.size() : end + to.size();
    return true;
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

std::string_view attribute(std::string_view attributes, std::string_view name) {
  for (std::size_t at = 0; (at = attributes.find(name, at)) != std::string_view::npos; ++at) {
    const bool whole =
        at > 0 && std::string_view(" \t\r\n").find(attributes[at - 1]) != std::string_view::npos;
    const std::string_view rest = trimmed(attributes.substr(at + name.size()));
    if (!whole || !rest.starts_with('=')) {
      continue;
    }
    const std::string_view value = trimmed(rest.substr(1));
    if (value.size() >= 2 && (value[0] == '"' || value[0] == '\'')) {
      const std::size_t end = value.find(value[0], 1);
      return end == std::string_view::npos ? std::string_view{} : value.substr(1, end - 1);
    }
  }
  return {};
}

std::optional<GigeFeature::Kind> kind_of(std::string_view type) {
  using Kind = GigeFeature::Kind;
  constexpr std::pair<std::string_view, Kind> kKinds[]{
      {"Integer", Kind::integer}, {"IntReg", Kind::integer},  {"MaskedIntReg", Kind::integer},
      {"Float", Kind::real},      {"FloatReg", Kind::real},   {"Enumeration", Kind::enumeration},
      {"Boolean", Kind::boolean}, {"Command", Kind::command}, {"StringReg", Kind::text},
  };
  const auto* const found =
      std::ranges::find(kKinds, type, &std::pair<std::string_view, Kind>::first);
  return found == std::end(kKinds) ? std::nullopt : std::optional(found->second);
}

bool is_register(std::string_view type) {
  return type == "IntReg" || type == "MaskedIntReg" || type == "FloatReg" || type == "StringReg";
}

/// Returns the text of a node's child, or empty.
template <class Children>
std::string_view child(const Children& children, std::string_view name) {
  const auto found = children.find(name);
  return found == children.end() ? std::string_view{} : std::string_view(found->second);
}

std::uint64_t load(const std::uint8_t* bytes, std::uint32_t length, bool little_endian) {
  std::uint64_t word = 0;
  for (std::uint32_t i = 0; i < length; ++i) {
    word = (word << 8U) | bytes[little_endian ? length - 1 - i : i];
  }
  return word;
}

void store(std::uint64_t word, std::uint8_t* bytes, std::uint32_t length, bool little_endian) {
  for (std::uint32_t i = 0; i < length; ++i) {
    bytes[little_endian ? i : length - 1 - i] = static_cast<std::uint8_t>(word);
    word >>= 8U;
  }
}

std::uint64_t low_bits(unsigned count) {
  return count >= kWordBits ? ~std::uint64_t{0} : (std::uint64_t{1} << count) - 1;
}

}  // namespace

// --- A feature's value. ----------------------------------------------------------------------

double GigeFeature::decode(const std::uint8_t* bytes) const {
  const std::uint64_t word = load(bytes, length, little_endian);
  if (kind == Kind::real) {
    return length == 4 ? static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(word)))
                       : std::bit_cast<double>(word);
  }
  const unsigned count = std::min(highest_bit, 8 * length - 1) - lowest_bit + 1;
  std::uint64_t value = (word >> lowest_bit) & low_bits(count);
  if (is_signed && count < kWordBits && (value >> (count - 1)) != 0) {
    value |= ~low_bits(count);
  }
  return is_signed ? static_cast<double>(static_cast<std::int64_t>(value))
                   : static_cast<double>(value);
}

void GigeFeature::encode(double number, std::uint8_t* bytes) const {
  if (kind == Kind::real) {
    const std::uint64_t word = length == 4
                                   ? std::bit_cast<std::uint32_t>(static_cast<float>(number))
                                   : std::bit_cast<std::uint64_t>(number);
    return store(word, bytes, length, little_endian);
  }
  const unsigned count = std::min(highest_bit, 8 * length - 1) - lowest_bit + 1;
  const std::uint64_t mask = low_bits(count) << lowest_bit;
  const auto value = static_cast<std::uint64_t>(std::llround(number)) << lowest_bit;
  const std::uint64_t word = load(bytes, length, little_endian);
  store((word & ~mask) | (value & mask), bytes, length, little_endian);
}

double GigeFeature::value_of(std::string_view text) const {
  const auto refuse = [&](const std::string& allowed) {
    throw DescriptionError(name + ": found '" + std::string(text) + "', allowed " + allowed);
  };
  switch (kind) {
    case Kind::enumeration: {
      if (const auto found = entries.find(text); found != entries.end()) {
        return static_cast<double>(found->second);
      }
      std::string allowed;
      for (const auto& [entry, value] : entries) {
        allowed += (allowed.empty() ? "" : ", ") + entry;
      }
      refuse(allowed);
      break;
    }
    case Kind::boolean:
      if (text == "0" || text == "1") {
        return static_cast<double>(text == "1" ? on_value : off_value);
      }
      refuse("0 or 1");
      break;
    case Kind::command:
      return static_cast<double>(command_value);
    case Kind::integer:
      if (const auto value = to_whole(text)) {
        return static_cast<double>(*value);
      }
      refuse("a whole number");
      break;
    case Kind::real:
      if (const auto value = to_real(text)) {
        return *value;
      }
      refuse("a number");
      break;
    case Kind::text:
      refuse("nothing: it is a text");
      break;
  }
  return 0.0;
}

// --- The description. ------------------------------------------------------------------------

GigeDescription::GigeDescription(std::string_view xml) {
  Markup markup(xml);
  Node* current = nullptr;
  std::string_view current_tag;
  std::string_view entry;  // of the enumeration that `current` is
  bool described = false;
  for (;;) {
    const Markup::Item item = markup.next();
    if (item.what == Markup::What::over) {
      break;
    }
    if (item.what == Markup::What::begin) {
      const std::string_view name = attribute(item.attributes, "Name");
      if (item.tag == "RegisterDescription") {
        described = true;
      } else if (current == nullptr && !name.empty() && item.tag != "Group" && !item.empty) {
        current = &nodes_[std::string(name)];
        *current = Node{std::string(item.tag), {}, 0, {}};
        current_tag = item.tag;
      } else if (current != nullptr && item.tag == "EnumEntry") {
        entry = name;
      } else if (current != nullptr && item.tag == "pIndex") {
        const auto offset = to_whole(attribute(item.attributes, "Offset")).value_or(0);
        current->stride = static_cast<std::uint32_t>(std::clamp<std::int64_t>(offset, 0, 1 << 30));
      }
      continue;
    }
    if (current == nullptr) {
      continue;
    }
    if (item.tag == current_tag) {
      current = nullptr;
    } else if (item.tag == "EnumEntry") {
      entry = {};
    } else if (!entry.empty()) {
      if (const auto value = to_whole(item.text_before); value && item.tag == "Value") {
        current->entries[std::string(entry)] = *value;
      }
    } else {
      current->children.emplace(item.tag, trimmed(item.text_before));
    }
  }
  if (!described || nodes_.empty()) {
    throw DescriptionError("description: found no RegisterDescription with features");
  }
}

const GigeDescription::Node& GigeDescription::node(std::string_view name) const {
  const auto found = nodes_.find(name);
  if (found == nodes_.end()) {
    throw DescriptionError("the camera has no feature " + std::string(name));
  }
  return found->second;
}

GigeFeature GigeDescription::find(std::string_view name) const {
  const Node* at = &node(name);
  const auto kind = kind_of(at->type);
  if (!kind) {
    throw DescriptionError("feature " + std::string(name) + " is a " + at->type +
                           ", which is not read");
  }
  GigeFeature feature;
  feature.kind = *kind;
  feature.name = name;
  feature.entries = at->entries;
  feature.on_value = to_whole(child(at->children, "OnValue")).value_or(1);
  feature.off_value = to_whole(child(at->children, "OffValue")).value_or(0);
  feature.command_value = to_whole(child(at->children, "CommandValue")).value_or(1);
  // From feature to feature down to the register.
  for (int step = 0; step < kLongestChain; ++step) {
    if (is_register(at->type)) {
      place(*at, feature);
      return feature;
    }
    const std::string_view onward = child(at->children, "pValue");
    if (onward.empty()) {
      feature.constant = to_real(child(at->children, "Value"));
      if (!feature.constant) {
        throw DescriptionError("feature " + std::string(name) + " has neither pValue nor Value");
      }
      return feature;
    }
    at = &node(onward);
    if (!kind_of(at->type)) {
      throw DescriptionError("feature " + std::string(name) + " is computed by a " + at->type +
                             ", which is not read");
    }
  }
  throw DescriptionError("feature " + std::string(name) + " leads to itself");
}

void GigeDescription::place(const Node& in_register, GigeFeature& feature) const {
  const auto refuse = [&feature](const std::string& what) {
    throw DescriptionError("feature " + feature.name + ": its register " + what);
  };
  const auto& children = in_register.children;
  if (children.contains("pAddress") || children.contains("IntSwissKnife")) {
    refuse("has a computed address, which is not read");
  }
  // The address is the sum of all that are given.
  std::int64_t address = 0;
  const auto [first, last] = children.equal_range("Address");
  for (auto it = first; it != last; ++it) {
    const auto part = to_whole(it->second);
    if (!part || *part < 0 || *part > 0xFFFF'FFFF) {
      refuse("has the address '" + it->second + "', allowed 0..0xFFFFFFFF");
    }
    address += *part;
  }
  const auto length = to_whole(child(children, "Length"));
  const std::int64_t longest = feature.kind == GigeFeature::Kind::text ? 512 : 8;
  if (first == last || address > 0xFFFF'FFFF || !length || *length < 1 || *length > longest) {
    refuse("has no address, or no length of 1.." + std::to_string(longest));
  }
  const bool real = in_register.type == "FloatReg";
  if (real && *length != 4 && *length != 8) {
    refuse("is a number of " + std::to_string(*length) + " bytes, allowed 4 and 8");
  }
  // An integer that is shown as a float, or the other way round, is read as it lies there.
  if (feature.kind == GigeFeature::Kind::integer || feature.kind == GigeFeature::Kind::real) {
    feature.kind = real ? GigeFeature::Kind::real : GigeFeature::Kind::integer;
  }
  feature.address = static_cast<std::uint32_t>(address);
  feature.length = static_cast<std::uint32_t>(*length);
  feature.little_endian = child(children, "Endianess") == "LittleEndian";
  feature.is_signed = child(children, "Sign") == "Signed";
  feature.stride = in_register.stride;
  feature.highest_bit = std::min(8 * feature.length, kWordBits) - 1;
  if (in_register.type == "MaskedIntReg") {
    const auto bit = to_whole(child(children, "Bit"));
    const auto least = bit ? bit : to_whole(child(children, "LSB"));
    const auto most = bit ? bit : to_whole(child(children, "MSB"));
    const std::int64_t top = feature.highest_bit;
    if (!least || !most || *least < 0 || *most < 0 || *least > top || *most > top) {
      refuse("has no bits of 0.." + std::to_string(top));
    }
    // With the most significant byte first, bits are counted from the most significant one.
    const std::int64_t a = feature.little_endian ? *least : top - *least;
    const std::int64_t b = feature.little_endian ? *most : top - *most;
    feature.lowest_bit = static_cast<unsigned>(std::min(a, b));
    feature.highest_bit = static_cast<unsigned>(std::max(a, b));
  }
  if (const std::string_view port = child(children, "pPort"); !port.empty()) {
    const auto found = nodes_.find(port);
    const std::string_view id =
        found == nodes_.end() ? std::string_view{} : child(found->second.children, "ChunkID");
    if (!id.empty()) {
      const auto number = to_whole("0x" + std::string(id));
      if (!number || *number < 0 || *number > 0xFFFF'FFFF) {
        refuse("is of a chunk with the identifier '" + std::string(id) + "'");
      }
      feature.chunk = static_cast<std::uint32_t>(*number);
    }
  }
}

GigeUrl read_gige_url(std::string_view text) {
  const std::string shown(text);
  const auto refuse = [&shown](const std::string& why) {
    throw DescriptionError("description at '" + shown + "': " + why);
  };
  std::string scheme(text.substr(0, std::min<std::size_t>(6, text.size())));
  std::ranges::transform(scheme, scheme.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const std::size_t first = text.find(';');
  const std::size_t second = first == std::string_view::npos ? first : text.find(';', first + 1);
  if (scheme != "local:" || second == std::string_view::npos) {
    refuse("allowed Local:NAME;ADDRESS;SIZE");
  }
  if (text.substr(0, first).ends_with(".zip")) {
    refuse("it is zipped, which is not read");
  }
  // A schema version may follow after "?".
  const std::string_view size_text =
      text.substr(second + 1, text.find_first_of("?;", second + 1) - second - 1);
  const auto address = to_whole("0x" + std::string(text.substr(first + 1, second - first - 1)));
  const auto size = to_whole("0x" + std::string(size_text));
  if (!address || !size || *address < 0 || *address > 0xFFFF'FFFF || *size < 1 ||
      *size > kLongestDescription) {
    refuse("allowed an address of 32 bits and a size of 1.." + std::to_string(kLongestDescription));
  }
  return {static_cast<std::uint32_t>(*address), static_cast<std::uint32_t>(*size)};
}

}  // namespace rigwire::field
