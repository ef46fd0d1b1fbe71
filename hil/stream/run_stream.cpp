#include "hil/stream/run_stream.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/asio/post.hpp>
#include <chrono>
#include <deque>
#include <iterator>
#include <mutex>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>
#include <utility>

#include "hil/stream/fix_reader.h"
#include "hil/stream/identifier_counts.h"
#include "hil/stream/sky_reader.h"
#include "hil/stream/wire_reading.h"
#include "protocols/can/frame_text.h"
#include "protocols/foxglove/cdr_messages.h"
#include "protocols/gige_vision/gvcp.h"
#include "protocols/gnss_stream/splitter.h"

namespace rigwire::hil {
namespace {

namespace foxglove = protocols::foxglove;
using Json = nlohmann::ordered_json;

/// Simulated time between two changes of the scene.
constexpr Duration kScenePeriod = std::chrono::milliseconds{200};
/// Wall time between two accounts of a wire.
constexpr std::chrono::milliseconds kAccountPeriod{200};
/// Wall time between two looks for new input: with viewers, and without. No multiple of a
/// millisecond, so that it does not coincide with truth and wires each time.
constexpr std::chrono::microseconds kLookPeriod{7300};
constexpr std::chrono::milliseconds kIdleLookPeriod{50};
/// Wall time between two datagrams of at least kBulkBytes that are sent with their fields: no
/// viewer can read more, and the fields of a lidar's 1800 datagrams a second would occupy a core.
constexpr std::chrono::milliseconds kBulkPeriod{20};
constexpr std::size_t kBulkBytes = 1000;

std::string hexadecimal(std::span<const std::uint8_t> bytes) {
  std::string text;
  for (const std::uint8_t byte : bytes.first(std::min(bytes.size(), kShownBytes))) {
    fmt::format_to(std::back_inserter(text), "{:02x}", byte);
  }
  return text;
}

Json json_of(std::span<const WireField> fields) {
  Json list = Json::array();
  for (const WireField& field : fields) {
    if (field.from < kShownBytes) {
      list.push_back({{"name", field.name},
                      {"value", field.value},
                      {"from", field.from},
                      {"bytes", field.bytes}});
    }
  }
  return list;
}

/// What the signals of a frame say, by message, as numbers to plot.
Json signals_of(const protocols::can::Frame& frame,
                std::span<const protocols::can::OwnedMessage> messages) {
  Json signals = Json::object();
  if (const auto* const message = message_of(frame, messages)) {
    for (std::size_t i = 0; i < message->signals.size(); ++i) {
      const auto reading = protocols::can::get(*message, i, frame.payload());
      if (reading.valid()) {
        signals[message->name][message->signals[i].name] = reading.value;
      }
    }
  }
  return signals;
}

/// {"sensors": [{name, kind, frame, position_m, orientation, horizontal_rad, vertical_rad}]}
std::string sensors_message(std::span<const ShownSensor> sensors) {
  Json list = Json::array();
  for (const ShownSensor& sensor : sensors) {
    const Eigen::Vector3d p = sensor.X_LS.translation();
    const Eigen::Quaterniond q(sensor.X_LS.linear());
    list.push_back({{"name", sensor.name},
                    {"kind", sensor.kind},
                    {"frame", sensor.link},
                    {"position", {{"x", p.x()}, {"y", p.y()}, {"z", p.z()}}},
                    {"orientation", {{"x", q.x()}, {"y", q.y()}, {"z", q.z()}, {"w", q.w()}}},
                    {"horizontal_rad", sensor.horizontal_rad},
                    {"vertical_rad", sensor.vertical_rad}});
  }
  return Json{{"sensors", std::move(list)}}.dump();
}

std::string satellites_message(std::string_view from, std::span<const SkySatellite> sky) {
  Json list = Json::array();
  for (const SkySatellite& one : sky) {
    list.push_back({{"name", one.name},
                    {"azimuth_deg", one.azimuth_deg},
                    {"elevation_deg", one.elevation_deg},
                    {"cn0_dbhz", one.cn0_dbhz},
                    {"used", one.used}});
  }
  return Json{{"from", from}, {"satellites", std::move(list)}}.dump();
}

/// {"rain_mmph", "snow_mmph", "extinction_pm", "dust": [[x, y, z, sigma_m, depth], ...]}
std::string air_message(const AirView& air) {
  std::string text =
      fmt::format(R"({{"rain_mmph":{:.4g},"snow_mmph":{:.4g},"extinction_pm":{:.4g},"dust":[)",
                  air.rain_mmph, air.snow_mmph, air.extinction_pm);
  for (const AirView::Puff& puff : air.dust) {
    fmt::format_to(std::back_inserter(text), "{}[{:.2f},{:.2f},{:.2f},{:.3g},{:.3g}]",
                   text.ends_with('[') ? "" : ",", puff.centre_W.x(), puff.centre_W.y(),
                   puff.centre_W.z(), puff.sigma_m, puff.depth);
  }
  return text + "]}";
}

std::string picture_message(std::int64_t unix_ns, const std::string& frame,
                            const SmallPicture& picture) {
  const auto bands =
      static_cast<std::uint32_t>(picture.pixels.size() / picture.width / picture.height);
  std::string bytes = foxglove::begin_raw_image({.unix_ns = unix_ns,
                                                 .frame_id = frame,
                                                 .width = picture.width,
                                                 .height = picture.height,
                                                 .encoding = picture.encoding,
                                                 .step = picture.width * bands,
                                                 .block = picture.block,
                                                 .sent_width = picture.sent_width,
                                                 .sent_height = picture.sent_height,
                                                 .remark = picture.remark},
                                                picture.pixels.size());
  bytes.append(picture.pixels.begin(), picture.pixels.end());
  return bytes;
}

/// Text shown below a preview.
constexpr const char* kPreviewRemark =
    "preview, rendered for this page; no client takes the camera's pictures";

/// Returns a preview as a picture message; its block is 0, which no camera sends.
SmallPicture small_picture(const CameraPreview& preview) {
  SmallPicture small;
  small.width = static_cast<std::uint32_t>(preview.picture.columns);
  small.height = static_cast<std::uint32_t>(preview.picture.rows);
  small.encoding = preview.picture.channels == 3 ? "rgb8" : "mono8";
  small.pixels.reserve(preview.picture.samples.size());
  for (const std::uint16_t sample : preview.picture.samples) {
    small.pixels.push_back(static_cast<std::uint8_t>(sample));
  }
  small.remark = kPreviewRemark;
  small.sent_width = small.width;
  small.sent_height = small.height;
  return small;
}

/// Returns a channel of large, frequent messages of which only the newest is needed.
StreamChannel dense_channel(std::string topic, std::string_view schema_name, std::string schema) {
  return {.topic = std::move(topic),
          .encoding = std::string(foxglove::kCdrEncoding),
          .schema_name = std::string(schema_name),
          .schema = std::move(schema),
          .depth = 1,
          .schema_encoding = std::string(foxglove::kCdrSchemaEncoding)};
}

constexpr const char* kObjectSchema = R"({"type":"object"})";

}  // namespace

/// Reports of the truth, kept until their instant has come.
class RunStream::Ahead {
 public:
  /// On the truth's thread, in order of time.
  void tell(SimTime at, std::function<void()> what) {
    const std::scoped_lock lock(mutex_);
    waiting_.emplace_back(at, std::move(what));
  }
  /// On the thread of the viewers: delivers all up to `now`, in that order.
  void tell_until(SimTime now) {
    std::vector<std::function<void()>> due;
    {
      const std::scoped_lock lock(mutex_);
      while (!waiting_.empty() && waiting_.front().first <= now) {
        due.push_back(std::move(waiting_.front().second));
        waiting_.pop_front();
      }
    }
    for (const auto& tell : due) {
      tell();
    }
  }

