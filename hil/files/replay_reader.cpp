#include "hil/files/replay_reader.h"

#include <arpa/inet.h>
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "fields/constants.h"
#include "hil/configuration/outside_file.h"
#include "hil/configuration/plain_text.h"
#include "hil/configuration/suggest.h"
#include "hil/files/capture_file.h"
#include "protocols/can/frame_text.h"
#include "protocols/gnss_stream/splitter.h"
#include "protocols/gnss_stream/time.h"
#include "protocols/pcapng/link_packet.h"

namespace rigwire::hil {
namespace {

namespace fs = std::filesystem;
namespace gnss_stream = protocols::gnss_stream;
namespace pcapng = protocols::pcapng;

/// An OutsideFile or LineReader of the file.
template <class File>
File open_replayed(const fs::path& path, FileLimit limit) {
  try {
    return File(path, limit);
  } catch (const FileRefused& refused) {
    throw drivers::EndpointError(fmt::format("source.file: {}", refused.what()));
  }
}

/// "1780300800.201000" in nanoseconds.
std::optional<std::int64_t> parse_instant(std::string_view text) {
  const std::size_t point = std::min(text.find('.'), text.size());
  std::int64_t seconds = 0;
  const char* const begin = text.data();
  if (std::from_chars(begin, begin + point, seconds).ptr != begin + point || point == 0 ||
      seconds < 0 || seconds > 9'000'000'000) {
    return std::nullopt;
  }
  std::int64_t fraction = 0;
  std::int64_t unit = kSecond_ns;
  for (std::size_t i = point + 1; i < text.size(); ++i) {
    if (text[i] < '0' || text[i] > '9' || unit == 1) {
      return std::nullopt;
    }
    unit /= 10;
    fraction += unit * (text[i] - '0');
  }
  return seconds * kSecond_ns + fraction;
}

class CaptureReader final : public ReplayReader {
 public:
  explicit CaptureReader(const ReplaySourceSettings& settings)
      : settings_(settings), file_(settings.file) {
    in_addr address{};
    if (!settings.from_address.empty() &&
        ::inet_pton(AF_INET, settings.from_address.c_str(), &address) != 1) {
      throw std::invalid_argument(
          fmt::format("source.from_address: no IPv4 address, found \"{}\"", settings.from_address));
    }
    from_address_ = ntohl(address.s_addr);
  }

  bool next(std::int64_t& at_ns, ReplayedUnit& unit) override {
    while (const CapturedPacket* const captured = file_.next()) {
      const auto& [packet, interface] = *captured;
      if (!settings_.wire.empty() && interface.name != settings_.wire) {
        names_.insert(interface.name);
        continue;
      }
      if (!has_wanted_direction(packet)) {
        names_.insert(interface.name);
        count_note("packet of the other direction (source.direction)");
        continue;
      }
      if (!take(packet, interface.link, unit)) {
        continue;
      }
      look_at_interface(packet.interface, interface);
      at_ns = static_cast<std::int64_t>(packet.time_ns);
      return true;
    }
    if (const std::uint64_t count = file_.without_time(); count > without_time_) {
      count_note("packet without a time", count - without_time_);
      without_time_ = count;
    }
    if (!settings_.wire.empty() && !interface_) {
      std::string names;
      for (const std::string& name : names_) {
        names += (names.empty() ? "" : ", ") + name;
      }
      if (!names_.contains(settings_.wire)) {
        throw std::invalid_argument(
            fmt::format("source.wire: {} has no such wire, found \"{}\", allowed {}",
                        settings_.file, settings_.wire, names.empty() ? "none" : names));
      }
    }
    return false;
  }
  [[nodiscard]] ReplayedKind kind() const override { return kind_; }
  [[nodiscard]] bool truncated() const override { return file_.truncated(); }

