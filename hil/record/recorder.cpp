#include "hil/record/recorder.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "fields/failure_text.h"
#include "hil/configuration/suggest.h"
#include "hil/executive/executive.h"
#include "hil/files/new_folder.h"
#include "hil/record/motion_line.h"
#include "hil/record/truth_tap.h"
#include "hil/wires/outlets.h"
#include "protocols/can/frame_text.h"
#include "protocols/pcapng/link_packet.h"

namespace rigwire::hil {
namespace {

namespace pcapng = protocols::pcapng;
using Json = nlohmann::ordered_json;

constexpr std::string_view kTruthName = "truth";
constexpr Duration kStatisticsPeriod = std::chrono::seconds{1};

/// Port written for a client whose port is unknown: the first of the ephemeral ports.
constexpr std::uint16_t kFirstClientPort = 49'152;
constexpr std::uint64_t kClientPorts = 16'384;
constexpr std::uint32_t kLoopback = 0x7F00'0001;

pcapng::IpEnd end_of(const drivers::IpEnd& end) {
  return {end.address, end.port};
}

}  // namespace

/// Turns what passes on one wire into packets of the recording.
class Recorder::Wire final : public WireTap {
 public:
  /// `further`: also receives what passes; may be null.
  Wire(Recorder& recorder, std::string name, WireTap* further)
      : recorder_(recorder), name_(std::move(name)), further_(further) {}

  /// Sets the wire's track in the recording that begins; nullopt: the wire is not recorded.
  void begin(std::optional<std::uint16_t> track) {
    track_ = track;
    conversations_.clear();
  }
  /// Records how the client has set its end.
  void tell_end(SimTime at) {
    if (end_) {
      put_end(at, *end_);
    }
  }