 private:
  std::mutex mutex_;
  std::deque<std::pair<SimTime, std::function<void()>>> waiting_;
};

class RunStream::Truth final : public TruthObserver {
 public:
  Truth(RunStream& stream, const Calendar& calendar, std::span<const sim::TruthField> fields,
        std::span<const std::string_view> links)
      : stream_(stream), messages_(stream.run_.start_unix_ns, calendar, fields, links) {}

  void record(const TruthRecord& record) override {
    stream_.ahead_->tell(record.time, [this, record] {
      newest_ = record;
      messages_.tell(
          record, [this](TruthTrack track) { return stream_.viewers_.wanted(channel(track)); },
          [this](TruthTrack track, SimTime at, std::string_view text) {
            stream_.viewers_.put(channel(track), stream_.unix_ns(at), text);
          });
    });
  }
  /// On the thread of the viewers: returns the newest record. Empty before there is any.
  [[nodiscard]] StreamChannel::First newest(TruthTrack wanted) {
    StreamChannel::First first{std::string()};
    if (newest_) {
      messages_.tell(
          *newest_, [wanted](TruthTrack track) { return track == wanted; },
          [&](TruthTrack, SimTime at, std::string_view text) {
            first = {std::string(text), stream_.unix_ns(at)};
          });
    }
    return first;
  }

