#include "hil/record/recording_comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <span>
#include <utility>

#include "hil/files/capture_file.h"
#include "hil/record/byte_place.h"
#include "protocols/pcapng/link_packet.h"

namespace rigwire::hil {
namespace {

namespace fs = std::filesystem;
namespace pcapng = protocols::pcapng;
using PlainJson = nlohmann::json;

/// Bytes of a serial line before and after a difference in which its message is searched.
constexpr std::size_t kContext = 4096;

/// How many units the recorder says found no room on the wire (hil/record/recording_writer.cpp).
std::uint64_t without_room(std::string_view comment) {
  const std::size_t words = comment.find(" before this found no room");
  if (words == std::string_view::npos) {
    return 0;
  }
  const std::size_t from = comment.substr(0, words).find_last_of(' ');
  const std::string_view number =
      comment.substr(from == std::string_view::npos ? 0 : from + 1, words);
  std::uint64_t count = 0;
  std::from_chars(number.data(), number.data() + number.size(), count);
  return count;
}

/// What is compared of one packet.
struct Unit {
  SimTime at{};
  std::vector<std::uint8_t> bytes;
  std::uint64_t missing_before = 0;
};

/// One direction of one wire.
class UnitReader {
 public:
  UnitReader(const fs::path& folder, const RecordingContents& contents, const RecordedWire& wire,
             bool inbound)
      : file_(folder / "wires" / (wire.name + ".pcapng"), kRecordingFile),
        start_unix_ns_(contents.run.start_unix_ns),
        kind_(wire.kind),
        inbound_(inbound) {}

  std::optional<Unit> next() {
    std::uint64_t missing = 0;
    while (const CapturedPacket* const captured = file_.next()) {
      const pcapng::Packet& packet = captured->packet;
      missing += packet.lost_before + without_room(packet.comment);
      if ((packet.direction == pcapng::Direction::inbound) != inbound_) {
        continue;
      }
      const std::span<const std::uint8_t> bytes = content(packet.bytes);
      return Unit{SimTime{Duration{static_cast<std::int64_t>(packet.time_ns) - start_unix_ns_}},
                  {bytes.begin(), bytes.end()},
                  missing};
    }
    return std::nullopt;
  }

 private:
  [[nodiscard]] std::span<const std::uint8_t> content(std::span<const std::uint8_t> packet) const {
    if (kind_ == WireKind::serial) {
      return pcapng::serial_bytes(packet);
    }
    if (kind_ == WireKind::ethernet) {
      if (const auto datagram = pcapng::udp_packet(packet); datagram.ok()) {
        return datagram->bytes;
      }
      if (const auto segment = pcapng::tcp_packet(packet); segment.ok()) {
        return segment->bytes;
      }
    }
    return packet;
  }

  CaptureFile file_;
  std::int64_t start_unix_ns_;
  WireKind kind_;
  bool inbound_;
};

std::string in_seconds(SimTime at) {
  return fmt::format("{:.9f} s", to_seconds(at));
}

class StreamComparison {
 public:
  StreamComparison(const RecordedWire& wire, const MessagesOfBus& messages)
      : wire_(wire), messages_(messages) {}

  void compare(UnitReader recorded, UnitReader found, SimTime end, ComparedStream& result) {
    std::optional<Unit> right = found.next();
    for (std::optional<Unit> left = recorded.next(); left && left->at <= end;
         left = recorded.next()) {
      // What the first recording reports as missing may be in the second.
      for (std::uint64_t i = 0; i < left->missing_before && right &&
                                (right->at != left->at || right->bytes != left->bytes);
           ++i) {
        right = found.next();
        ++result.passed_over;
      }
      if (!right || right->at != left->at || right->bytes != left->bytes) {
        result.difference = describe(*left, right, recorded);
        return;
      }
      remember(left->bytes);
      ++result.units;
      last_ = left->at;
      right = found.next();
    }
    // At the last instant of all a run that was stopped may have been cut short.
    if (right && right->at < end) {
      result.difference = {
          right->at, fmt::format("{} bytes are there, and nothing recorded", right->bytes.size())};
    }
  }

 private:
  void remember(std::span<const std::uint8_t> bytes) {
    if (wire_.kind == WireKind::serial) {
      before_.insert(before_.end(), bytes.begin(), bytes.end());
      if (before_.size() > 2 * kContext) {
        before_.erase(before_.begin(), before_.end() - kContext);
      }
    }
  }

  RecordingDifference describe(const Unit& left, const std::optional<Unit>& right,
                               UnitReader& recorded) {
    if (!right) {
      return {left.at, fmt::format("nothing, recorded {} bytes", left.bytes.size())};
    }
    const auto [l, r] = std::ranges::mismatch(left.bytes, right->bytes);
    const auto at = static_cast<std::size_t>(l - left.bytes.begin());
    const std::string time = right->at == left.at
                                 ? ""
                                 : fmt::format(", due at {}, recorded at {}", in_seconds(right->at),
                                               in_seconds(left.at));
    if (at == left.bytes.size() && at == right->bytes.size()) {
      return {left.at, fmt::format("the same {} bytes{}", at, time)};
    }
    const std::string place = place_of(left, *right, at, recorded);
    const auto byte = [at](const std::vector<std::uint8_t>& bytes) {
      return at < bytes.size() ? fmt::format("{:02X}", bytes[at]) : std::string("its end");
    };
    return {left.at, fmt::format("byte {} of {}{}: found {}, recorded {}{}", at, left.bytes.size(),
                                 place.empty() ? "" : " (" + place + ")", byte(right->bytes),
                                 byte(left.bytes), time)};
  }

