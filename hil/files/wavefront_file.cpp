#include "hil/files/wavefront_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>
#include <set>
#include <stdexcept>

namespace rigwire::hil {
namespace {

constexpr std::string_view kBlanks = " \t\r\f\v";

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kBlanks);
  return first == std::string_view::npos
             ? std::string_view{}
             : text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

/// Words of a line, one after the other.
class Words {
 public:
  explicit Words(std::string_view line) : rest_(trimmed(line)) {}

  [[nodiscard]] bool more() const { return !rest_.empty(); }
  /// The next one, without taking it.
  [[nodiscard]] std::string_view peek() const {
    return rest_.substr(0, rest_.find_first_of(kBlanks));
  }
  std::string_view next() {
    const std::string_view word = peek();
    rest_ = trimmed(rest_.substr(word.size()));
    return word;
  }
  /// All that is left.
  [[nodiscard]] std::string_view rest() const { return rest_; }

 private:
  std::string_view rest_;
};

/// The lines of a file with their numbers, comments cut off, lines that go on joined.
template <class Take>
void each_line(std::string_view text, Take&& take) {
  std::size_t number = 0;
  std::string joined;
  std::size_t first = 0;
  if (constexpr std::string_view kByteOrder = "\xEF\xBB\xBF"; text.starts_with(kByteOrder)) {
    text.remove_prefix(kByteOrder.size());
  }
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    std::string_view line = text.substr(0, end);
    text = end == std::string_view::npos ? std::string_view{} : text.substr(end + 1);
    ++number;
    line = trimmed(line.substr(0, line.find('#')));
    first = joined.empty() ? number : first;
    if (!line.empty() && line.back() == '\\') {
      joined.append(line.substr(0, line.size() - 1)).push_back(' ');
      continue;
    }
    if (joined.empty()) {
      take(line, number);
    } else {
      joined.append(line);
      take(joined, first);
      joined.clear();
    }
  }
  if (!joined.empty()) {
    take(joined, first);
  }
}

std::optional<double> number(std::string_view word) {
  if (!word.empty() && word.front() == '+') {
    word.remove_prefix(1);
  }
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size()) {
    return std::nullopt;
  }
  return value;
}

[[noreturn]] void refuse(const std::string& who, std::size_t line, const std::string& what) {
  throw std::invalid_argument(fmt::format("{}:{}: {}", who, line, what));
}

double finite(const std::string& who, std::size_t line, std::string_view what,
              std::string_view word) {
  const auto value = number(word);
  if (!value || !std::isfinite(*value)) {
    refuse(who, line, fmt::format("{}: found '{}', allowed: a finite number", what, word));
  }
  return *value;
}

/// What of a file a corner names.
struct Counted {
  std::string_view what;
  std::size_t count = 0;
};

/// A corner's index that counts from the file's beginning, to be held against its end.
struct Named {
  std::size_t kind = 0;
  std::size_t index = 0;
  std::size_t line = 0;
};

}  // namespace

WavefrontMesh scan_wavefront_mesh(std::string_view text, const std::string& who) {
  WavefrontMesh mesh;
  std::array<Counted, 3> counted{{{"vertex"}, {"texture coordinate"}, {"normal"}}};
  std::array<Named, 3> farthest{};  // maximum index of each kind
  std::string material;
  const auto out_of_range = [&](std::size_t line, std::size_t kind, std::string_view index) {
    refuse(who, line,
           fmt::format("f: found {} {}, allowed: 1 to {}, or -1 to -{}", counted[kind].what, index,
                       counted[kind].count, counted[kind].count));
  };
  const auto corner = [&](std::string_view word, std::size_t line) {
    bool has_coordinate = false;
    for (std::size_t kind = 0; kind < counted.size() && !word.empty(); ++kind) {
      const std::string_view index = word.substr(0, word.find('/'));
      word.remove_prefix(std::min(word.size(), index.size() + 1));
      if (index.empty() && kind > 0) {
        continue;
      }
      long long value = 0;
      const auto [end, error] = std::from_chars(index.data(), index.data() + index.size(), value);
      if (error != std::errc{} || end != index.data() + index.size()) {
        refuse(who, line,
               fmt::format("f: found '{}', allowed: vertex, vertex/texture coordinate, "
                           "vertex//normal or all three, by their numbers",
                           index));
      }
      if (value == 0 ||
          (value < 0 && static_cast<std::size_t>(-(value + 1)) >= counted[kind].count)) {
        out_of_range(line, kind, index);
      }
      if (value > 0 && static_cast<std::size_t>(value) > farthest[kind].index) {
        farthest[kind] = {kind, static_cast<std::size_t>(value), line};
      }
      has_coordinate = has_coordinate || kind == 1;
    }
    return has_coordinate;
  };
  each_line(text, [&](std::string_view content, std::size_t line) {
    Words words(content);
    const std::string_view keyword = words.next();
    if (keyword == "v") {
      ++counted[0].count;
    } else if (keyword == "vn") {
      ++counted[2].count;
    } else if (keyword == "vt") {
      ++counted[1].count;
      if (!words.more()) {
        refuse(who, line, "vt: found nothing, allowed: one to three finite numbers");
      }
      while (words.more()) {
        (void)finite(who, line, "vt", words.next());
      }
    } else if (keyword == "f" || keyword == "fo") {
      bool bare = false;
      while (words.more()) {
        bare = !corner(words.next(), line) || bare;
      }
      if (bare) {
        mesh.bare_faces.try_emplace(material, line);
      }
    } else if (keyword == "usemtl") {
      material = words.rest();
    } else if (keyword == "mtllib" && words.more()) {
      mesh.libraries.push_back({std::string(words.rest()), line});
    }
  });
  for (const Named& named : farthest) {
    if (named.index > counted[named.kind].count) {
      out_of_range(named.line, named.kind, std::to_string(named.index));
    }
  }
  return mesh;
}