 private:
  /// In our own recordings inbound packets came from a client. Another recorder was at the client,
  /// or its place is unknown: there the device's own packets may be either.
  [[nodiscard]] bool has_wanted_direction(const pcapng::Packet& packet) const {
    using enum ReplayedDirection;
    switch (settings_.direction) {
      case inbound:
        return packet.direction == pcapng::Direction::inbound;
      case outbound:
        return packet.direction == pcapng::Direction::outbound;
      case both:
        return true;
      case automatic:
        break;
    }
    return packet.direction != pcapng::Direction::inbound ||
           !file_.application().starts_with("rigwire");
  }

  bool take(const pcapng::Packet& packet, pcapng::LinkType link, ReplayedUnit& unit) {
    if (packet.original_length > packet.bytes.size()) {
      count_note("packet that the recorder cut");
      return false;
    }
    if (link == pcapng::LinkType::socketcan) {
      const auto frame = pcapng::can_frame(packet.bytes);
      if (!frame.ok()) {
        count_note(pcapng::is_error_frame(packet.bytes) ? "error frame"
                   : frame.malformed() && packet.bytes.size() > 5 && packet.bytes[4] > 8
                       ? "CAN FD frame"
                       : "damaged CAN frame");
      }
      if (frame.ok()) {
        unit.frame = *frame;
        unit.bytes.assign(frame->payload().begin(), frame->payload().end());
        kind_ = ReplayedKind::frames;
      }
      return frame.ok();
    }
    if (link == pcapng::LinkType::rtac_serial) {
      const auto bytes = pcapng::serial_bytes(packet.bytes);
      unit.bytes.assign(bytes.begin(), bytes.end());
      kind_ = ReplayedKind::bytes;
      return !bytes.empty();
    }
    const auto datagram = pcapng::udp_packet(packet.bytes, link);
    if (!datagram.ok()) {
      count_note(datagram.malformed()
                     ? "packet that is no UDP: " + std::string(datagram.fault().reason)
                     : "damaged packet");
      return false;
    }
    if ((!settings_.from_address.empty() && datagram->from.address != from_address_) ||
        (settings_.from_port != 0 && datagram->from.port != settings_.from_port) ||
        (settings_.to_port != 0 && datagram->to.port != settings_.to_port)) {
      return false;
    }
    unit.from = {datagram->from.address, datagram->from.port};
    unit.to = {datagram->to.address, datagram->to.port};
    unit.bytes.assign(datagram->bytes.begin(), datagram->bytes.end());
    kind_ = ReplayedKind::datagrams;
    return true;
  }

  /// One wire only, whatever others have its name.
  void look_at_interface(std::uint32_t number, const pcapng::Interface& interface) {
    if (interface_ && *interface_ != number) {
      throw std::invalid_argument(fmt::format(
          "source.wire: {} has several wires that fit, found \"{}\" and \"{}\", allowed one: name "
          "it{}",
          settings_.file, name_, interface.name,
          name_ == interface.name ? ", or cut the file: both have one name" : ""));
    }
    interface_ = number;
    name_ = interface.name;
  }

  const ReplaySourceSettings settings_;
  CaptureFile file_;
  std::uint32_t from_address_ = 0;
  std::optional<std::uint32_t> interface_;
  std::string name_;
  std::set<std::string> names_;  ///< Names of the interfaces that were passed over.
  std::uint64_t without_time_ = 0;
  ReplayedKind kind_ = ReplayedKind::datagrams;
};

/// "(1780300800.201000) can 18FEF102#ABCD R"
class CandumpReader final : public ReplayReader {
 public:
  explicit CandumpReader(const ReplaySourceSettings& settings)
      : settings_(settings), file_(open_replayed<LineReader>(settings.file, kReplayFile)) {}

