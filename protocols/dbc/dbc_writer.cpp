#include "protocols/dbc/dbc_writer.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <map>
#include <set>
#include <vector>

#include "protocols/dbc/words.h"

namespace rigwire::protocols::dbc {
namespace {

using can::OwnedMessage;
using can::OwnedSignal;

/// Shortest text that reads back as the same number.
std::string number_text(double value) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  return {text.data(), end};
}

/// A string of the file, quotation marks included.
std::string quoted(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    result += c == '"' || c == '\\' || c < ' ' || c > '~' ? '\'' : c;
  }
  return result + '"';
}

/// A C identifier that no other of `taken` is; it is put there.
std::string unique_name(std::string_view wish, std::set<std::string>& taken) {
  std::string name;
  for (const char c : wish) {
    name += std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
  }
  if (name.empty() || std::isdigit(static_cast<unsigned char>(name[0])) != 0) {
    name.insert(0, 1, '_');
  }
  name.resize(std::min(name.size(), kLongestName));
  std::string candidate = name;
  for (unsigned n = 2; !taken.insert(candidate).second; ++n) {
    const std::string suffix = "_" + std::to_string(n);
    candidate = name.substr(0, kLongestName - suffix.size()) + suffix;
  }
  return candidate;
}

struct NamedSignal {
  const OwnedSignal* layout;
  std::string name;
};
struct NamedMessage {
  const OwnedMessage* layout;
  std::string name;
  std::string sender;
  std::string id;
  std::vector<NamedSignal> signals;
};

/// Everything with the names it has in the file.
struct Names {
  explicit Names(const Bus& bus) {
    std::set<std::string> taken{std::string(kNobody)};
    std::map<std::string, int> uses;
    for (const OwnedMessage& message : bus.messages) {
      ++uses[message.name];
      if (!message.sender.empty() && !nodes.contains(message.sender)) {
        nodes[message.sender] = unique_name(message.sender, taken);
      }
    }
    std::set<std::string> message_names;
    std::set<std::string> ids;
    for (const OwnedMessage& message : bus.messages) {
      const std::string id =
          std::to_string(message.extended ? message.id | kExtendedFlag : message.id);
      if (!ids.insert(id).second) {
        continue;
      }
      const bool shared = uses[message.name] > 1 && !message.sender.empty();
      NamedMessage named;
      named.layout = &message;
      named.name =
          unique_name(shared ? message.name + "_" + message.sender : message.name, message_names);
      named.sender = message.sender.empty() ? std::string(kNobody) : nodes[message.sender];
      named.id = id;
      std::set<std::string> signal_names;
      for (const OwnedSignal& signal : message.signals) {
        named.signals.push_back({&signal, unique_name(signal.name, signal_names)});
      }
      messages.push_back(std::move(named));
    }
  }

  std::map<std::string, std::string> nodes;  ///< From device to node.
  std::vector<NamedMessage> messages;
};

/// What rounding of the units' sizes leaves is taken off.
double plain(double value) {
  constexpr int kDigits = 12;
  std::array<char, 32> text{};
  const auto written = std::to_chars(text.data(), text.data() + text.size(), value,
                                     std::chars_format::general, kDigits);
  double rounded = value;
  (void)std::from_chars(text.data(), written.ptr, rounded);
  return rounded;
}

/// A signal's numbers and unit as the file has them.
struct Physical {
  double scale;
  double offset;
  double lower;
  double upper;
  std::string unit;
};

Physical physical(const OwnedSignal& signal, Units units) {
  if (units == Units::si || signal.document_unit.empty()) {
    // The format has no infinity; 0 .. 0 is how it says "no limits".
    const bool limited = std::isfinite(signal.lower) && std::isfinite(signal.upper);
    return {signal.scale, signal.offset, limited ? signal.lower : 0.0, limited ? signal.upper : 0.0,
            signal.unit};
  }
  const double size = signal.document_size;
  const double ends[] = {plain(signal.lower / size), plain(signal.upper / size)};
  return {plain(signal.scale / size), plain(signal.offset / size), std::min(ends[0], ends[1]),
          std::max(ends[0], ends[1]), signal.document_unit};
}