namespace {

/// Reads one to three numbers after -o, -s or -t; omitted ones keep their values.
void take_numbers(Words& words, std::array<double, 2>* values, const std::string& who,
                  std::size_t line, std::string_view option) {
  std::size_t count = 0;
  for (; count < 3 && words.more() && number(words.peek()); ++count) {
    const double value = finite(who, line, option, words.next());
    if (values != nullptr && count < values->size()) {
      (*values)[count] = value;
    }
  }
  if (count == 0) {
    refuse(who, line,
           fmt::format("{}: found '{}', allowed: one to three numbers", option, words.peek()));
  }
}

/// Words that follow options without effect here.
const std::map<std::string_view, std::size_t>& idle_options() {
  static const std::map<std::string_view, std::size_t> kWords{
      {"-blendu", 1}, {"-blendv", 1}, {"-cc", 1},   {"-mm", 2},      {"-texres", 1},
      {"-bm", 1},     {"-boost", 1},  {"-type", 1}, {"-imfchan", 1}, {"-colorspace", 1}};
  return kWords;
}

WavefrontMap read_map(Words words, const std::string& who, std::size_t line,
                      std::vector<std::string>& notes) {
  WavefrontMap map;
  map.line = line;
  const auto ignored = [&](std::string_view option) {
    notes.push_back(fmt::format("{}:{}: map_Kd: '{}' has no effect; -s, -o and -clamp have", who,
                                line, option));
  };
  while (words.more() && words.peek().front() == '-') {
    const std::string_view option = words.next();
    if (option == "-s") {
      take_numbers(words, &map.scale, who, line, option);
    } else if (option == "-o") {
      take_numbers(words, &map.offset, who, line, option);
    } else if (option == "-t") {
      take_numbers(words, nullptr, who, line, option);
      ignored(option);
    } else if (option == "-clamp") {
      const std::string_view word = words.next();
      if (word != "on" && word != "off") {
        refuse(who, line, fmt::format("-clamp: found '{}', allowed: on, off", word));
      }
      map.clamp = word == "on";
    } else if (const auto idle = idle_options().find(option); idle != idle_options().end()) {
      for (std::size_t i = 0; i < idle->second; ++i) {
        (void)words.next();
      }
      ignored(option);
    } else {
      refuse(who, line,
             fmt::format("map_Kd: found option '{}', allowed: -s, -o, -clamp; without effect: -t, "
                         "-blendu, -blendv, -boost, -bm, -cc, -colorspace, -imfchan, -mm, -texres, "
                         "-type",
                         option));
    }
  }
  map.file = words.rest();
  std::ranges::replace(map.file, '\\', '/');
  if (map.file.empty()) {
    refuse(who, line, "map_Kd: found no file, allowed: options, then the name of a picture");
  }
  return map;
}

std::array<double, 3> read_colour(Words words, const std::string& who, std::size_t line) {
  std::array<double, 3> colour{};
  std::size_t count = 0;
  for (; count < 3 && words.more(); ++count) {
    colour[count] = finite(who, line, "Kd", words.peek());
    if (colour[count] < 0.0 || colour[count] > 1.0) {
      refuse(who, line, fmt::format("Kd: found {}, allowed: 0 to 1", words.peek()));
    }
    (void)words.next();
  }
  // One number is all three.
  if (count == 1) {
    colour[1] = colour[2] = colour[0];
  } else if (count != 3 || words.more()) {
    refuse(who, line, "Kd: allowed: red, green and blue from 0 to 1, or one number for all");
  }
  return colour;
}

}  // namespace

std::vector<WavefrontMaterial> read_wavefront_materials(std::string_view text,
                                                        const std::string& who,
                                                        std::vector<std::string>& notes) {
  std::vector<WavefrontMaterial> materials;
  std::set<std::string, std::less<>> known;
  bool idle = false;  // in a material that was there already
  each_line(text, [&](std::string_view content, std::size_t line) {
    Words words(content);
    const std::string_view keyword = words.next();
    if (keyword == "newmtl") {
      idle = !known.emplace(words.rest()).second;
      if (idle) {
        notes.push_back(fmt::format("{}:{}: material '{}' is there already; this one has no effect",
                                    who, line, words.rest()));
      } else {
        materials.push_back({std::string(words.rest()), line, {}, {}});
      }
      return;
    }
    const bool is_colour = keyword == "Kd";
    if (!is_colour && keyword != "map_Kd") {
      return;
    }
    if (materials.empty()) {
      refuse(who, line, fmt::format("{}: found before the first newmtl", keyword));
    }
    if (idle) {
      return;
    }
    if (is_colour) {
      materials.back().colour = read_colour(words, who, line);
    } else {
      materials.back().map = read_map(words, who, line, notes);
    }
  });
  return materials;
}

}  // namespace rigwire::hil