  bool next(std::int64_t& at_ns, ReplayedUnit& unit) override {
    for (std::string line; file_.next(line);) {
      ++number_;
      const bool whole = file_.whole();
      if (!line.empty() && line.back() == '\r') {
        line.pop_back();
      }
      if (line.empty() || line.front() == '#') {
        continue;
      }
      if (line.ends_with(" T")) {
        count_note("frame that the recorder's own host sent (T)");
        continue;
      }
      const std::size_t close = line.find(") ");
      const std::size_t name = close == std::string::npos ? close : line.find(' ', close + 2);
      const auto at = line.front() == '(' && name != std::string::npos
                          ? parse_instant(std::string_view(line).substr(1, close - 1))
                          : std::nullopt;
      if (!at) {
        if (!whole) {
          truncated_ = true;
          return false;
        }
        refuse_replayed(settings_.file, fmt::format("line {}: no line of candump -L", number_));
      }
      const std::string bus = line.substr(close + 2, name - close - 2);
      if (!settings_.wire.empty() && bus != settings_.wire) {
        names_.insert(bus);
        continue;
      }
      const std::string text = line.substr(name + 1, line.find(' ', name + 1) - name - 1);
      const auto frame = protocols::can::parse_frame_text(text);
      if (!frame) {
        count_note(kind_of_line(text));
        continue;
      }
      if (!bus_.empty() && bus != bus_) {
        throw std::invalid_argument(fmt::format(
            "source.wire: {} has several wires, found \"{}\" and \"{}\", allowed one: name it",
            settings_.file, printable(bus_), printable(bus)));
      }
      bus_ = bus;
      unit.frame = *frame;
      unit.bytes.assign(frame->payload().begin(), frame->payload().end());
      at_ns = *at;
      return true;
    }
    if (bus_.empty() && !settings_.wire.empty() && !names_.empty()) {
      throw std::invalid_argument(fmt::format(
          "source.wire: {} has no such wire, found \"{}\", allowed {}", settings_.file,
          settings_.wire, join_words(std::vector<std::string>(names_.begin(), names_.end()))));
    }
    return false;
  }
  [[nodiscard]] ReplayedKind kind() const override { return ReplayedKind::frames; }
  [[nodiscard]] bool truncated() const override { return truncated_; }

 private:
  /// Returns what a text behind the interface's name is that is no classic frame.
  static std::string kind_of_line(std::string_view text) {
    constexpr std::uint32_t kErrorFlag = 0x2000'0000;
    const std::size_t mark = std::min(text.find('#'), text.size());
    std::uint32_t id = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + mark, id, 16);
    const bool is_id = error == std::errc() && end == text.data() + mark;
    if (is_id && mark == 8 && (id & kErrorFlag) != 0) {
      return "error frame";
    }
    return is_id && text.substr(mark).starts_with("##") ? "CAN FD frame" : "line that is no frame";
  }

  const ReplaySourceSettings settings_;
  LineReader file_;
  std::set<std::string> names_;  ///< Names of the interfaces that were passed over.
  std::string bus_;              ///< Interface that is played.
  std::size_t number_ = 0;
  bool truncated_ = false;
};

/// Bytes of a serial line beside the index of its recording.
class IndexedReader final : public ReplayReader {
 public:
  IndexedReader(const ReplaySourceSettings& settings, const fs::path& index)
      : index_(open_replayed<LineReader>(index, kReplayFile)),
        bytes_(open_replayed<OutsideFile>(settings.file, kReplayFile)),
        index_path_(index) {}

  bool next(std::int64_t& at_ns, ReplayedUnit& unit) override {
    constexpr std::size_t kLongest = 16 * 1024 * 1024;
    for (std::string line; index_.next(line);) {
      ++number_;
      if (line.empty() || line.front() == '#' || line.find(" < ") != std::string::npos) {
        continue;
      }
      const std::size_t mark = line.find(" > ");
      const auto at = mark == std::string::npos
                          ? std::nullopt
                          : parse_instant(std::string_view(line).substr(0, mark));
      std::uint64_t offset = 0;
      std::size_t length = 0;
      const char* const end = line.data() + line.size();
      const auto first = at ? std::from_chars(line.data() + mark + 3, end, offset)
                            : std::from_chars_result{end, std::errc::invalid_argument};
      if (!at || first.ptr == end || std::from_chars(first.ptr + 1, end, length).ptr != end ||
          length > kLongest) {
        if (!index_.whole()) {
          truncated_ = true;
          return false;
        }
        refuse_replayed(index_path_.string(),
                        fmt::format("line {}: allowed SECONDS > OFFSET LENGTH", number_));
      }
      unit.bytes.resize(length);
      bytes_.seek(offset);
      if (bytes_.read(unit.bytes) != length) {
        truncated_ = true;
        return false;
      }
      at_ns = *at;
      return true;
    }
    return false;
  }
  [[nodiscard]] ReplayedKind kind() const override { return ReplayedKind::bytes; }
  [[nodiscard]] bool truncated() const override { return truncated_; }

