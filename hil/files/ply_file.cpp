#include "hil/files/ply_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "hil/configuration/plain_text.h"

namespace rigwire::hil {
namespace {

enum class Kind : std::uint8_t { signed_integer, unsigned_integer, floating };
struct Type {
  std::string_view name;
  std::string_view other_name;
  Kind kind;
  std::size_t bytes;
};
constexpr std::array<Type, 8> kTypes{{{"char", "int8", Kind::signed_integer, 1},
                                      {"uchar", "uint8", Kind::unsigned_integer, 1},
                                      {"short", "int16", Kind::signed_integer, 2},
                                      {"ushort", "uint16", Kind::unsigned_integer, 2},
                                      {"int", "int32", Kind::signed_integer, 4},
                                      {"uint", "uint32", Kind::unsigned_integer, 4},
                                      {"float", "float32", Kind::floating, 4},
                                      {"double", "float64", Kind::floating, 8}}};

struct Property {
  std::string name;
  const Type* type = nullptr;
  const Type* count = nullptr;  ///< Type of a list's length; null: one value.
};
struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

class PlyReader {
 public:
  PlyReader(std::span<const std::uint8_t> bytes, const std::string& who)
      : bytes_(bytes), who_(who) {}

  sim::TriangleMesh read() {
    read_header();
    for (const Element& element : elements_) {
      // A row has a byte at least, so that a count without its rows takes no time.
      if (!element.properties.empty() && element.count > bytes_.size() - at_) {
        refuse(fmt::format("{} rows of element {} do not fit into the file", element.count,
                           printable(element.name)));
      }
      for (std::uint64_t row = 0; row < element.count && !element.properties.empty(); ++row) {
        read_row(element);
      }
    }
    for (const auto& triangle : mesh_.triangles) {
      for (const std::uint32_t corner : triangle) {
        if (corner >= mesh_.vertices.size()) {
          refuse(fmt::format("a face has vertex {}, allowed 0 to {}", corner,
                             static_cast<std::int64_t>(mesh_.vertices.size()) - 1));
        }
      }
    }
    if (mesh_.triangles.empty()) {
      refuse("it has no face");
    }
    return std::move(mesh_);
  }

 private:
  [[noreturn]] void refuse(const std::string& what) const {
    throw std::invalid_argument(
        who_ + what +
        (binary_ ? fmt::format(" (byte {})", at_) : fmt::format(" (line {})", line_)));
  }

  std::string_view next_line() {
    if (at_ >= bytes_.size()) {
      refuse("it ends early");
    }
    const auto rest = bytes_.subspan(at_);
    const auto size =
        static_cast<std::size_t>(std::ranges::find(rest, std::uint8_t{'\n'}) - rest.begin());
    at_ += std::min(size + 1, rest.size());
    ++line_;
    std::string_view line(reinterpret_cast<const char*>(rest.data()), size);
    if (line.ends_with('\r')) {
      line.remove_suffix(1);
    }
    return line;
  }

  /// The next word of a text; empty at its end.
  static std::string_view take_word(std::string_view& text) {
    const std::size_t begin = std::min(text.find_first_not_of(" \t"), text.size());
    const std::size_t end = std::min(text.find_first_of(" \t", begin), text.size());
    const std::string_view word = text.substr(begin, end - begin);
    text.remove_prefix(end);
    return word;
  }

  const Type* type(std::string_view word) const {
    for (const Type& each : kTypes) {
      if (word == each.name || word == each.other_name) {
        return &each;
      }
    }
    refuse(fmt::format("no type of a property, found \"{}\"", printable(word)));
  }

  void read_header() {
    if (next_line() != "ply") {
      refuse("it does not begin with \"ply\"");
    }
    std::string_view format = next_line();
    const std::string_view keyword = take_word(format);
    const std::string_view form = take_word(format);
    const bool little = form == "binary_little_endian";
    const bool big = form == "binary_big_endian";
    if (keyword != "format" || !(little || big || form == "ascii")) {
      refuse("no format, allowed ascii, binary_little_endian or binary_big_endian");
    }
    for (std::string_view line = next_line(); line != "end_header"; line = next_line()) {
      read_declaration(line);
    }
    binary_ = little || big;
    swapped_ = binary_ && little != (std::endian::native == std::endian::little);
  }

