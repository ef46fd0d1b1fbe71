#include "hil/stream/viewers.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "hil/configuration/plain_text.h"
#include "hil/stream/viewer_json.h"

namespace rigwire::hil {
namespace {

namespace foxglove = protocols::foxglove;
using Json = nlohmann::ordered_json;

constexpr int kWarning = 1;  // Levels of `status`.
constexpr int kError = 2;

std::string text_of(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Json time_of(std::uint64_t ns) {
  return {{"sec", ns / 1'000'000'000}, {"nsec", ns % 1'000'000'000}};
}

/// Returns the first known subprotocol among those in a client's header; empty: none.
std::string chosen_subprotocol(std::string_view offered) {
  for (const std::string_view known : foxglove::kSubprotocols) {
    for (std::size_t from = 0; from < offered.size();) {
      const std::size_t end = std::min(offered.find(',', from), offered.size());
      std::string_view one = offered.substr(from, end - from);
      while (one.starts_with(' ')) {
        one.remove_prefix(1);
      }
      while (one.ends_with(' ')) {
        one.remove_suffix(1);
      }
      if (one == known) {
        return std::string(known);
      }
      from = end + 1;
    }
  }
  return {};
}

std::optional<std::uint32_t> number_of(const Json& json, const char* key) {
  const auto found = json.find(key);
  if (found == json.end() || !found->is_number_unsigned() ||
      found->get<std::uint64_t>() > 0xFFFF'FFFFU) {
    return std::nullopt;
  }
  return found->get<std::uint32_t>();
}

}  // namespace

/// One of them: what it has subscribed to, and what waits for it.
class Viewers::Viewer : public std::enable_shared_from_this<Viewer> {
 public:
  Viewer(Viewers& all, std::shared_ptr<drivers::WebSocket> socket)
      : all_(&all), socket_(std::move(socket)) {
    answer_text(all.server_info());
    answer_text(all.advertisement());
    answer_text(all.services_advertisement());
  }

  void put(ChannelId channel, std::uint64_t time_ns, std::string_view payload) {
    for (auto& [id, subscription] : subscriptions_) {
      if (subscription.channel == channel) {
        enqueue(id, subscription,
                std::make_shared<const std::string>(foxglove::message_frame(id, time_ns, payload)));
      }
    }
    socket_->wake();
  }

  void tick(std::uint64_t time_ns) {
    time_ = std::make_shared<const std::string>(foxglove::time_frame(time_ns));
    if (dropped_ != told_dropped_) {
      answer_text(text_of({{"op", "status"},
                           {"level", kWarning},
                           {"id", "dropped"},
                           {"message", fmt::format("this viewer is too slow: {} messages were "
                                                   "dropped",
                                                   dropped_)}}));
      told_dropped_ = dropped_;
    }
    socket_->wake();
  }

  void answer(std::string frame) { answer({false, share(std::move(frame))}); }

  void receive(bool text, std::string_view bytes) {
    if (text) {
      receive_text(bytes);
    } else {
      receive_frame(bytes);
    }
    socket_->wake();
  }

  drivers::WebSocketMessage next() {
    if (!answers_.empty()) {
      drivers::WebSocketMessage message = std::move(answers_.front());
      answers_.pop_front();
      return message;
    }
    if (time_) {
      return {false, std::exchange(time_, nullptr)};
    }
    if (!asset_requests_.empty()) {
      const auto [request, uri] = std::move(asset_requests_.front());
      asset_requests_.pop_front();
      return {false, share(asset(request, uri))};
    }
    if (!waiting_.empty()) {
      Waiting front = std::move(waiting_.front());
      waiting_.pop_front();
      bytes_ -= front.frame->size();
      if (const auto found = subscriptions_.find(front.subscription);
          found != subscriptions_.end()) {
        --found->second.waiting;
      }
      ++all_->sent_;
      return {false, std::move(front.frame)};
    }
    return {};
  }

  [[nodiscard]] bool follows_parameters() const { return !followed_.empty(); }
  void tell_parameters(const std::vector<StreamParameter>& now) {
    std::vector<StreamParameter> changed;
    for (const StreamParameter& one : now) {
      const auto told = followed_.find(one.name);
      if (told != followed_.end() && told->second != one.json) {
        told->second = one.json;
        changed.push_back(one);
      }
    }
    if (!changed.empty()) {
      answer_parameters(changed, std::nullopt);
    }
  }