 private:
  LineReader index_;
  OutsideFile bytes_;
  fs::path index_path_;
  std::size_t number_ = 0;
  bool truncated_ = false;
};

/// What a receiver sent, without instants: its messages give them. What comes before the first time
/// ends with that epoch's beginning, at the line's speed.
class LogReader final : public ReplayReader {
 public:
  explicit LogReader(const ReplaySourceSettings& settings)
      : byte_ns_(10 * kSecond_ns / settings.baud) {
    {
      const std::string content = open_replayed<OutsideFile>(settings.file, kLogFile).read_rest();
      bytes_.assign(content.begin(), content.end());
    }
    gnss_stream::LeapSeconds leap_seconds;
    gnss_stream::Splitter splitter;
    const auto add = [&](std::span<const std::uint8_t> bytes,
                         const gnss_stream::Splitter::Content& content) {
      const auto time = time_in(content);
      if (time) {
        leap_seconds.take(*time);
      }
      if (std::holds_alternative<std::monostate>(content)) {
        add_unknown(bytes);
      } else {
        pieces_.push_back({bytes.size(), time});
      }
    };
    splitter.take(bytes_, add);
    splitter.flush(add);
    clock_ = gnss_stream::StreamClock(leap_seconds.value());
    const auto first =
        std::ranges::find_if(pieces_, [](const Piece& piece) { return piece.time.has_value(); });
    if (first == pieces_.end()) {
      refuse_replayed(
          settings.file,
          "it has no times: found no capture, no candump log, no index beside it, no "
          "time in an intact GGA, RMC, GLL, GNS, GBS, GST or ZDA or in UBX NAV or RXM-RAWX");
    }
    std::size_t before = 0;
    for (auto piece = pieces_.begin(); piece != first; ++piece) {
      before += piece->size;
    }
    epoch_ns_ = clock_.take(*first->time);
    left_ns_ = epoch_ns_ - static_cast<std::int64_t>(before) * byte_ns_;
    first_ = static_cast<std::size_t>(first - pieces_.begin());
  }

  bool next(std::int64_t& at_ns, ReplayedUnit& unit) override {
    if (piece_ == pieces_.size()) {
      return false;
    }
    const Piece& piece = pieces_[piece_];
    if (piece.time && piece_ > first_) {
      epoch_ns_ = std::max(epoch_ns_, clock_.take(*piece.time));
    }
    if (piece_ >= first_) {
      left_ns_ = std::max(left_ns_, epoch_ns_);
    }
    left_ns_ += static_cast<std::int64_t>(piece.size) * byte_ns_;
    const auto message = std::span<const std::uint8_t>(bytes_).subspan(at_, piece.size);
    unit.bytes.assign(message.begin(), message.end());
    at_ += piece.size;
    ++piece_;
    at_ns = left_ns_;
    return true;
  }
  [[nodiscard]] ReplayedKind kind() const override { return ReplayedKind::bytes; }
  [[nodiscard]] bool truncated() const override { return false; }
  [[nodiscard]] std::int64_t transmission_ns(const ReplayedUnit& unit) const override {
    return static_cast<std::int64_t>(unit.bytes.size()) * byte_ns_;
  }

 private:
  struct Piece {
    std::size_t size;
    std::optional<gnss_stream::MessageTime> time;
  };

  static std::optional<gnss_stream::MessageTime> time_in(
      const gnss_stream::Splitter::Content& content) {
    if (const auto* const frame = std::get_if<protocols::ubx::FrameView>(&content)) {
      return gnss_stream::time_of(*frame);
    }
    const auto* const sentence = std::get_if<protocols::nmea::SentenceView>(&content);
    return sentence == nullptr ? std::nullopt : gnss_stream::time_of(*sentence);
  }

