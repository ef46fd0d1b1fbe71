// Viewers of a run over the Foxglove WebSocket protocol: the run's own page (hil/dashboard/),
// Foxglove, Lichtblick. Channels of messages, services, parameters, assets and the transport bar;
// the code that adds them gives them their meaning.
//
// Slow viewers. A channel's depth limits how many of its messages wait for one viewer; then the
// oldest is dropped, and the number is reported to the viewer. All that waits for one viewer is at
// most kMostBytes. Answers are not dropped: a viewer that asks more than it reads loses its
// connection. The run never waits for a viewer.
//
// Runs on one thread, but for wanted(); callbacks may answer later.
//
// Source: foxglove/ws-protocol, docs/spec.md; protocols/foxglove/frames.h has its binary frames.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "drivers/http_server.h"
#include "protocols/foxglove/frames.h"

namespace rigwire::hil {

struct StreamChannel {
  struct First {
    // NOLINTNEXTLINE(google-explicit-constructor): it is a text, most have no instant.
    First(std::string text, std::uint64_t time = 0) : payload(std::move(text)), time_ns(time) {}
    std::string payload;
    std::uint64_t time_ns;
  };

  std::string topic;
  std::string encoding = "json";
  std::string schema_name;
  std::string schema;
  std::size_t depth = 32;
  /// Returns what a new subscriber receives first; empty: nothing.
  std::function<First()> first{};
  std::string schema_encoding = "jsonschema";
};

struct StreamService {
  using Answer = std::function<void(bool done, const std::string& json)>;
  std::string name;
  std::string text;            ///< One sentence.
  std::string request_schema;  ///< JSON Schema.
  /// JSON in, JSON out; `answer` is called once, now or later.
  std::function<void(std::string_view request, Answer answer)> call;
};

/// Parameters that viewers may read and set.
struct StreamParameter {
  std::string name;
  std::string json;  ///< Its value; empty: it has none at present.
};
struct StreamParameters {
  using Told = std::function<void(const std::vector<StreamParameter>& all)>;
  /// `told` is called once, now or later, with all parameters.
  std::function<void(Told told)> read;
  /// `done` is called once, now or later, with a sentence for each parameter that was refused.
  using Done = std::function<void(const std::vector<std::string>& refused)>;
  std::function<void(const std::vector<StreamParameter>& wanted, Done done)> set;
};

class Viewers {
 public:
  using ChannelId = std::uint32_t;
  /// Maximum size of the frames that wait for one viewer, bytes.
  static constexpr std::size_t kMostBytes = 32 * 1024 * 1024;
  /// Maximum number of answers that wait for one viewer.
  static constexpr std::size_t kMostAnswers = 4096;

  /// `session` identifies this run, so that viewers recognize it.
  Viewers(std::string name, std::string session);
  ~Viewers();
  Viewers(const Viewers&) = delete;
  Viewers& operator=(const Viewers&) = delete;

  // To be called before the first viewer.

  ChannelId add(StreamChannel channel);
  void add(StreamService service);
  /// Returns what messages refer to by "rigwire:..."; null: there is no such thing.
  using Assets = std::function<std::shared_ptr<const std::string>(std::string_view uri)>;
  void on_asset(Assets assets) { assets_ = std::move(assets); }
  void offer(StreamParameters parameters) { parameters_ = std::move(parameters); }
  /// Handles the controls of a viewer's transport bar; `done` is called once, now or later, with
  /// the reason why not all of it is done, empty when it is.
  using Playback = std::function<void(const protocols::foxglove::PlaybackControl& control,
                                      std::function<void(const std::string& why)> done)>;
  void on_playback(Playback playback) { playback_ = std::move(playback); }
  /// Sets the range of the transport bar.
  void set_range(std::uint64_t begin_ns, std::uint64_t end_ns) { range_ = {begin_ns, end_ns}; }

  // To be called from then on.

  /// Answers a request for a WebSocket.
  [[nodiscard]] drivers::WebSocketAnswer admit(const drivers::HttpRequest& request);
  /// Returns whether the channel has a subscriber. May be called from any thread.
  [[nodiscard]] bool wanted(ChannelId channel) const {
    return channels_[channel].subscribers.load(std::memory_order_relaxed) != 0;
  }
  /// Returns whether any channel has a subscriber. May be called from any thread.
  [[nodiscard]] bool anything_wanted() const {
    return std::ranges::any_of(channels_, [](const Channel& channel) {
      return channel.subscribers.load(std::memory_order_relaxed) != 0;
    });
  }
  void put(ChannelId channel, std::uint64_t time_ns, std::string_view payload);
  /// Publishes the present time, and what was dropped meanwhile.
  void tick(std::uint64_t time_ns);
  /// Sends the parameters that have changed since the last call to their subscribers.
  void tell_parameters();
  /// Publishes the state of the transport bar; `request` is that of the viewer that asked, else
  /// empty. `did_seek`: time was moved by it.
  void tell_playback(protocols::foxglove::PlaybackStatus status, std::uint64_t time_ns, float speed,
                     bool did_seek, std::string_view request);

  struct Figures {
    std::size_t viewers = 0;
    std::uint64_t sent = 0;     ///< Messages of channels that were sent.
    std::uint64_t dropped = 0;  ///< Messages that were dropped because a viewer was too slow.
  };
  [[nodiscard]] Figures figures() const;

 private:
  class Viewer;
  struct Channel {
    StreamChannel about;
    std::atomic<unsigned> subscribers{0};
  };

  [[nodiscard]] std::string server_info() const;
  [[nodiscard]] std::string advertisement() const;
  [[nodiscard]] std::string services_advertisement() const;

  std::string name_;
  std::string session_;
  std::deque<Channel> channels_;
  std::vector<StreamService> services_;
  Assets assets_;
  std::optional<StreamParameters> parameters_;
  Playback playback_;
  std::optional<std::pair<std::uint64_t, std::uint64_t>> range_;
  std::vector<std::shared_ptr<Viewer>> viewers_;
  std::uint64_t sent_ = 0;
  std::uint64_t dropped_ = 0;
};

}  // namespace rigwire::hil