bool is_multiplexor(const OwnedMessage& message, const OwnedSignal& signal) {
  const auto place = &signal - message.signals.data();
  return std::ranges::any_of(message.signals, [place](const OwnedSignal& other) {
    return other.multiplexor != can::kNoMultiplexor && other.multiplexor == place;
  });
}

/// " M" of a multiplexor, " m3" of a signal that is there at its value 3, " m3M" of both.
std::string multiplex_mark(const OwnedMessage& message, const OwnedSignal& signal) {
  std::string mark;
  if (signal.multiplexor != can::kNoMultiplexor && !signal.present_at.empty()) {
    mark = " m" + std::to_string(signal.present_at.front().first);
  }
  if (is_multiplexor(message, signal)) {
    mark += mark.empty() ? " M" : "M";
  }
  return mark;
}

/// The marks say all where one multiplexor has one value for each signal.
bool needs_extended_multiplexing(const OwnedMessage& message) {
  std::set<std::uint16_t> multiplexors;
  for (const OwnedSignal& signal : message.signals) {
    if (signal.multiplexor == can::kNoMultiplexor) {
      continue;
    }
    multiplexors.insert(signal.multiplexor);
    if (signal.present_at.size() != 1 || signal.present_at[0].first != signal.present_at[0].last) {
      return true;
    }
  }
  return multiplexors.size() > 1;
}

std::string multiplexing_text(const Names& names) {
  std::string text;
  for (const NamedMessage& message : names.messages) {
    if (!needs_extended_multiplexing(*message.layout)) {
      continue;
    }
    for (const auto& [signal, name] : message.signals) {
      if (signal->multiplexor >= message.signals.size()) {
        continue;
      }
      text += "SG_MUL_VAL_ " + message.id + ' ' + name + ' ' +
              message.signals[signal->multiplexor].name;
      for (const can::RawRange& range : signal->present_at) {
        text += &range == signal->present_at.data() ? " " : ", ";
        text += std::to_string(range.first) + '-' + std::to_string(range.last);
      }
      text += ";\n";
    }
  }
  return text;
}

std::string float_text(const Names& names) {
  std::string text;
  for (const NamedMessage& message : names.messages) {
    for (const auto& [signal, name] : message.signals) {
      if (signal->is_float) {
        text += "SIG_VALTYPE_ " + message.id + ' ' + name + " : " +
                (signal->width == 32 ? '1' : '2') + ";\n";
      }
    }
  }
  return text;
}

std::string messages_text(const Names& names, Units units) {
  std::string text;
  for (const NamedMessage& message : names.messages) {
    text += "BO_ " + message.id + ' ' + message.name + ": " +
            std::to_string(message.layout->length) + ' ' + message.sender + '\n';
    for (const auto& [signal, name] : message.signals) {
      const Physical of = physical(*signal, units);
      const bool little = signal->order == can::ByteOrder::little_endian;
      text += " SG_ " + name + multiplex_mark(*message.layout, *signal) + " : " +
              std::to_string(signal->bit) + '|' + std::to_string(signal->width) +
              (little ? "@1" : "@0") + (signal->is_signed ? '-' : '+') + " (" +
              number_text(of.scale) + ',' + number_text(of.offset) + ") [" + number_text(of.lower) +
              '|' + number_text(of.upper) + "] " + quoted(of.unit) + ' ' + std::string(kNobody) +
              '\n';
    }
    text += '\n';
  }
  return text;
}

std::string comments_text(const Names& names) {
  std::string text;
  for (const NamedMessage& message : names.messages) {
    if (!message.layout->text.empty()) {
      text += "CM_ BO_ " + message.id + ' ' + quoted(message.layout->text) + ";\n";
    }
    for (const auto& [signal, name] : message.signals) {
      if (!signal->text.empty()) {
        text += "CM_ SG_ " + message.id + ' ' + name + ' ' + quoted(signal->text) + ";\n";
      }
    }
  }
  return text;
}