 private:
  [[nodiscard]] Viewers::ChannelId channel(TruthTrack track) const {
    return stream_.tracks_[static_cast<std::size_t>(track)];
  }
  RunStream& stream_;
  // Used on the viewers' thread.
  TruthMessages messages_;
  std::optional<TruthRecord> newest_;
};

/// What passes on a wire, for the decoder.
struct RunStream::Piece {
  Wire* wire = nullptr;
  SimTime at{};
  bool of_client = false;
  std::uint64_t end = 0;  ///< Number of a connection; port of the device that sent a datagram.
  std::span<const std::uint8_t> bytes;
};

/// What is made of the bytes of one wire.
class RunStream::Wire final : public WireTap {
 public:
  Wire(RunStream& stream, const std::string& name, WireKind kind) : stream_(stream), kind_(kind) {
    Viewers& viewers = stream.viewers_;
    const auto rows = channel_rows();
    const auto row = [&](TruthTrack track) { return rows[static_cast<std::size_t>(track)]; };
    messages_ = viewers.add({"/wire/" + name, "json", "rigwire.WireMessage", kObjectSchema, 256});
    name_ = name;
    if (auto units = stream.run_.units(name); !units.empty()) {
      modbus_.emplace(kind == WireKind::serial ? ModbusReader::Line::rtu : ModbusReader::Line::tcp,
                      std::move(units));
      add_account({"/registers/" + name, "json", "rigwire.Registers", kObjectSchema, 1});
    }
    const auto sensor = std::ranges::find(stream.run_.sensors, name, &ShownSensor::name);
    if (kind == WireKind::ethernet && sensor != stream.run_.sensors.end() &&
        sensor->kind == "camera") {
      pictures_ = viewers.add(dense_channel("/camera/" + name, foxglove::kRawImageSchemaName,
                                            foxglove::raw_image_schema()));
      picture_reader_.emplace(sensor->coordinates);
    }
    const auto lidar = std::ranges::find(stream.run_.lidars, name, &RecordedLidar::name);
    if (lidar != stream.run_.lidars.end()) {
      points_ = viewers.add(dense_channel("/points/" + name, foxglove::kPointCloudSchemaName,
                                          foxglove::point_cloud_schema()));
      clouds_.emplace(*lidar, Duration{0});
    }
    if (kind == WireKind::can) {
      can_messages_ = stream.run_.messages(name);
      add_account({"/identifiers/" + name, "json", "rigwire.Identifiers", kObjectSchema, 1});
    }
    if (kind == WireKind::serial && stream.run_.receivers.contains(name)) {
      const ChannelRow location = row(TruthTrack::location);
      fixes_ =
          viewers.add({"/fix/" + name, "json", std::string(location.schema_name), location.schema});
      satellites_ =
          viewers.add({"/satellites/" + name, "json", "rigwire.Satellites", kObjectSchema, 4});
    }
  }

  void sent(SimTime at, const WirePiece& piece) override { hear(at, false, piece); }
  void carried(SimTime at, const WirePiece& piece) override { hear(at, true, piece); }
  void received(const WirePiece& piece) override;
  void lost(SimTime /*at*/) override {}