  std::string place_of(const Unit& left, const Unit& right, std::size_t at, UnitReader& recorded) {
    switch (wire_.kind) {
      case WireKind::can:
        return can_place(left.bytes, right.bytes, at, messages_(wire_.name));
      case WireKind::ethernet:
        return datagram_place(left.bytes, at);
      case WireKind::serial:
        break;
    }
    const std::size_t place = before_.size() + at;
    before_.insert(before_.end(), left.bytes.begin(), left.bytes.end());
    while (before_.size() < place + kContext) {
      const std::optional<Unit> next = recorded.next();
      if (!next) {
        break;
      }
      before_.insert(before_.end(), next->bytes.begin(), next->bytes.end());
    }
    return serial_place(before_, place);
  }

  const RecordedWire& wire_;
  const MessagesOfBus& messages_;
  std::vector<std::uint8_t> before_;
  SimTime last_{};
};

constexpr std::array<std::string_view, 3> kComparedTopics{"/truth", "/tf", "/antenna"};

/// The key path at which two values differ first; empty: they are equal.
std::string different_key(const PlainJson& left, const PlainJson& right, const std::string& path,
                          std::string& values) {
  if (left.is_object() && right.is_object()) {
    for (const auto& [key, value] : left.items()) {
      const PlainJson other = right.contains(key) ? right.at(key) : PlainJson();
      std::string below =
          different_key(value, other, path + (path.empty() ? "" : ".") + key, values);
      if (!below.empty()) {
        return below;
      }
    }
  } else if (left.is_array() && right.is_array() && left.size() == right.size()) {
    for (std::size_t i = 0; i < left.size(); ++i) {
      std::string below = different_key(left[i], right[i], path + "." + std::to_string(i), values);
      if (!below.empty()) {
        return below;
      }
    }
  }
  if (left == right) {
    return {};
  }
  values = fmt::format("found {}, recorded {}", right.dump(), left.dump());
  return path.empty() ? "." : path;
}

/// Compares the truth of both: of the second a number for each message is kept, and the one that
/// differs is read again.
void compare_truth(const fs::path& recorded, const fs::path& found, SimTime end,
                   std::vector<ComparedStream>& results) {
  struct Kept {
    SimTime at{};
    std::size_t hash = 0;
  };
  std::array<std::vector<Kept>, kComparedTopics.size()> kept;
  const std::hash<std::string_view> hash;
  each_message(found, [&](TruthTrack track, SimTime at, std::string_view text) {
    const auto topic = static_cast<std::size_t>(track);
    if (topic < kept.size()) {
      kept[topic].push_back({at, hash(text)});
    }
  });
  struct First {
    SimTime at{};
    std::string text;
  };
  std::array<ComparedStream, kComparedTopics.size()> streams;
  std::array<std::optional<First>, kComparedTopics.size()> firsts;
  each_message(recorded, [&](TruthTrack track, SimTime at, std::string_view text) {
    const auto topic = static_cast<std::size_t>(track);
    if (topic >= kept.size() || firsts[topic] || at > end) {
      return;
    }
    const std::uint64_t index = streams[topic].units;
    if (index < kept[topic].size() && kept[topic][index].at == at &&
        kept[topic][index].hash == hash(text)) {
      ++streams[topic].units;
    } else {
      firsts[topic] = {at, std::string(text)};
    }
  });
  std::array<std::uint64_t, kComparedTopics.size()> counts{};
  each_message(found, [&](TruthTrack track, SimTime at, std::string_view text) {
    const auto topic = static_cast<std::size_t>(track);
    if (topic >= kept.size() || counts[topic]++ != streams[topic].units || !firsts[topic]) {
      return;
    }
    std::string values;
    const std::string key = different_key(PlainJson::parse(firsts[topic]->text, nullptr, false),
                                          PlainJson::parse(text, nullptr, false), "", values);
    streams[topic].difference = {
        firsts[topic]->at,
        key.empty() ? "recorded at another instant, " + in_seconds(at) : key + ": " + values};
  });
  for (std::size_t i = 0; i < streams.size(); ++i) {
    streams[i].wire = kComparedTopics[i];
    if (firsts[i] && !streams[i].difference) {
      streams[i].difference = {firsts[i]->at, "nothing, recorded a message"};
    }
    if (streams[i].units != 0 || streams[i].difference) {
      results.push_back(std::move(streams[i]));
    }
  }
}

}  // namespace

std::vector<ComparedStream> compare_recordings(const fs::path& recorded, const fs::path& found,
                                               SimTime end, const MessagesOfBus& messages) {
  const RecordingContents left = read_recording_description(recorded);
  const RecordingContents right = read_recording_description(found);
  std::vector<ComparedStream> results;
  for (const RecordingContents::Wire& wire : left.wires) {
    const auto other = std::ranges::find(right.wires, wire.about.name,
                                         [](const auto& row) { return row.about.name; });
    for (const bool inbound : {false, true}) {
      ComparedStream& result = results.emplace_back();
      result.wire = wire.about.name;
      result.of_clients = inbound;
      if (other == right.wires.end()) {
        result.difference = {kStart, "there is no such wire any more"};
        break;
      }
      StreamComparison(wire.about, messages)
          .compare({recorded, left, wire.about, inbound}, {found, right, other->about, inbound},
                   end, result);
    }
  }
  compare_truth(recorded, found, end, results);
  return results;
}

}  // namespace rigwire::hil
