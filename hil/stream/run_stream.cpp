#include "hil/stream/run_stream.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/asio/post.hpp>
#include <condition_variable>
#include <deque>
#include <iterator>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>
#include <utility>

#include "hil/configuration/plain_text.h"
#include "hil/executive/background_thread.h"
#include "hil/record/byte_place.h"
#include "hil/stream/fix_reader.h"
#include "protocols/can/frame_text.h"

namespace rigwire::hil {
namespace {

using Json = nlohmann::ordered_json;

/// Between two changes of the scene, simulated.
constexpr Duration kScenePeriod = std::chrono::milliseconds{200};
/// Of a message on a wire so many bytes are shown.
constexpr std::size_t kShownBytes = 64;

std::string hexadecimal(std::span<const std::uint8_t> bytes) {
  std::string text;
  for (const std::uint8_t byte : bytes.first(std::min(bytes.size(), kShownBytes))) {
    fmt::format_to(std::back_inserter(text), "{:02x}", byte);
  }
  return text;
}

/// What it is, in words, as far as bytes alone tell.
std::string words_of(WireKind kind, std::span<const std::uint8_t> bytes) {
  if (kind == WireKind::serial) {
    if (!bytes.empty() && bytes.front() == '$') {
      const auto end = std::ranges::find(bytes, std::uint8_t{'\r'});
      return printable(std::string(bytes.begin(), end));
    }
    return serial_place(bytes, 0);
  }
  return datagram_place(bytes, 0);
}

/// A frame as a message on its bus: its name, and what its signals say.
Json signals_of(const protocols::can::Frame& frame,
                std::span<const protocols::can::OwnedMessage> messages, std::string& text) {
  Json signals = Json::object();
  const auto message = std::ranges::find_if(messages, [&](const auto& known) {
    return known.id == frame.id && known.extended == frame.extended;
  });
  if (message == messages.end() || frame.remote) {
    return signals;
  }
  text += " " + message->name;
  const auto payload = std::span(frame.data).first(frame.length);
  for (std::size_t i = 0; i < message->signals.size(); ++i) {
    const protocols::can::Reading reading = protocols::can::get(*message, i, payload);
    if (reading.valid()) {
      const auto& signal = message->signals[i];
      signals[message->name][signal.name] = reading.value;
      text += fmt::format(" {}={:.6g} {}", signal.name, reading.value, signal.unit);
    }
  }
  return signals;
}

}  // namespace

/// What the truth tells, until its instant has come on the wires.
class RunStream::Ahead {
 public:
  /// On the truth's thread, in order of time.
  void tell(SimTime at, std::function<void()> what) {
    const std::scoped_lock lock(mutex_);
    waiting_.emplace_back(at, std::move(what));
    next_.store(waiting_.front().first, std::memory_order_release);
  }
  [[nodiscard]] SimTime next() const { return next_.load(std::memory_order_acquire); }
  void advance(SimTime now) {
    while (next() <= now) {
      std::function<void()> what;
      {
        const std::scoped_lock lock(mutex_);
        what = std::move(waiting_.front().second);
        waiting_.pop_front();
        next_.store(waiting_.empty() ? kNever : waiting_.front().first, std::memory_order_release);
      }
      what();
    }
  }

 private:
  std::mutex mutex_;
  std::deque<std::pair<SimTime, std::function<void()>>> waiting_;
  std::atomic<SimTime> next_{kNever};
};

class RunStream::Truth final : public TruthObserver {
 public:
  Truth(RunStream& stream, const Calendar& calendar, std::span<const sim::TruthField> fields,
        std::span<const std::string_view> links)
      : stream_(stream), messages_(stream.run_.start_unix_ns, calendar, fields, links) {}

  void record(const TruthRecord& record) override {
    messages_.tell(
        record, [this](TruthTrack track) { return stream_.viewers_.wanted(channel(track)); },
        [this](TruthTrack track, SimTime at, std::string_view text) {
          stream_.ahead_->tell(at, [this, id = channel(track), at, text = std::string(text)] {
            stream_.viewers_.put(id, stream_.unix_ns(at), text);
          });
        });
  }

 private:
  [[nodiscard]] Viewers::ChannelId channel(TruthTrack track) const {
    return stream_.tracks_[static_cast<std::size_t>(track)];
  }
  RunStream& stream_;
  TruthMessages messages_;
};

/// What is made of the bytes of one wire, on the decoder's thread.
class RunStream::Wire final : public WireTap {
 public:
  Wire(RunStream& stream, const std::string& name, WireKind kind) : stream_(stream), kind_(kind) {
    Viewers& viewers = stream.viewers_;
    const auto rows = channel_rows();
    const auto row = [&](TruthTrack track) { return rows[static_cast<std::size_t>(track)]; };
    messages_ =
        viewers.add({"/wire/" + name, "json", "rigwire.WireMessage", R"({"type":"object"})", 256});
    const auto lidar = std::ranges::find(stream.run_.lidars, name, &RecordedLidar::name);
    if (lidar != stream.run_.lidars.end()) {
      const ChannelRow points = row(TruthTrack::points);
      points_ = viewers.add(
          {"/points/" + name, "json", std::string(points.schema_name), points.schema, 1});
      clouds_.emplace(*lidar, Duration{0});
    }
    if (kind == WireKind::can) {
      can_messages_ = stream.run_.messages(name);
    }
    if (kind == WireKind::serial && stream.run_.receivers.contains(name)) {
      const ChannelRow location = row(TruthTrack::location);
      fixes_ =
          viewers.add({"/fix/" + name, "json", std::string(location.schema_name), location.schema});
      name_ = name;
    }
  }