  void read_declaration(std::string_view line) {
    const std::string_view keyword = take_word(line);
    if (keyword == "element") {
      Element& element = elements_.emplace_back();
      element.name = take_word(line);
      const std::string_view count = take_word(line);
      if (std::from_chars(count.data(), count.data() + count.size(), element.count).ec !=
          std::errc{}) {
        refuse(fmt::format("no number of rows, found \"{}\"", printable(count)));
      }
    } else if (keyword == "property" && !elements_.empty()) {
      Property property;
      std::string_view word = take_word(line);
      if (word == "list") {
        property.count = type(take_word(line));
        word = take_word(line);
      }
      property.type = type(word);
      property.name = take_word(line);
      elements_.back().properties.push_back(std::move(property));
    } else if (keyword != "comment" && keyword != "obj_info") {
      refuse(fmt::format("no line of a header, found \"{}\"", printable(keyword)));
    }
  }

  double value(const Type& of, std::string_view& line) {
    if (binary_) {
      return binary_value(of);
    }
    const std::string_view word = take_word(line);
    double number = 0.0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    if (word.empty() || error != std::errc{} || end != word.data() + word.size()) {
      refuse(fmt::format("no number, found \"{}\"", printable(word)));
    }
    return number;
  }

  double binary_value(const Type& of) {
    if (bytes_.size() - at_ < of.bytes) {
      refuse("it ends early");
    }
    std::uint64_t raw = 0;
    for (std::size_t i = 0; i < of.bytes; ++i) {
      const bool little = swapped_ != (std::endian::native == std::endian::little);
      raw |= std::uint64_t{bytes_[at_ + i]} << (8U * (little ? i : of.bytes - 1 - i));
    }
    at_ += of.bytes;
    if (of.kind == Kind::floating) {
      return of.bytes == 4 ? std::bit_cast<float>(static_cast<std::uint32_t>(raw))
                           : std::bit_cast<double>(raw);
    }
    const double range = of.bytes == 1 ? 256.0 : of.bytes == 2 ? 65536.0 : 4294967296.0;
    const auto number = static_cast<double>(raw);
    return of.kind == Kind::signed_integer && number >= 0.5 * range ? number - range : number;
  }

  /// A whole number that counts or names something.
  std::uint32_t index(const Type& of, std::string_view& line) {
    const double number = value(of, line);
    if (!(number >= 0.0 && number < 4294967295.0) || number != std::floor(number)) {
      refuse(fmt::format("no number of a vertex or of vertices, found {}", number));
    }
    return static_cast<std::uint32_t>(number);
  }

  void read_row(const Element& element) {
    std::string_view line;
    while (!binary_ && line.find_first_not_of(" \t") == std::string_view::npos) {
      line = next_line();
    }
    const bool is_vertex = element.name == "vertex";
    const bool is_face = element.name == "face";
    Eigen::Vector3f vertex = Eigen::Vector3f::Zero();
    for (const Property& property : element.properties) {
      if (property.count != nullptr) {
        read_list(property, is_face, line);
        continue;
      }
      const double number = value(*property.type, line);
      constexpr std::string_view kAxes = "xyz";
      if (is_vertex && property.name.size() == 1) {
        if (const std::size_t axis = kAxes.find(property.name[0]); axis != std::string_view::npos) {
          vertex[static_cast<Eigen::Index>(axis)] = static_cast<float>(number);
        }
      }
    }
    if (is_vertex) {
      mesh_.vertices.push_back(vertex);
    }
  }

  void read_list(const Property& property, bool is_face, std::string_view& line) {
    const std::uint32_t count = index(*property.count, line);
    if (count > bytes_.size() - at_ + line.size()) {
      refuse(fmt::format("a list of {} values does not fit into the file", count));
    }
    const bool is_corners =
        is_face && (property.name == "vertex_indices" || property.name == "vertex_index");
    std::array<std::uint32_t, 2> corners{};  // the first, and the one before
    for (std::uint32_t i = 0; i < count; ++i) {
      if (!is_corners) {
        (void)value(*property.type, line);
        continue;
      }
      const std::uint32_t corner = index(*property.type, line);
      if (i >= 2) {
        mesh_.triangles.push_back({corners[0], corners[1], corner});
      }
      corners[i == 0 ? 0 : 1] = corner;
    }
  }

  std::span<const std::uint8_t> bytes_;
  const std::string& who_;
  std::size_t at_ = 0;
  std::size_t line_ = 0;
  bool binary_ = false;
  bool swapped_ = false;
  std::vector<Element> elements_;
  sim::TriangleMesh mesh_;
};

}  // namespace

sim::TriangleMesh read_ply(std::span<const std::uint8_t> bytes, const std::string& who) {
  return PlyReader(bytes, who).read();
}

}  // namespace rigwire::hil