  /// It is gone.
  void leave() {
    for (const auto& [id, subscription] : subscriptions_) {
      --all_->channels_[subscription.channel].subscribers;
    }
    subscriptions_.clear();
  }
  void close() { socket_->close(); }

 private:
  struct Subscription {
    ChannelId channel = 0;
    std::size_t waiting = 0;
  };
  struct Waiting {
    std::uint32_t subscription = 0;
    std::shared_ptr<const std::string> frame;
  };

  static std::shared_ptr<const std::string> share(std::string text) {
    return std::make_shared<const std::string>(std::move(text));
  }
  void answer_text(std::string text) { answer({true, share(std::move(text))}); }
  void answer(drivers::WebSocketMessage message) {
    if (answers_.size() >= kMostAnswers) {
      socket_->close();
      return;
    }
    answers_.push_back(std::move(message));
    socket_->wake();
  }
  void complain(const std::string& what) {
    answer_text(text_of({{"op", "status"}, {"level", kError}, {"message", printable(what)}}));
  }

  void enqueue(std::uint32_t id, Subscription& subscription,
               std::shared_ptr<const std::string> frame) {
    const std::size_t depth = all_->channels_[subscription.channel].about.depth;
    if (subscription.waiting >= depth) {
      drop(std::ranges::find(waiting_, id, &Waiting::subscription));
    }
    bytes_ += frame->size();
    ++subscription.waiting;
    waiting_.push_back({id, std::move(frame)});
    while (bytes_ > kMostBytes && waiting_.size() > 1) {
      drop(waiting_.begin());
    }
  }
  void drop(std::deque<Waiting>::iterator which) {
    bytes_ -= which->frame->size();
    if (const auto found = subscriptions_.find(which->subscription);
        found != subscriptions_.end()) {
      --found->second.waiting;
    }
    waiting_.erase(which);
    ++dropped_;
    ++all_->dropped_;
  }

  std::string asset(std::uint32_t request, const std::string& uri) {
    const auto data = all_->assets_ ? all_->assets_(uri) : nullptr;
    return data ? foxglove::asset_frame(request, *data)
                : foxglove::asset_error_frame(request, "there is no " + printable(uri));
  }

  void receive_text(std::string_view bytes) {
    std::string why;
    const auto object = viewer_object(bytes, why);
    if (!object || !object->contains("op") || !(*object)["op"].is_string()) {
      complain("a message that is no JSON object with a text `op`" +
               (why.empty() ? "" : ": " + why));
      return;
    }
    const Json& json = *object;
    const auto op = json["op"].get<std::string>();
    if (op == "subscribe") {
      each(json, "subscriptions", [this](const Json& one) { subscribe(one); });
    } else if (op == "unsubscribe") {
      each(json, "subscriptionIds", [this](const Json& one) {
        if (one.is_number_unsigned()) {
          unsubscribe(one.get<std::uint64_t>());
        }
      });
    } else if (op == "fetchAsset") {
      fetch(json);
    } else if (!(all_->parameters_ && receive_of_parameters(op, json))) {
      complain(fmt::format("found op {}, allowed subscribe, unsubscribe, fetchAsset{}",
                           printable(op),
                           all_->parameters_ ? ", getParameters, setParameters, "
                                               "subscribeParameterUpdates, "
                                               "unsubscribeParameterUpdates"
                                             : ""));
    }
  }

  template <class Use>
  void each(const Json& json, const char* key, const Use& use) {
    const auto found = json.find(key);
    if (found == json.end() || !found->is_array()) {
      complain(fmt::format("no list `{}`", key));
      return;
    }
    for (const Json& one : *found) {
      use(one);
    }
  }

  void subscribe(const Json& one) {
    const auto id = one.is_object() ? number_of(one, "id") : std::nullopt;
    const auto channel = one.is_object() ? number_of(one, "channelId") : std::nullopt;
    if (!id || !channel || *channel >= all_->channels_.size() || subscriptions_.contains(*id) ||
        subscriptions_.size() >= kMostAnswers) {
      complain("a subscription needs an `id` that is new and the `channelId` of a channel, found " +
               text_of(one));
      return;
    }
    subscriptions_[*id] = {*channel, 0};
    Channel& subscribed = all_->channels_[*channel];
    ++subscribed.subscribers;
    if (subscribed.about.first) {
      if (const auto first = subscribed.about.first(); !first.payload.empty()) {
        answer(foxglove::message_frame(*id, first.time_ns, first.payload));
      }
    }
  }