  void sent(SimTime at, const WirePiece& piece) override {
    pass_on([&](WireTap& tap) { tap.sent(at, piece); });
    put(at, 0, piece);
  }
  void carried(SimTime at, const WirePiece& piece) override {
    pass_on([&](WireTap& tap) { tap.carried(at, piece); });
    put(at, kInbound, piece);
  }
  void received(const WirePiece& piece) override;
  void lost(SimTime at) override {
    pass_on([&](WireTap& tap) { tap.lost(at); });
    write(kWireLost, at, {});
  }
  void note(SimTime at, std::string_view text) {
    write(kWireNote, at, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  }

  void put(SimTime at, std::uint8_t flags, const WirePiece& piece);

 private:
  struct Conversation {
    explicit Conversation(const StreamPiece& piece)
        : tcp({kLoopback,
               static_cast<std::uint16_t>(kFirstClientPort + piece.connection % kClientPorts)},
              end_of(piece.device)) {}
    pcapng::TcpConversation tcp;
    std::array<bool, 2> ended{};  ///< By side.
  };

  template <class Tell>
  void pass_on(const Tell& tell) {
    if (further_ != nullptr) {
      tell(*further_);
    }
  }
  [[nodiscard]] bool records(SimTime at) const { return track_ && recorder_.records(at); }
  void write(std::uint8_t flags, SimTime at, std::span<const std::uint8_t> bytes) {
    if (records(at)) {
      recorder_.put_told(*track_, flags, at, bytes);
    }
  }

  void lay_out(SimTime at, std::uint8_t flags, const SerialPiece& piece) {
    write(flags, at, piece.bytes);
  }
  void lay_out(SimTime at, std::uint8_t flags, const protocols::can::Frame& frame) {
    write(flags, at, pcapng::can_packet(frame));
  }
  void lay_out(SimTime at, std::uint8_t flags, const protocols::can::ErrorFrame& frame) {
    write(flags, at, pcapng::can_packet(frame));
  }
  void lay_out(SimTime at, std::uint8_t flags, const DatagramPiece& piece) {
    const bool inbound = (flags & kInbound) != 0;
    packet_.clear();
    pcapng::append_udp(packet_, end_of(inbound ? piece.client : piece.device),
                       end_of(inbound ? piece.device : piece.client), piece.bytes);
    write(flags, at, packet_);
  }
  void lay_out(SimTime at, std::uint8_t flags, const StreamPiece& piece);
  void lay_out(SimTime at, std::uint8_t /*flags*/, const drivers::LineClient& client) {
    put_end(at, end_text(client));
  }
  void lay_out(SimTime at, std::uint8_t /*flags*/, const drivers::CanClient& client) {
    put_end(at, end_text(client));
  }
  static std::string end_text(const drivers::LineClient& client) {
    return client.present ? fmt::format("open {}", client.baud) : "closed";
  }
  static std::string end_text(const drivers::CanClient& client) {
    return client.open ? fmt::format("open {}{}{}", client.bit_rate_bps,
                                     client.listen_only ? " listen_only" : "",
                                     client.one_shot ? " one_shot" : "")
                       : "closed";
  }
  void put_end(SimTime at, const std::string& text) {
    write(kWireEnd, at, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  }
  /// Keeps how the client has set its end, and reports when it comes or goes.
  void watch(SimTime now, const WirePiece& piece);
  void tell_client(SimTime now, bool came, std::string_view how);

  Recorder& recorder_;
  std::string name_;
  WireTap* further_;
  std::optional<std::uint16_t> track_;
  std::optional<std::string> end_;
  bool client_open_ = false;
  std::size_t connections_ = 0;
  pcapng::Bytes packet_;
  std::map<drivers::StreamServer::ConnectionId, Conversation> conversations_;
};

void Recorder::Wire::put(SimTime at, std::uint8_t flags, const WirePiece& piece) {
  std::visit([&](const auto& kind) { lay_out(at, flags, kind); }, piece);
}

void Recorder::Wire::tell_client(SimTime now, bool came, std::string_view how) {
  recorder_.events_.tell(now, came ? EventKind::client_came : EventKind::client_left,
                         LogLevel::info, name_,
                         fmt::format("a client {} {}{}", came ? "opens" : "leaves", name_, how));
}

void Recorder::Wire::watch(SimTime now, const WirePiece& piece) {
  const auto ends = [&](bool open, std::string text, std::string_view unit) {
    if (std::exchange(client_open_, open) != open) {
      tell_client(now, open, open ? fmt::format(" ({}{})", text.substr(5), unit) : "");
    }
    end_ = std::move(text);
  };
  if (const auto* line = std::get_if<drivers::LineClient>(&piece)) {
    ends(line->present, end_text(*line), " Bd");
  } else if (const auto* can = std::get_if<drivers::CanClient>(&piece)) {
    ends(can->open, end_text(*can), " bit/s");
  } else if (const auto* stream = std::get_if<StreamPiece>(&piece)) {
    if (stream->what == StreamPiece::What::opened) {
      ++connections_;
      tell_client(now, true, fmt::format(" ({} connected)", connections_));
    } else if (stream->what == StreamPiece::What::gone) {
      connections_ -= connections_ == 0 ? 0 : 1;
      tell_client(now, false, fmt::format(" ({} connected)", connections_));
    }
  }
}

void Recorder::Wire::lay_out(SimTime at, std::uint8_t flags, const StreamPiece& piece) {
  if (!records(at)) {
    return;
  }
  using Side = pcapng::TcpConversation::Side;
  const bool inbound = (flags & kInbound) != 0;
  const Side from = inbound ? Side::client : Side::server;
  const auto use = [&](Side side, std::span<const std::uint8_t> segment) {
    write(side == Side::client ? kInbound : 0, at, segment);
  };
  // The pieces become segments of a TCP connection (pcapng::TcpConversation): a handshake when it
  // opens, or with its first bytes if it was open before; a FIN of each side when it ends.
  auto found = conversations_.find(piece.connection);
  if (found == conversations_.end()) {
    if (piece.what != StreamPiece::What::opened && piece.what != StreamPiece::What::bytes) {
      return;
    }
    found = conversations_.try_emplace(piece.connection, piece).first;
    found->second.tcp.open(use);
  }
  Conversation& conversation = found->second;
  const auto end = [&](Side side) {
    bool& ended = conversation.ended[static_cast<std::size_t>(side)];
    if (!std::exchange(ended, true)) {
      conversation.tcp.finish(side, use);
    }
  };
  switch (piece.what) {
    case StreamPiece::What::opened:
      break;
    case StreamPiece::What::bytes:
      conversation.tcp.data(from, piece.bytes, use);
      break;
    case StreamPiece::What::ended:
      end(from);
      break;
    case StreamPiece::What::gone:
      end(Side::client);
      end(Side::server);
      conversations_.erase(found);
      break;
  }
}

/// What clients sent, until its instant has come among what was due.
class Recorder::Arrivals final : public Outlet {
 public:
  /// Copies what the piece refers to.
  void add(SimTime at, Wire& wire, const WirePiece& piece) {
    Waiting waiting{at, &wire, piece, {}};
    std::visit(
        [&](auto& kind) {
          if constexpr (requires { kind.bytes; }) {
            waiting.bytes.assign(kind.bytes.begin(), kind.bytes.end());
          }
        },
        waiting.piece);
    waiting_.push_back(std::move(waiting));
  }
  [[nodiscard]] SimTime next_due() const override {
    return waiting_.empty() ? kNever : waiting_.front().at;
  }
  void transmit_front(std::optional<Duration> /*lateness*/) override {
    Waiting& front = waiting_.front();
    std::visit(
        [&](auto& kind) {
          if constexpr (requires { kind.bytes; }) {
            kind.bytes = front.bytes;
          }
        },
        front.piece);
    front.wire->put(front.at, kInbound, front.piece);
    waiting_.pop_front();
  }

 private:
  struct Waiting {
    SimTime at{};
    Wire* wire = nullptr;
    WirePiece piece;
    std::vector<std::uint8_t> bytes;
  };
  std::deque<Waiting> waiting_;
};

void Recorder::Wire::received(const WirePiece& piece) {
  const SimTime now = recorder_.executive_->now();
  recorder_.clients_acted_ = true;
  pass_on([&](WireTap& tap) { tap.received(piece); });
  watch(now, piece);
  if (!records(now)) {
    return;
  }
  if (const auto* frame = std::get_if<protocols::can::Frame>(&piece)) {
    put_end(now, "frame " + protocols::can::frame_text(*frame));
  } else if (std::holds_alternative<drivers::LineClient>(piece) ||
             std::holds_alternative<drivers::CanClient>(piece)) {
    put(now, kInbound, piece);  // in a file of its own, in the order of the client's acts
  } else {
    recorder_.arrivals_->add(now, *this, piece);
  }
}

/// Records faults when they begin and end, and the figures of each second.
class Recorder::Watch final : public EventSource {
 public:
  Watch(Recorder& recorder, std::function<RecordedStatus()> status,
        const std::vector<FaultWindow>& faults)
      : recorder_(recorder), status_(std::move(status)) {
    std::ranges::for_each(faults, [this](const FaultWindow& fault) { expect(fault); });
  }

  void expect(const FaultWindow& fault) {
    for (const SimTime edge : {fault.begin, fault.end}) {
      if (edge != kNever) {
        edges_.insert(std::ranges::upper_bound(edges_, edge), edge);
      }
    }
  }

  /// Starts the figures of a recording that begins at `now`.
  void begin(SimTime now) {
    next_figures_ = kStart + kStatisticsPeriod * ((now - kStart) / kStatisticsPeriod + 1);
    told_figures_ = now;
  }

  [[nodiscard]] SimTime next_event() const override {
    const SimTime figures = recorder_.folder_ ? next_figures_ : kNever;
    return edges_.empty() ? figures : std::min(figures, edges_.front());
  }
  [[nodiscard]] SimTime next_wakeup() const override { return next_event(); }
  void advance(SimTime now) override {
    while (!edges_.empty() && edges_.front() <= now) {
      edges_.pop_front();
    }
    const RecordedStatus status = status_();
    tell_faults(now, status);
    if (recorder_.folder_ && next_figures_ <= now) {
      tell_figures(now, status);
      next_figures_ += kStatisticsPeriod * ((now - next_figures_) / kStatisticsPeriod + 1);
    }
  }
  /// The last figures.
  void end(SimTime now) {
    if (now != told_figures_) {
      tell_figures(now, status_());
    }
  }

 private:
  /// Its end may have changed.
  static auto same_as(const FaultWindow& fault) {
    return [&fault](const FaultWindow& other) {
      return other.where == fault.where && other.type == fault.type && other.begin == fault.begin;
    };
  }

  void tell_faults(SimTime now, const RecordedStatus& status) {
    for (const FaultWindow& fault : status.faults) {
      if (std::ranges::none_of(acting_, same_as(fault))) {
        tell(now, fault, status, "begins");
      }
    }
    for (const FaultWindow& fault : acting_) {
      if (std::ranges::none_of(status.faults, same_as(fault))) {
        tell(now, fault, status, "ends");
      }
    }
    acting_ = status.faults;
  }

  void tell(SimTime now, const FaultWindow& fault, const RecordedStatus& status,
            std::string_view what) {
    const std::string text = fmt::format("fault {} of {} {} at {:.3f} s", fault.type, fault.where,
                                         what, to_seconds(now));
    recorder_.events_.tell(now, what == "begins" ? EventKind::fault_begun : EventKind::fault_ended,
                           LogLevel::info, fault.where, text);
    if (Wire* wire = wire_of(fault.where, status)) {
      wire->note(now, text);
    }
  }

  /// Returns the wire of a device, by the device's or its bus's name, or of a bus or line itself.
  [[nodiscard]] Wire* wire_of(const std::string& where, const RecordedStatus& status) const {
    const std::string name = where.substr(where.find(' ') + 1);
    const auto device = std::ranges::find(status.devices, name, &RecordedStatus::Device::name);
    for (std::size_t i = 0; i < recorder_.about_.size(); ++i) {
      const RecordedWire& wire = recorder_.about_[i];
      if (wire.name == name ||
          (device != status.devices.end() && device->wire.starts_with(wire.address))) {
        return recorder_.wires_[i].get();
      }
    }
    return nullptr;
  }

  void tell_figures(SimTime now, const RecordedStatus& status) {
    told_figures_ = now;
    Json json{{"sim_s", to_seconds(now)}, {"devices", Json::object()}};
    for (const RecordedStatus::Device& device : status.devices) {
      json["devices"][device.name] = {{"frames", device.frames},
                                      {"bytes", device.bytes},
                                      {"dropped", device.dropped},
                                      {"lateness_p99_us", 1e6 * to_seconds(device.lateness_p99)},
                                      {"lateness_max_us", 1e6 * to_seconds(device.lateness_max)}};
    }
    recorder_.put(TruthTrack::statistics, now, json.dump());
  }

  Recorder& recorder_;
  std::function<RecordedStatus()> status_;
  std::deque<SimTime> edges_;  ///< When faults begin and end.
  std::vector<FaultWindow> acting_;
  SimTime next_figures_ = kStart + kStatisticsPeriod;
  SimTime told_figures_ = kStart;
};

/// Writes records of the truth as messages.
class Recorder::Truth final : public TruthObserver {
 public:
  Truth(Recorder& recorder, const Calendar& calendar, std::span<const sim::TruthField> fields,
        std::span<const std::string_view> links)
      : recorder_(recorder), messages_(recorder.run_.start_unix_ns, calendar, fields, links) {}

  void record(const TruthRecord& record) override {
    if (recorder_.records_truth(record.time)) {
      messages_.tell(
          record, [](TruthTrack) { return true; },
          [this](TruthTrack track, SimTime at, std::string_view text) {
            recorder_.put(track, at, text);
          });
    }
  }

 private:
  Recorder& recorder_;
  TruthMessages messages_;
};

Recorder::Recorder(RecordedRun run, std::chrono::milliseconds patience, OutputFailures& failures,
                   RunEvents& events)
    : run_(std::move(run)),
      failures_(failures),
      events_(events),
      arrivals_(std::make_unique<Arrivals>()),
      queue_(kQueueBytes, patience) {
  queue_.close();
  events_.inform([this](const RunEvent& event) { hear(event); });
}

Recorder::~Recorder() {
  events_.inform({});
  end_thread();
}

void Recorder::attach(Executive& executive) {
  executive_ = &executive;
  executive.add(*arrivals_);
  executive.on_handover([this](const RequestHandover& one) { handover(one); });
}

WireTap& Recorder::add_wire(const std::string& name, WireKind kind, const std::string& address) {
  std::string unique = name;
  const auto taken = [&](const RecordedWire& wire) { return wire.name == name; };
  if (std::ranges::any_of(about_, taken) || name == kTruthName) {
    constexpr std::array<std::string_view, 3> kSuffixes{"_serial", "_can", "_ethernet"};
    unique += kSuffixes[static_cast<std::size_t>(kind)];
  }
  about_.push_back({unique, kind, address});
  WireTap* const further = wire_user_ ? &wire_user_(unique, kind) : nullptr;
  wires_.push_back(std::make_unique<Wire>(*this, unique, further));
  return *wires_.back();
}

void Recorder::join(WireTap& tap, QueuedOutlet& outlet) const {
  outlet.tell(tap);
  for (std::size_t i = 0; outlet_user_ && i < wires_.size(); ++i) {
    if (wires_[i].get() == &tap) {
      outlet_user_(about_[i].name, outlet);
    }
  }
}

std::unique_ptr<TruthObserver> Recorder::truth_observer(const Calendar& calendar,
                                                        std::span<const sim::TruthField> fields,
                                                        std::span<const std::string_view> links) {
  return std::make_unique<Truth>(*this, calendar, fields, links);
}

void Recorder::start(std::function<RecordedStatus()> status,
                     const std::vector<FaultWindow>& faults) {
  watch_ = std::make_unique<Watch>(*this, std::move(status), faults);
  executive_->add(*watch_);
  executive_->add(events_);
}

void Recorder::expect(const FaultWindow& fault) {
  watch_->expect(fault);
}

void Recorder::command(std::string text) {
  const SimTime now = executive_->now();
  put_line(kCommandTrack, now, text);
  if (text.size() <= kCommandBytes - command_bytes_) {
    command_bytes_ += text.size();
    commands_.emplace_back(now, std::move(text));
  } else {
    command_bytes_ = kCommandBytes;  // what comes after a gap is of no use
    forgotten_ = true;
  }
}

void Recorder::handover(const RequestHandover& handover) {
  put_line(handover);
  if (handovers_.size() < kHandovers) {
    handovers_.push_back(handover);
  } else {
    forgotten_ = true;
  }
}

void Recorder::put_line(const RequestHandover& handover) {
  put_line(kRequestTrack, handover.asked,
           instant_text(handover.taken) + (handover.promised ? kPromised : ""));
}

void Recorder::begin(const RecordOptions& options) {
  const SimTime now = executive_->now();
  const SimTime soonest = executive_->soonest_request();
  // Where nothing of the truth has been computed, all of it is to come.
  if (now == kStart && soonest == kStart + Duration{1}) {
    begin(options, kStart, kStart);
  } else {
    begin(options, now + Duration{1}, soonest);
  }
}

void Recorder::begin(const RecordOptions& options, SimTime from, SimTime truth_from) {
  std::vector<std::string> allowed;
  std::ranges::transform(about_, std::back_inserter(allowed), &RecordedWire::name);
  allowed.emplace_back(kTruthName);
  for (const std::string& name : options.only) {
    if (std::ranges::find(allowed, name) == allowed.end()) {
      const std::string near = nearest_word(name, allowed);
      throw std::invalid_argument(
          fmt::format("--only: the rig has no such wire, found \"{}\", allowed {}{}", name,
                      join_words(allowed), near.empty() ? "" : ", did you mean " + near + "?"));
    }
  }
  const auto wanted = [&](std::string_view name) {
    return options.only.empty() || std::ranges::find(options.only, name) != options.only.end();
  };
  make_new_folder("--record", options.folder);
  std::vector<RecordedWire> chosen;
  for (std::size_t i = 0; i < wires_.size(); ++i) {
    const bool is_wanted = wanted(about_[i].name);
    wires_[i]->begin(is_wanted ? std::optional(wire_track(chosen.size())) : std::nullopt);
    if (is_wanted) {
      chosen.push_back(about_[i]);
    }
  }
  RecordedRun run = run_;
  run.begin = from;
  run.truth_begin = truth_from;
  run.clients_before = from != kStart && (clients_acted_ || forgotten_);
  const bool with_truth = wanted(kTruthName);
  writer_ = std::make_unique<RecordingWriter>(
      options.folder, std::move(run), chosen, with_truth,
      [this](const std::string& what, bool over) {
        if (!over) {
          failures_.report("the recording is not complete: " + what);
        }
        trouble_.emplace_back(over ? LogLevel::info : LogLevel::error, what);
      });
  told_full_ = false;
  queue_.open();
  thread_ = std::thread([this] { write_all(); });
  folder_ = options.folder;
  from_ = from;
  until_ = kNever;
  truth_from_ = truth_from;
  truth_on_.store(with_truth, std::memory_order_release);
  watch_->begin(executive_->now());
  for (const auto& [at, text] : commands_) {
    put_line(kCommandTrack, at, text);
  }
  for (const RequestHandover& handover : handovers_) {
    put_line(handover);
  }
  for (const auto& wire : wires_) {
    wire->tell_end(from);
  }
  events_.tell(executive_->now(), EventKind::recording_began, LogLevel::info, "",
               "recording into " + options.folder);
}

bool Recorder::put(std::uint16_t track, std::uint8_t flags, SimTime at,
                   std::span<const std::uint8_t> bytes) {
  return queue_.put({track, flags, at, bytes});
}

void Recorder::put_told(std::uint16_t track, std::uint8_t flags, SimTime at,
                        std::span<const std::uint8_t> bytes) {
  if (!put(track, flags, at, bytes) && !told_full_.exchange(true)) {
    failures_.report(
        fmt::format("the recording is not complete: its disk takes less than passes; what does not "
                    "fit into {} MB of memory is lost",
                    kQueueBytes / 1'048'576));
  }
}

void Recorder::put_line(std::uint16_t track, SimTime at, std::string_view text) {
  if (folder_) {
    put_told(track, 0, at, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  }
}

void Recorder::put(TruthTrack track, SimTime at, std::string_view text) {
  if (truth_on_.load(std::memory_order_acquire)) {
    put_told(static_cast<std::uint16_t>(track), 0, at,
             {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  }
}

void Recorder::hear(const RunEvent& event) {
  // A recording does not contain its own path: the same run's bytes are the same in any folder.
  const bool of_itself =
      event.kind == EventKind::recording_began || event.kind == EventKind::recording_ended;
  if (!of_itself && truth_on_.load(std::memory_order_acquire)) {
    const std::string text =
        log_message(run_.start_unix_ns, event.at, event.level,
                    kEventKinds[static_cast<std::size_t>(event.kind)], event.text);
    // If there is no room, put() reports that, which is an event again.
    put(static_cast<std::uint16_t>(TruthTrack::events), 0, event.at,
        {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  }
}

void Recorder::write_all() {
  auto flushed = std::chrono::steady_clock::now();
  for (bool over = false; !over;) {
    over = queue_.closed();
    const RecordQueue::Taken& taken = queue_.take(kFlushPeriod);
    // What was lost was so after the entries that found room.
    for (const RecordEntry& entry : taken.entries) {
      writer_->write(entry);
      while (!trouble_.empty()) {
        const auto [level, what] = std::move(trouble_.front());
        trouble_.pop_front();
        const std::string text =
            log_message(run_.start_unix_ns, entry.at, level, "recording", what);
        writer_->write({static_cast<std::uint16_t>(TruthTrack::events),
                        0,
                        entry.at,
                        {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}});
      }
    }
    for (std::size_t track = 0; track < taken.lost.size(); ++track) {
      if (taken.lost[track] != 0) {
        writer_->lost(static_cast<std::uint16_t>(track), taken.lost[track]);
      }
    }
    const auto now = std::chrono::steady_clock::now();
    if (now - flushed >= kFlushPeriod) {
      flushed = now;
      writer_->flush();
    }
  }
}

void Recorder::end_thread() {
  if (thread_.joinable()) {
    queue_.close();
    thread_.join();
  }
}

void Recorder::finish(SimTime end) {
  if (!folder_) {
    return;
  }
  watch_->end(end);
  events_.tell(end, EventKind::recording_ended, LogLevel::info, "", "recorded into " + *folder_);
  truth_on_ = false;
  folder_.reset();
  end_thread();
  try {
    writer_->finish(end);
  } catch (const std::exception& error) {
    failures_.report(fields::failure_text(error, "the recording"));
  }
}

}  // namespace rigwire::hil