constexpr std::string_view kAttributes =
    "BA_DEF_ \"BusType\" STRING ;\n"
    "BA_DEF_ \"ProtocolType\" STRING ;\n"
    "BA_DEF_ \"Baudrate\" INT 0 1000000;\n"
    "BA_DEF_ BU_ \"NmStationAddress\" INT 0 255;\n"
    "BA_DEF_ BO_ \"VFrameFormat\" ENUM \"StandardCAN\",\"ExtendedCAN\",\"reserved\",\"J1939PG\";\n"
    "BA_DEF_ BO_ \"GenMsgCycleTime\" INT 0 3600000;\n"
    "BA_DEF_ SG_ \"SPN\" INT 0 524287;\n"
    "BA_DEF_DEF_ \"BusType\" \"CAN\";\n"
    "BA_DEF_DEF_ \"ProtocolType\" \"\";\n"
    "BA_DEF_DEF_ \"Baudrate\" 250000;\n"
    "BA_DEF_DEF_ \"NmStationAddress\" 254;\n"
    "BA_DEF_DEF_ \"VFrameFormat\" \"StandardCAN\";\n"
    "BA_DEF_DEF_ \"GenMsgCycleTime\" 0;\n"
    "BA_DEF_DEF_ \"SPN\" 0;\n";

std::string attributes_text(const Bus& bus, const Names& names) {
  const bool j1939 = std::ranges::any_of(bus.messages, &OwnedMessage::j1939);
  std::string text(kAttributes);
  text += "BA_ \"BusType\" \"CAN\";\n";
  text += std::string("BA_ \"ProtocolType\" \"") + (j1939 ? "J1939" : "") + "\";\n";
  text += "BA_ \"Baudrate\" " + std::to_string(bus.bit_rate_bps) + ";\n";
  std::set<std::string> addressed;
  for (const NamedMessage& message : names.messages) {
    const OwnedMessage& layout = *message.layout;
    if (layout.j1939 && !layout.sender.empty() && addressed.insert(message.sender).second) {
      text += "BA_ \"NmStationAddress\" BU_ " + message.sender + ' ' +
              std::to_string(layout.id & 0xFFU) + ";\n";
    }
  }
  for (const NamedMessage& message : names.messages) {
    const OwnedMessage& layout = *message.layout;
    const int format = layout.j1939 ? 3 : layout.extended ? 1 : 0;
    text += "BA_ \"VFrameFormat\" BO_ " + message.id + ' ' + std::to_string(format) + ";\n";
    if (layout.period_ms != 0) {
      text += "BA_ \"GenMsgCycleTime\" BO_ " + message.id + ' ' + std::to_string(layout.period_ms) +
              ";\n";
    }
    for (const auto& [signal, name] : message.signals) {
      if (signal->spn != 0) {
        text += "BA_ \"SPN\" SG_ " + message.id + ' ' + name + ' ' + std::to_string(signal->spn) +
                ";\n";
      }
    }
  }
  return text;
}

std::string values_text(const Names& names) {
  std::string text;
  for (const NamedMessage& message : names.messages) {
    for (const auto& [signal, name] : message.signals) {
      if (signal->values.empty()) {
        continue;
      }
      text += "VAL_ " + message.id + ' ' + name;
      for (const can::OwnedNamedValue& value : signal->values) {
        text += ' ' + std::to_string(value.raw) + ' ' + quoted(value.text);
      }
      text += " ;\n";
    }
  }
  return text;
}

}  // namespace

std::string write(const Bus& bus, Units units) {
  const Names names(bus);
  std::string text = "VERSION \"\"\n\n\nNS_ :\n\nBS_:\n\nBU_:";
  for (const auto& [device, node] : names.nodes) {
    text += ' ' + node;
  }
  text += "\n\n\n" + messages_text(names, units) + '\n';
  text += "CM_ " + quoted("Bus " + std::string(bus.name) + ", written by Rigwire") + ";\n";
  text += comments_text(names) + attributes_text(bus, names) + values_text(names) +
          float_text(names) + multiplexing_text(names);
  return text;
}

}  // namespace rigwire::protocols::dbc