  void unsubscribe(std::uint64_t id) {
    const auto found = subscriptions_.find(static_cast<std::uint32_t>(id));
    if (id > 0xFFFF'FFFFU || found == subscriptions_.end()) {
      complain(fmt::format("found subscription {}, which there is not", id));
      return;
    }
    --all_->channels_[found->second.channel].subscribers;
    subscriptions_.erase(found);
    std::erase_if(waiting_, [&](const Waiting& waiting) {
      const bool gone = waiting.subscription == id;
      bytes_ -= gone ? waiting.frame->size() : 0;
      return gone;
    });
  }

  void fetch(const Json& json) {
    const auto request = number_of(json, "requestId");
    const auto uri = json.find("uri");
    if (!request || uri == json.end() || !uri->is_string()) {
      complain("fetchAsset needs `requestId` and `uri`");
    } else if (asset_requests_.size() >= kMostAnswers) {
      socket_->close();
    } else {
      asset_requests_.emplace_back(*request, uri->get<std::string>());
    }
  }

  /// False: it is none of that kind.
  bool receive_of_parameters(const std::string& op, const Json& json) {
    if (op == "getParameters") {
      names(json, [&](const std::vector<std::string>& asked) {
        read_parameters(asked, [id = request_id(json)](Viewer& self, const auto& parameters) {
          self.answer_parameters(parameters, id);
        });
      });
    } else if (op == "setParameters") {
      set_parameters(json);
    } else if (op == "subscribeParameterUpdates") {
      names(json, [this](const std::vector<std::string>& asked) {
        read_parameters(asked, [](Viewer& self, const auto& parameters) {
          for (const StreamParameter& one : parameters) {
            self.followed_.try_emplace(one.name, one.json);
          }
        });
      });
    } else if (op == "unsubscribeParameterUpdates") {
      names(json, [this](const std::vector<std::string>& asked) {
        if (asked.empty()) {
          followed_.clear();
        }
        for (const std::string& name : asked) {
          if (followed_.erase(name) == 0) {
            complain("found parameter " + name + ", which is not subscribed to");
          }
        }
      });
    } else {
      return false;
    }
    return true;
  }

  /// use(the list of texts `parameterNames`), if that is one.
  template <class Use>
  void names(const Json& json, const Use& use) {
    std::vector<std::string> all;
    const auto found = json.find("parameterNames");
    if (found == json.end() || !found->is_array() ||
        !std::ranges::all_of(*found, [](const Json& one) { return one.is_string(); })) {
      complain("no list of texts `parameterNames`");
      return;
    }
    for (const Json& one : *found) {
      all.push_back(one.get<std::string>());
    }
    use(all);
  }

  static std::optional<std::string> request_id(const Json& json) {
    const auto found = json.find("id");
    return found != json.end() && found->is_string() ? std::optional(found->get<std::string>())
                                                     : std::nullopt;
  }

  /// use(this, those of these names, of no names all), once they are known; complains of what there
  /// is not.
  template <class Use>
  void read_parameters(const std::vector<std::string>& names, const Use& use) {
    all_->parameters_->read(
        [viewer = weak_from_this(), names, use](const std::vector<StreamParameter>& all) {
          const auto self = viewer.lock();
          if (!self) {
            return;
          }
          for (const std::string& name : names) {
            if (std::ranges::count(all, name, &StreamParameter::name) == 0) {
              self->complain("there is no parameter " + name);
            }
          }
          use(*self, names.empty() ? all : named(all, names));
        });
  }

  static std::vector<StreamParameter> named(std::vector<StreamParameter> all,
                                            const std::vector<std::string>& names) {
    std::erase_if(
        all, [&](const StreamParameter& one) { return std::ranges::count(names, one.name) == 0; });
    return all;
  }

  void answer_parameters(const std::vector<StreamParameter>& parameters,
                         const std::optional<std::string>& id) {
    Json list = Json::array();
    for (const StreamParameter& one : parameters) {
      Json& told = list.emplace_back(Json{{"name", one.name}});
      if (!one.json.empty()) {
        told["value"] = Json::parse(one.json);
        if (told["value"].is_number()) {
          told["type"] = "float64";
        }
      }
    }
    Json message{{"op", "parameterValues"}, {"parameters", std::move(list)}};
    if (id) {
      message["id"] = *id;
    }
    answer_text(text_of(message));
  }