  void sent(SimTime at, const WirePiece& piece) override { hear(at, false, piece); }
  void carried(SimTime at, const WirePiece& piece) override { hear(at, true, piece); }
  void received(const WirePiece& piece) override;
  void lost(SimTime /*at*/) override {}

  /// On the decoder's thread.
  void decode(SimTime at, bool of_client, std::span<const std::uint8_t> bytes);

 private:
  void hear(SimTime at, bool of_client, const WirePiece& piece);
  [[nodiscard]] bool wanted() const {
    const auto is = [this](const std::optional<Viewers::ChannelId>& channel) {
      return channel && stream_.viewers_.wanted(*channel);
    };
    return is(messages_) || is(points_) || is(fixes_);
  }

  RunStream& stream_;
  WireKind kind_;
  std::string name_;
  std::optional<Viewers::ChannelId> messages_;
  std::optional<Viewers::ChannelId> points_;
  std::optional<Viewers::ChannelId> fixes_;
  std::optional<LidarClouds> clouds_;
  std::vector<protocols::can::OwnedMessage> can_messages_;
  FixReader fix_reader_;
};

class RunStream::Decoder {
 public:
  explicit Decoder(RunStream& stream, boost::asio::io_context& io) : stream_(stream), io_(io) {
    thread_ = std::thread([this] { work(); });
  }
  ~Decoder() {
    {
      const std::scoped_lock lock(mutex_);
      over_ = true;
    }
    came_.notify_one();
    thread_.join();
    *alive_ = false;
  }
  Decoder(const Decoder&) = delete;
  Decoder& operator=(const Decoder&) = delete;

  void put(Wire& wire, SimTime at, bool of_client, std::span<const std::uint8_t> bytes) {
    {
      const std::scoped_lock lock(mutex_);
      if (bytes_ + bytes.size() > kQueueBytes) {
        ++not_shown_;
        return;
      }
      bytes_ += bytes.size();
      queue_.push_back({&wire, at, of_client, {bytes.begin(), bytes.end()}});
      if (queue_.size() > 1) {
        return;
      }
    }
    came_.notify_one();
  }
  [[nodiscard]] std::uint64_t not_shown() const {
    const std::scoped_lock lock(mutex_);
    return not_shown_;
  }
  /// On its own thread: what is to be sent goes to the thread of the wires.
  void send(Viewers::ChannelId channel, SimTime at, std::string text) {
    boost::asio::post(io_, [this, alive = alive_, channel, at, text = std::move(text)] {
      if (*alive) {
        stream_.viewers_.put(channel, stream_.unix_ns(at), text);
      }
    });
  }

 private:
  struct Entry {
    Wire* wire = nullptr;
    SimTime at{};
    bool of_client = false;
    std::vector<std::uint8_t> bytes;
  };

  void work() {
    yield_to_the_loop();
    std::deque<Entry> taken;
    while (true) {
      {
        std::unique_lock lock(mutex_);
        came_.wait(lock, [this] { return over_ || !queue_.empty(); });
        if (over_) {
          return;
        }
        taken.swap(queue_);
        bytes_ = 0;
      }
      for (const Entry& entry : taken) {
        entry.wire->decode(entry.at, entry.of_client, entry.bytes);
      }
      taken.clear();
    }
  }