  /// Bytes of no message are played as they are: by line, or in pieces.
  void add_unknown(std::span<const std::uint8_t> bytes) {
    constexpr std::size_t kLongest = 256;
    count_note("byte of no intact message, played as it is", bytes.size());
    while (!bytes.empty()) {
      const auto line = std::ranges::find(bytes, std::uint8_t{'\n'});
      const auto size = std::min<std::size_t>(
          kLongest, static_cast<std::size_t>(line - bytes.begin()) + (line == bytes.end() ? 0 : 1));
      pieces_.push_back({size, std::nullopt});
      bytes = bytes.subspan(size);
    }
  }

  std::vector<std::uint8_t> bytes_;
  std::vector<Piece> pieces_;
  gnss_stream::StreamClock clock_{0};
  std::int64_t byte_ns_;
  std::size_t first_ = 0;  ///< Piece that has a time.
  std::size_t piece_ = 0;
  std::size_t at_ = 0;
  std::int64_t epoch_ns_ = 0;
  std::int64_t left_ns_ = 0;
};

}  // namespace

void refuse_replayed(const std::string& file, const std::string& why) {
  throw std::invalid_argument(fmt::format("source.file: {}: {}", file, why));
}

std::unique_ptr<ReplayReader> open_replay_reader(const ReplaySourceSettings& settings) {
  std::array<std::uint8_t, 1> first{};
  if (open_replayed<OutsideFile>(settings.file, kReplayFile).read(first) == 0) {
    refuse_replayed(settings.file, "the file is empty");
  }
  if (CaptureFile::is_one(settings.file)) {
    return std::make_unique<CaptureReader>(settings);
  }
  if (first.front() == '(') {
    return std::make_unique<CandumpReader>(settings);
  }
  const fs::path index = fs::path(settings.file).replace_extension(".index");
  std::error_code error;
  if (index != fs::path(settings.file) && fs::exists(fs::symlink_status(index, error))) {
    return std::make_unique<IndexedReader>(settings, index);
  }
  return std::make_unique<LogReader>(settings);
}

void visit(fields::Visitor& v, ReplaySourceSettings& p) {
  using fields::IntegerRule;
  constexpr fields::DurationRule kSpan{0, 1'000'000'000'000'000};
  v.required("file");
  v.file("file", p.file, fields::FileKind::replay,
         "Capture (pcap, pcapng), candump log, .bytes of a recording, or log of NMEA or UBX.");
  v.choice("direction", p.direction, kReplayedDirections, "For captures that record directions.");
  v.text("wire", p.wire, "Name of the interface in a file with several; empty = the only one.");
  v.text("from_address", p.from_address, "Datagrams from there only; empty = from anywhere.");
  v.integer("from_port", p.from_port, IntegerRule{0, 65535}, "Datagrams from that port; 0 = any.");
  v.integer("to_port", p.to_port, IntegerRule{0, 65535}, "Datagrams to that port; 0 = any.");
  v.integer("baud", p.baud, IntegerRule{300, 10'000'000},
            "Line speed within an epoch, of a log without instants, bit/s.");
  v.duration("start", p.start, kSpan, "Where the piece begins, from the file's zero.");
  v.duration("end", p.end, kSpan, "Where it ends; 0 = with the file.");
  v.duration("offset", p.offset, kSpan, "From the start of the run to the piece's.");
  v.number("speed", p.speed, fields::in("1").at_least(0.001).at_most(1000),
           "How much faster than it was.");
  v.boolean("loop", p.loop, "Begins again at its end.");
  v.choice("gaps", p.gaps, kReplayedGaps, "Spans without anything.");
  v.choice("align", p.align, kReplayedAlignments, "What the run's start is in the file.");
  v.only_if(p.align == ReplayedAlignment::zero, "align", "align: zero", [&p](fields::Visitor& w) {
    w.integer("zero", p.zero_unix_ns, IntegerRule{0},
              "The file's zero, ns since 1970; 0 = its first unit.");
  });
  v.check(p.end == Duration{0} || p.end > p.start, "end", "not behind the start");
}

}  // namespace rigwire::hil