  void set_parameters(const Json& json) {
    const auto found = json.find("parameters");
    if (found == json.end() || !found->is_array()) {
      complain("no list `parameters`");
      return;
    }
    std::vector<StreamParameter> wanted;
    std::vector<std::string> asked;
    for (const Json& one : *found) {
      const auto name = one.is_object() ? one.find("name") : one.end();
      if (name == one.end() || !name->is_string()) {
        complain("a parameter needs a text `name`");
        return;
      }
      const auto type = one.find("type");
      static const Json kNone;
      const auto found_value = one.find("value");
      const Json& value = found_value == one.end() ? kNone : *found_value;
      const bool plain = value.is_primitive() ||
                         (value.is_array() && std::ranges::all_of(value, [](const Json& item) {
                            return item.is_primitive();
                          }));
      if (!plain || (type != one.end() && *type == "byte_array")) {
        complain(printable(name->get<std::string>()) +
                 " has another value than numbers, texts, true and false, and lists of them");
        return;
      }
      asked.push_back(name->get<std::string>());
      wanted.push_back({asked.back(), value.is_null() ? std::string() : text_of(value)});
    }
    all_->parameters_->set(wanted, [viewer = weak_from_this(), asked, id = request_id(json)](
                                       const std::vector<std::string>& refused) {
      if (const auto self = viewer.lock()) {
        for (const std::string& why : refused) {
          self->complain(why);
        }
        if (id) {
          self->all_->parameters_->read([viewer, asked, id](const auto& all) {
            if (const auto answering = viewer.lock()) {
              answering->answer_parameters(named(all, asked), id);
            }
          });
        }
      }
    });
  }

  void receive_frame(std::string_view bytes) {
    const auto frame = foxglove::decode_client_frame(bytes);
    if (!frame.ok()) {
      complain(fmt::format("a binary frame that is none: expected {} at byte {}",
                           frame.fault().reason, frame.fault().offset));
    } else if (const auto* request = std::get_if<foxglove::ServiceRequest>(&*frame)) {
      call(*request);
    } else if (const auto* control = std::get_if<foxglove::PlaybackControl>(&*frame)) {
      const auto done = [viewer = weak_from_this()](const std::string& why) {
        if (const auto self = viewer.lock(); self && !why.empty()) {
          self->complain(why);
        }
      };
      if (all_->playback_) {
        all_->playback_(*control, done);
      } else {
        done("this run has no transport bar");
      }
    }
  }

  void call(const foxglove::ServiceRequest& request) {
    const auto fail = [this, service = request.service, call = request.call](std::string what) {
      answer_text(text_of({{"op", "serviceCallFailure"},
                           {"serviceId", service},
                           {"callId", call},
                           {"message", std::move(what)}}));
    };
    if (request.service >= all_->services_.size()) {
      fail(fmt::format("found service {}, allowed 0 to {}", request.service,
                       all_->services_.size() - 1));
      return;
    }
    if (request.encoding != "json") {
      fail(fmt::format("found encoding {}, allowed json", printable(request.encoding)));
      return;
    }
    all_->services_[request.service].call(
        request.payload, [viewer = weak_from_this(), service = request.service,
                          call = request.call](bool done, const std::string& json) {
          if (const auto self = viewer.lock()) {
            if (done) {
              self->answer(foxglove::service_response_frame(service, call, "json", json));
            } else {
              self->answer_text(text_of({{"op", "serviceCallFailure"},
                                         {"serviceId", service},
                                         {"callId", call},
                                         {"message", json}}));
            }
          }
        });
  }