  // On the thread of the viewers.

  [[nodiscard]] const std::string& name() const { return name_; }
  /// The channel of its camera's pictures; nothing: it is no camera's.
  [[nodiscard]] const std::optional<Viewers::ChannelId>& pictures() const { return pictures_; }
  /// Decodes a piece; returns whether the account must be published again.
  [[nodiscard]] bool decode(const Piece& piece);
  void tell_account(SimTime at);

 private:
  void add_account(StreamChannel channel);
  [[nodiscard]] std::string account() const {
    return modbus_ ? modbus_->registers() : identifiers_.json(can_messages_);
  }
  void decode_message(const Piece& piece);
  /// Returns whether a datagram is sent to viewers: of frequent large ones only some are.
  [[nodiscard]] bool is_to_be_told(const Piece& piece);
  void hear(SimTime at, bool of_client, const WirePiece& piece);
  [[nodiscard]] bool wanted() const {
    const auto is = [this](const std::optional<Viewers::ChannelId>& channel) {
      return channel && stream_.viewers_.wanted(*channel);
    };
    return is(messages_) || is(points_) || is(fixes_) || is(satellites_) || is(pictures_) ||
           is(account_);
  }

  RunStream& stream_;
  WireKind kind_;
  std::string name_;
  std::optional<Viewers::ChannelId> messages_;
  std::optional<Viewers::ChannelId> points_;
  std::optional<Viewers::ChannelId> fixes_;
  std::optional<Viewers::ChannelId> satellites_;
  std::optional<Viewers::ChannelId> pictures_;
  /// Channel of a Modbus line's registers or a CAN bus's identifiers, sent periodically.
  std::optional<Viewers::ChannelId> account_;
  std::optional<LidarClouds> clouds_;
  std::vector<protocols::can::OwnedMessage> can_messages_;
  protocols::gnss_stream::Splitter of_receiver_;  ///< To be shown.
  protocols::gnss_stream::Splitter of_client_;
  FixReader fix_reader_;
  SkyReader sky_reader_;
  std::optional<PictureReader> picture_reader_;
  std::optional<ModbusReader> modbus_;
  IdentifierCounts identifiers_;
  std::chrono::steady_clock::time_point bulk_told_;
  /// Large datagrams that were left out since the last message.
  std::uint64_t left_out_ = 0;
};

/// Passes pieces from the wire thread to the viewers' thread.
class RunStream::Decoder {
 public:
  /// On the thread of the wires; the bytes are copied.
  void put(Piece piece) {
    const std::scoped_lock lock(mutex_);
    if (came_.bytes.size() + piece.bytes.size() > kQueueBytes) {
      ++not_shown_;
      return;
    }
    came_.bytes.insert(came_.bytes.end(), piece.bytes.begin(), piece.bytes.end());
    came_.pieces.push_back(piece);
  }
  [[nodiscard]] std::uint64_t not_shown() const {
    const std::scoped_lock lock(mutex_);
    return not_shown_;
  }

  /// On that of the viewers: all that has come.
  void decode() {
    {
      const std::scoped_lock lock(mutex_);
      std::swap(came_, taken_);
    }
    std::size_t from = 0;
    for (Piece& piece : taken_.pieces) {
      piece.bytes = std::span(taken_.bytes).subspan(from, piece.bytes.size());
      from += piece.bytes.size();
      if (piece.wire->decode(piece)) {
        untold_.insert(piece.wire);
      }
      last_ = piece.at;
    }
    taken_.pieces.clear();
    taken_.bytes.clear();
    if (const auto now = std::chrono::steady_clock::now(); now >= accounts_told_ + kAccountPeriod) {
      accounts_told_ = now;
      for (Wire* const wire : std::exchange(untold_, {})) {
        wire->tell_account(last_);
      }
    }
  }

 private:
  /// Pieces with their bytes in one buffer, one after the other.
  struct Queue {
    std::vector<Piece> pieces;
    std::vector<std::uint8_t> bytes;
  };