  RunStream& stream_;
  boost::asio::io_context& io_;
  /// On the thread of the wires, as the handlers that look at it.
  std::shared_ptr<bool> alive_ = std::make_shared<bool>(true);
  mutable std::mutex mutex_;
  std::condition_variable came_;
  std::deque<Entry> queue_;
  std::size_t bytes_ = 0;
  std::uint64_t not_shown_ = 0;
  bool over_ = false;
  std::thread thread_;
};

void RunStream::Wire::hear(SimTime at, bool of_client, const WirePiece& piece) {
  if (!wanted()) {
    return;
  }
  std::visit(
      [&](const auto& kind) {
        using Kind = std::remove_cvref_t<decltype(kind)>;
        if constexpr (requires { kind.bytes; }) {
          if (!kind.bytes.empty()) {
            stream_.decoder_->put(*this, at, of_client, kind.bytes);
          }
        } else if constexpr (std::is_same_v<Kind, protocols::can::Frame>) {
          const std::string text = protocols::can::frame_text(kind);
          stream_.decoder_->put(*this, at, of_client,
                                {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
        }
      },
      piece);
}

void RunStream::Wire::received(const WirePiece& piece) {
  // Frames of clients are told again when the bus has carried them.
  if (kind_ != WireKind::can) {
    hear(stream_.now_(), true, piece);
  }
}

void RunStream::Wire::decode(SimTime at, bool of_client, std::span<const std::uint8_t> bytes) {
  const auto send = [&](const std::optional<Viewers::ChannelId>& channel, std::string text) {
    stream_.decoder_->send(*channel, at, std::move(text));
  };
  if (points_ && !of_client && stream_.viewers_.wanted(*points_)) {
    if (const std::string* cloud = clouds_->take(at, bytes, stream_.run_.start_unix_ns)) {
      send(points_, *cloud);
    }
  }
  if (fixes_ && !of_client && stream_.viewers_.wanted(*fixes_)) {
    fix_reader_.take(bytes, [&](const sim::GeodeticPoint& place) {
      const Eigen::Vector3d p_W = stream_.run_.frame.to_world(place);
      send(fixes_, location_message(timestamp(stream_.run_.start_unix_ns, at), name_, place,
                                    fmt::format(R"(,"position_m":[{:.4f},{:.4f},{:.4f}])", p_W.x(),
                                                p_W.y(), p_W.z())));
    });
  }
  if (stream_.viewers_.wanted(*messages_)) {
    Json message{{"time_ns", at.time_since_epoch().count()},
                 {"from", of_client ? "client" : "device"}};
    std::string text;
    if (kind_ == WireKind::can) {
      text.assign(bytes.begin(), bytes.end());
    }
    const auto frame = protocols::can::parse_frame_text(text);
    if (frame) {
      message["size"] = frame->length;
      message["signals"] = signals_of(*frame, can_messages_, text);
      message["text"] = text;
    } else {
      message["size"] = bytes.size();
      message["bytes"] = hexadecimal(bytes);
      message["text"] = words_of(kind_, bytes);
    }
    send(messages_, message.dump(-1, ' ', false, Json::error_handler_t::replace));
  }
}

RunStream::RunStream(boost::asio::io_context& io, StreamedRun run)
    : run_(std::move(run)),
      viewers_(run_.name, run_.session),
      ahead_(std::make_unique<Ahead>()),
      decoder_(std::make_unique<Decoder>(*this, io)) {
  const auto rows = channel_rows();
  for (const TruthTrack track : {TruthTrack::truth, TruthTrack::transforms, TruthTrack::location,
                                 TruthTrack::events, TruthTrack::motion, TruthTrack::joints}) {
    const ChannelRow& row = rows[static_cast<std::size_t>(track)];
    tracks_[static_cast<std::size_t>(track)] =
        viewers_.add({std::string(row.topic), "json", std::string(row.schema_name), row.schema});
  }
  scene_channel_ = viewers_.add({"/scene", "json", "foxglove.SceneUpdate", SceneModel::schema(), 64,
                                 [this] { return scene_ ? scene_->whole() : std::string(); }});
  viewers_.on_asset([this](std::string_view uri) { return scene_ ? scene_->asset(uri) : nullptr; });
}

RunStream::~RunStream() = default;

WireTap& RunStream::add_wire(const std::string& name, WireKind kind) {
  wires_.push_back(std::make_unique<Wire>(*this, name, kind));
  return *wires_.back();
}

std::unique_ptr<TruthObserver> RunStream::truth_observer(const Calendar& calendar,
                                                         std::span<const sim::TruthField> fields,
                                                         std::span<const std::string_view> links) {
  return std::make_unique<Truth>(*this, calendar, fields, links);
}

std::unique_ptr<WorldSensor> RunStream::world_view(const sim::Scene& scene, std::size_t links) {
  scene_.emplace(sim::contents_of(scene), run_.start_unix_ns);
  return make_world_view(links, kScenePeriod, [this](ViewChange change) {
    const SimTime at = change.time;
    ahead_->tell(at, [this, at, change = std::move(change)] {
      const std::string text = scene_->apply(change);
      viewers_.put(scene_channel_, unix_ns(at), text);
    });
  });
}

void RunStream::tell(const RunEvent& event) {
  const Viewers::ChannelId channel = tracks_[static_cast<std::size_t>(TruthTrack::events)];
  if (viewers_.wanted(channel)) {
    decoder_->send(channel, event.at,
                   log_message(run_.start_unix_ns, event.at, event.level,
                               kEventKinds[static_cast<std::size_t>(event.kind)], event.text));
  }
}

std::uint64_t RunStream::not_shown() const {
  return decoder_->not_shown();
}

SimTime RunStream::next_event() const {
  return ahead_->next();
}

void RunStream::advance(SimTime now) {
  ahead_->advance(now);
}

}  // namespace rigwire::hil