  Viewers* all_;
  std::shared_ptr<drivers::WebSocket> socket_;
  std::map<std::uint32_t, Subscription> subscriptions_;
  std::deque<drivers::WebSocketMessage> answers_;
  std::deque<std::pair<std::uint32_t, std::string>> asset_requests_;
  /// Subscribed parameters, and the value last sent.
  std::map<std::string, std::string> followed_;
  std::shared_ptr<const std::string> time_;
  std::deque<Waiting> waiting_;  ///< Waiting messages of channels.
  std::size_t bytes_ = 0;        ///< Their size.
  std::uint64_t dropped_ = 0;
  std::uint64_t told_dropped_ = 0;
};

Viewers::Viewers(std::string name, std::string session)
    : name_(std::move(name)), session_(std::move(session)) {}

Viewers::~Viewers() = default;

Viewers::ChannelId Viewers::add(StreamChannel channel) {
  channels_.emplace_back().about = std::move(channel);
  return static_cast<ChannelId>(channels_.size() - 1);
}

void Viewers::add(StreamService service) {
  services_.push_back(std::move(service));
}

drivers::WebSocketAnswer Viewers::admit(const drivers::HttpRequest& request) {
  const std::string subprotocol = chosen_subprotocol(request.subprotocols);
  drivers::WebSocketAnswer answer;
  if (subprotocol.empty()) {
    answer.refusal = {
        400,
        "text/plain",
        fmt::format("found subprotocols \"{}\", allowed {}\n", printable(request.subprotocols),
                    fmt::join(foxglove::kSubprotocols, ", ")),
        {},
        true};
    return answer;
  }
  answer.subprotocol = subprotocol;
  answer.open = [this](std::shared_ptr<drivers::WebSocket> socket) {
    auto viewer = std::make_shared<Viewer>(*this, std::move(socket));
    viewers_.push_back(viewer);
    return drivers::WebSocket::Owner{
        [viewer] { return viewer->next(); },
        [viewer](bool text, std::string_view bytes) { viewer->receive(text, bytes); },
        [this, viewer] {
          viewer->leave();
          std::erase(viewers_, viewer);
        }};
  };
  return answer;
}

void Viewers::put(ChannelId channel, std::uint64_t time_ns, std::string_view payload) {
  if (wanted(channel)) {
    for (const auto& viewer : std::vector(viewers_)) {
      viewer->put(channel, time_ns, payload);
    }
  }
}

void Viewers::tick(std::uint64_t time_ns) {
  for (const auto& viewer : std::vector(viewers_)) {
    viewer->tick(time_ns);
  }
}

void Viewers::tell_parameters() {
  const auto follow = [](const auto& viewer) { return viewer->follows_parameters(); };
  if (parameters_ && std::ranges::any_of(viewers_, follow)) {
    parameters_->read([this](const std::vector<StreamParameter>& now) {
      for (const auto& viewer : std::vector(viewers_)) {
        viewer->tell_parameters(now);
      }
    });
  }
}

void Viewers::tell_playback(foxglove::PlaybackStatus status, std::uint64_t time_ns, float speed,
                            bool did_seek, std::string_view request) {
  for (const auto& viewer : std::vector(viewers_)) {
    viewer->answer(foxglove::playback_state_frame(status, time_ns, speed, did_seek, request));
  }
}

Viewers::Figures Viewers::figures() const {
  return {viewers_.size(), sent_, dropped_};
}

std::string Viewers::server_info() const {
  Json capabilities{"time"};
  if (!services_.empty()) {
    capabilities.push_back("services");
  }
  if (parameters_) {
    capabilities.push_back("parameters");
    capabilities.push_back("parametersSubscribe");
  }
  if (assets_) {
    capabilities.push_back("assets");
  }
  Json info{{"op", "serverInfo"},
            {"name", name_},
            {"supportedEncodings", {"json"}},
            {"metadata", Json::object()},
            {"sessionId", session_}};
  if (playback_ && range_) {
    capabilities.push_back("playbackControl");
    info["dataStartTime"] = time_of(range_->first);
    info["dataEndTime"] = time_of(range_->second);
  }
  info["capabilities"] = std::move(capabilities);
  return text_of(info);
}

std::string Viewers::advertisement() const {
  Json channels = Json::array();
  for (std::size_t id = 0; id < channels_.size(); ++id) {
    const StreamChannel& about = channels_[id].about;
    channels.push_back({{"id", id},
                        {"topic", about.topic},
                        {"encoding", about.encoding},
                        {"schemaName", about.schema_name},
                        {"schema", about.schema},
                        {"schemaEncoding", about.schema_encoding}});
  }
  return text_of({{"op", "advertise"}, {"channels", std::move(channels)}});
}

std::string Viewers::services_advertisement() const {
  Json services = Json::array();
  for (std::size_t id = 0; id < services_.size(); ++id) {
    const StreamService& service = services_[id];
    const auto schema = [](const std::string& name, const std::string& text) {
      return Json{{"encoding", "json"},
                  {"schemaName", name},
                  {"schemaEncoding", "jsonschema"},
                  {"schema", text}};
    };
    const std::string type = "rigwire." + service.name.substr(1);
    services.push_back({{"id", id},
                        {"name", service.name},
                        {"type", type},
                        {"request", schema(type + "_Request", service.request_schema)},
                        {"response", schema(type + "_Response", R"({"type":"object"})")}});
  }
  return text_of({{"op", "advertiseServices"}, {"services", std::move(services)}});
}

}  // namespace rigwire::hil