  mutable std::mutex mutex_;
  Queue came_;
  std::uint64_t not_shown_ = 0;
  // On the thread of the viewers.
  Queue taken_;
  std::set<Wire*> untold_;  ///< Wires whose accounts have changed since they were sent.
  std::chrono::steady_clock::time_point accounts_told_;
  SimTime last_{};
};

void RunStream::Wire::hear(SimTime at, bool of_client, const WirePiece& piece) {
  if (!wanted()) {
    return;
  }
  std::visit(
      [&](const auto& kind) {
        using Kind = std::remove_cvref_t<decltype(kind)>;
        if constexpr (requires { kind.bytes; }) {
          std::uint64_t end = 0;
          if constexpr (requires { kind.connection; }) {
            end = kind.connection;
          } else if constexpr (requires { kind.device; }) {
            end = kind.device.port;
          }
          if (!kind.bytes.empty()) {
            stream_.decoder_->put({this, at, of_client, end, kind.bytes});
          }
        } else if constexpr (std::is_same_v<Kind, protocols::can::Frame>) {
          const std::string text = protocols::can::frame_text(kind);
          stream_.decoder_->put(
              {this,
               at,
               of_client,
               0,
               {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}});
        }
      },
      piece);
}

void RunStream::Wire::received(const WirePiece& piece) {
  // Frames of clients are reported again when the bus has carried them.
  if (kind_ != WireKind::can) {
    hear(stream_.now_(), true, piece);
  }
}

bool RunStream::Wire::decode(const Piece& piece) {
  const auto send = [&](const std::optional<Viewers::ChannelId>& channel, const std::string& text) {
    stream_.viewers_.put(*channel, stream_.unix_ns(piece.at), text);
  };
  const auto wanted = [&](const std::optional<Viewers::ChannelId>& channel) {
    return channel && !piece.of_client && stream_.viewers_.wanted(*channel);
  };
  if (wanted(points_)) {
    if (const auto cloud = clouds_->take(piece.at, piece.bytes)) {
      send(points_, cdr_message(*cloud, stream_.run_.start_unix_ns));
    }
  }
  if (wanted(fixes_)) {
    fix_reader_.take(piece.bytes, [&](const ReceiverFix& fix) {
      const Eigen::Vector3d p_W = stream_.run_.frame.to_world(fix.place);
      using Kind = LocationSpread::Kind;
      const LocationSpread spread{fix.sigma_m.value_or(std::array<double, 3>{}),
                                  !fix.sigma_m  ? Kind::unknown
                                  : fix.guessed ? Kind::guessed
                                                : Kind::along_axes};
      send(fixes_,
           location_message(
               timestamp(stream_.run_.start_unix_ns, piece.at), name_, fix.place, spread,
               fmt::format(R"(,"position_m":[{:.4f},{:.4f},{:.4f}])", p_W.x(), p_W.y(), p_W.z())));
    });
  }
  if (wanted(satellites_)) {
    sky_reader_.take(piece.bytes, [&](std::string_view message, std::span<const SkySatellite> sky) {
      send(satellites_, satellites_message(message, sky));
    });
  }
  // At its other port the camera answers questions.
  if (wanted(pictures_) && piece.end != protocols::gige_vision::kGvcpPort) {
    if (const SmallPicture* picture = picture_reader_->take(piece.at, piece.bytes)) {
      send(pictures_,
           picture_message(static_cast<std::int64_t>(stream_.unix_ns(piece.at)), name_, *picture));
    }
  }
  const bool accounts = account_ && stream_.viewers_.wanted(*account_);
  if (accounts || stream_.viewers_.wanted(*messages_)) {
    decode_message(piece);
  }
  return accounts;
}

void RunStream::Wire::decode_message(const Piece& piece) {
  const auto tell = [&](std::span<const std::uint8_t> bytes, const WireReading& reading,
                        const Json& more = Json::object()) {
    if (!stream_.viewers_.wanted(*messages_)) {
      return;
    }
    Json message{{"time_ns", piece.at.time_since_epoch().count()},
                 {"from", piece.of_client ? "client" : "device"},
                 {"size", bytes.size()},
                 {"bytes", hexadecimal(bytes)},
                 {"text", reading.text},
                 {"fields", json_of(reading.fields)}};
    message.update(more);
    if (left_out_ != 0) {
      message["left_out"] = std::exchange(left_out_, 0);
    }
    stream_.viewers_.put(*messages_, stream_.unix_ns(piece.at),
                         message.dump(-1, ' ', false, Json::error_handler_t::replace));
  };
  if (kind_ == WireKind::can) {
    const auto frame =
        protocols::can::parse_frame_text(std::string(piece.bytes.begin(), piece.bytes.end()));
    if (frame) {
      identifiers_.take(*frame, piece.of_client);
    }
    if (frame && stream_.viewers_.wanted(*messages_)) {
      tell(frame->payload(), read_frame(*frame, can_messages_),
           {{"id", identifier_text(*frame)}, {"signals", signals_of(*frame, can_messages_)}});
    }
  } else if (modbus_) {
    modbus_->take(piece.at, piece.end, piece.of_client, piece.bytes,
                  [&](std::span<const std::uint8_t> bytes, const WireReading& reading) {
                    tell(bytes, reading);
                  });
  } else if (fixes_) {
    // Bytes of a satellite receiver are split into messages first.
    (piece.of_client ? of_client_ : of_receiver_)
        .take(piece.bytes, [&](std::span<const std::uint8_t> bytes, const auto& /*content*/) {
          tell(bytes, read_serial(bytes));
        });
  } else if (kind_ == WireKind::serial) {
    tell(piece.bytes, read_serial(piece.bytes));
  } else if (is_to_be_told(piece)) {
    const bool controls = piece.end == protocols::gige_vision::kGvcpPort;
    tell(piece.bytes, !pictures_ ? read_datagram(piece.bytes)
                      : controls ? read_control_packet(piece.bytes)
                                 : read_stream_packet(piece.bytes));
  }
}

bool RunStream::Wire::is_to_be_told(const Piece& piece) {
  const auto now = std::chrono::steady_clock::now();
  if (piece.bytes.size() >= kBulkBytes && now < bulk_told_ + kBulkPeriod) {
    ++left_out_;
    return false;
  }
  bulk_told_ = piece.bytes.size() >= kBulkBytes ? now : bulk_told_;
  return true;
}

void RunStream::Wire::add_account(StreamChannel channel) {
  channel.first = [this] { return account(); };
  account_ = stream_.viewers_.add(std::move(channel));
}

void RunStream::Wire::tell_account(SimTime at) {
  stream_.viewers_.put(*account_, stream_.unix_ns(at), account());
}

RunStream::RunStream(boost::asio::io_context& io, StreamedRun run)
    : io_(io),
      run_(std::move(run)),
      viewers_(run_.name, run_.session),
      ahead_(std::make_unique<Ahead>()),
      decoder_(std::make_unique<Decoder>()),
      timer_(io) {
  const auto rows = channel_rows();
  for (const TruthTrack track : {TruthTrack::truth, TruthTrack::transforms, TruthTrack::location,
                                 TruthTrack::events, TruthTrack::motion, TruthTrack::joints}) {
    const ChannelRow& row = rows[static_cast<std::size_t>(track)];
    tracks_[static_cast<std::size_t>(track)] = viewers_.add(
        {std::string(row.topic), "json", std::string(row.schema_name), row.schema, 32,
         [this, track] {
           return truth_ != nullptr ? truth_->newest(track) : StreamChannel::First{std::string()};
         }});
  }
  scene_channel_ = viewers_.add({"/scene", "json", "foxglove.SceneUpdate", SceneModel::schema(), 64,
                                 [this] { return scene_ ? scene_->whole() : std::string(); }});
  air_channel_ = viewers_.add(
      {"/air", "json", "rigwire.Air", kObjectSchema, 1, [this] { return air_message(air_); }});
  viewers_.add({"/sensors", "json", "rigwire.Sensors", kObjectSchema, 1,
                [text = sensors_message(run_.sensors)] { return text; }});
  viewers_.on_asset([this](std::string_view uri) { return scene_ ? scene_->asset(uri) : nullptr; });
  look();
}

RunStream::~RunStream() = default;

WireTap& RunStream::add_wire(const std::string& name, WireKind kind) {
  wires_.push_back(std::make_unique<Wire>(*this, name, kind));
  return *wires_.back();
}

std::unique_ptr<TruthObserver> RunStream::truth_observer(const Calendar& calendar,
                                                         std::span<const sim::TruthField> fields,
                                                         std::span<const std::string_view> links) {
  auto truth = std::make_unique<Truth>(*this, calendar, fields, links);
  truth_ = truth.get();
  return truth;
}

std::unique_ptr<WorldSensor> RunStream::world_view(const sim::Scene& scene, std::size_t links) {
  scene_.emplace(sim::contents_of(scene), run_.start_unix_ns);
  return make_world_view(links, kScenePeriod, [this](ViewChange change) {
    const SimTime at = change.time;
    ahead_->tell(at, [this, at, change = std::move(change)] {
      if (change.air) {
        air_ = *change.air;
        viewers_.put(air_channel_, unix_ns(at), air_message(air_));
      }
      if (change.changes_the_scene()) {
        viewers_.put(scene_channel_, unix_ns(at), scene_->apply(change));
      }
    });
  });
}

std::unique_ptr<WorldSensor> RunStream::camera_previews(
    const std::vector<PreviewedCamera>& cameras, std::uint64_t seed, const sim::Scene& scene,
    sim::Scene::InstanceId terrain, std::shared_ptr<CameraSurroundings> surroundings) {
  std::vector<PreviewedCamera> shown;
  std::vector<Viewers::ChannelId> channels;
  for (const PreviewedCamera& camera : cameras) {
    for (const auto& wire : wires_) {
      if (wire->name() == camera.name && wire->pictures()) {
        shown.push_back(camera);
        channels.push_back(*wire->pictures());
      }
    }
  }
  if (shown.empty()) {
    return nullptr;
  }
  PreviewViewers viewers;
  viewers.wanted = [this, channels](std::size_t camera) {
    return viewers_.wanted(channels[camera]);
  };
  viewers.show = [this, channels, shown](CameraPreview preview) {
    boost::asio::post(
        io_, [this, camera = shown[preview.camera].name, channel = channels[preview.camera],
              preview = std::move(preview)] { show_preview(camera, channel, preview); });
  };
  viewers.failed = [this](std::string what) {
    // Reported as whatever fails on the thread of the viewers.
    boost::asio::post(io_, [what = std::move(what)] { throw std::runtime_error(what); });
  };
  return make_camera_previews(std::move(shown), seed, scene, terrain, std::move(surroundings),
                              std::move(viewers));
}

void RunStream::show_preview(const std::string& camera, Viewers::ChannelId channel,
                             const CameraPreview& preview) {
  const std::uint64_t at = unix_ns(preview.time);
  viewers_.put(channel, at,
               picture_message(static_cast<std::int64_t>(at), camera, small_picture(preview)));
}

void RunStream::tell(const RunEvent& event) {
  const Viewers::ChannelId channel = tracks_[static_cast<std::size_t>(TruthTrack::events)];
  if (viewers_.wanted(channel)) {
    boost::asio::post(io_, [this, channel, at = unix_ns(event.at),
                            text = log_message(run_.start_unix_ns, event.at, event.level,
                                               kEventKinds[static_cast<std::size_t>(event.kind)],
                                               event.text)] { viewers_.put(channel, at, text); });
  }
}

std::uint64_t RunStream::not_shown() const {
  return decoder_->not_shown();
}

void RunStream::flush() {
  boost::asio::post(io_, [this] { look(); });
}

void RunStream::look() {
  ahead_->tell_until(now_());
  decoder_->decode();
  if (viewers_.figures().viewers != 0) {
    timer_.expires_after(kLookPeriod);
  } else {
    timer_.expires_after(kIdleLookPeriod);
  }
  timer_.async_wait([this](const boost::system::error_code& error) {
    if (!error) {
      look();
    }
  });
}

}  // namespace rigwire::hil
