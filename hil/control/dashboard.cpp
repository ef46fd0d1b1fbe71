#include "hil/control/dashboard.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <tuple>
#include <utility>
#include <variant>

#include "emulators/valve_driver/valve_driver.h"
#include "fields/chosen.h"
#include "hil/configuration/document.h"
#include "hil/configuration/outline.h"
#include "hil/configuration/reader.h"
#include "hil/configuration/schema.h"
#include "hil/control/live_changes.h"
#include "hil/control/showing.h"
#include "hil/devices/gige_camera.h"
#include "hil/devices/valve_driver.h"
#include "hil/devices/velodyne.h"
#include "hil/record/run_events.h"
#include "hil/stream/viewer_json.h"
#include "sim/camera/camera_kinds.h"
#include "sim/camera/lens.h"

namespace rigwire::hil {
namespace {

namespace foxglove = protocols::foxglove;
using Json = nlohmann::ordered_json;

/// Wall time between two times sent to the viewers.
constexpr std::chrono::milliseconds kTick{100};
/// Number of ticks between two states of the run.
constexpr unsigned kTicksPerStatus = 5;
/// Minimum period of the truth in the stream, simulated time.
constexpr Duration kTruthPeriod = std::chrono::milliseconds{20};

/// A service for each alternative of Command, named as its verb.
template <class... Each>
std::vector<StreamService> services_of(std::variant<Each...>* /*command*/) {
  return {StreamService{"/" + std::string(Each::kNamed.name),
                        std::string(Each::kNamed.text),
                        schema_of(Each{}, Each::kNamed.text),
                        {}}...};
}

/// Where a device sits on the machine, by its keys, whatever its type; nothing: it does not.
std::optional<MountConfiguration> mount_of(const OutlineNode& keys) {
  const auto found = std::ranges::find(keys.children, "mount", &OutlineNode::key);
  if (found == keys.children.end()) {
    return std::nullopt;
  }
  Problems problems;
  Origins origins;
  const Value document = parse_request(print_yaml(*found, origins), "mount", problems);
  MountConfiguration mount;
  Reader(document, problems, origins).read(fields::Part::of(mount));
  problems.throw_if_any();
  return mount;
}

/// A value as a rig's file has it: numbers, true and false as such, everything else as texts.
std::string json_of_yaml(const std::string& yaml) {
  Problems problems;
  const Value value = parse_request(yaml, "value", problems);
  const auto json_of = [](const Value& one) {
    const Json json = Json::parse(one.scalar, nullptr, false);
    return json.is_number() || json.is_boolean() ? json : Json(one.scalar);
  };
  if (value.kind == Value::Kind::list) {
    Json list = Json::array();
    for (const Value& one : value.items) {
      list.push_back(one.scalar);
    }
    return list.dump();
  }
  return value.kind == Value::Kind::scalar ? json_of(value).dump() : std::string();
}

/// On the thread of the viewers.
std::vector<StreamParameter> parameters_of(const std::vector<LiveChanges::Setting>& settings) {
  std::vector<StreamParameter> all;
  for (const LiveChanges::Setting& setting : settings) {
    all.push_back({setting.on + "." + setting.key, json_of_yaml(setting.value)});
  }
  return all;
}

/// On the thread of the viewers. What is of one thing goes in one request, since its keys may only
/// fit together.
std::vector<ParameterRequest> parameter_requests(const std::vector<StreamParameter>& wanted,
                                                 std::vector<std::string>& refused) {
  if (wanted.size() > kMaximumRequestKeys) {
    refused.push_back(fmt::format("found {} parameters, allowed at most {} at once", wanted.size(),
                                  kMaximumRequestKeys));
    return {};
  }
  std::map<std::string, Json> of_each;
  for (const StreamParameter& one : wanted) {
    const std::size_t dot = one.name.find('.');
    if (dot == std::string::npos) {
      refused.push_back("there is no parameter " + shortened(one.name));
    } else {
      of_each[one.name.substr(0, dot)][one.name.substr(dot + 1)] =
          one.json.empty() ? Json(nullptr) : Json::parse(one.json);
    }
  }
  std::vector<ParameterRequest> requests;
  for (const auto& [on, keys] : of_each) {
    requests.push_back({on, parse_command(Json{{"verb", "set"}, {"on", on}, {"set", keys}}.dump(
                                              -1, ' ', false, Json::error_handler_t::replace),
                                          "the parameters")});
  }
  return requests;
}

/// Why something was refused, in one sentence.
std::string said(const Reply& reply) {
  const Json json = Json::parse(reply.json);
  std::string text = json.value("what", "refused");
  for (const char* const key : {"found", "allowed"}) {
    if (const std::string words = json.value(key, ""); !words.empty()) {
      text += fmt::format(", {} {}", key, words);
    }
  }
  return text;
}

bool has_key(const OutlineNode& keys, std::string_view key) {
  return std::ranges::any_of(keys.children, [&](const OutlineNode& child) {
    return child.key == key || (child.key == "sensor" && has_key(child, key));
  });
}

/// Returns a camera's fields of view across and down the middle of its picture, rad.
std::pair<double, double> view_of(const sim::CameraKind& kind) {
  if (const auto* const round = std::get_if<sim::AllRoundCameraParameters>(&kind)) {
    constexpr double kRound = 2.0 * std::numbers::pi;
    return {kRound, kRound * round->height_px / round->width_px};
  }
  const sim::CameraParameters& optics = sim::optics_of(kind);
  const double width = optics.sensor.width_px;
  const double height = optics.sensor.height_px;
  const sim::Lens lens(optics.lens, optics.sensor.pixel_pitch_m, optics.sensor.width_px,
                       optics.sensor.height_px);
  const auto between = [&](const Eigen::Vector2d& one, const Eigen::Vector2d& other) {
    const auto from = lens.direction(one);
    const auto to = lens.direction(other);
    // What the lens leaves black has no direction.
    return from && to ? std::acos(std::clamp(from->dot(*to), -1.0, 1.0))
                      : 2.0 * optics.lens.image_circle_rad;
  };
  return {between({0.0, 0.5 * height}, {width - 1.0, 0.5 * height}),
          between({0.5 * width, 0.0}, {0.5 * width, height - 1.0})};
}

/// From where to where a camera's disparities are searched, or its distances measured: near is
/// white.
std::optional<CoordinateScale> coordinates_of(const sim::CameraKind& kind) {
  const auto geometry = sim::abilities_of(kind).geometry;
  if (!geometry) {
    return std::nullopt;
  }
  if (const auto* const stereo = std::get_if<sim::StereoCameraParameters>(&kind)) {
    const double least = stereo->matching.least_disparity;
    return CoordinateScale{geometry->coding, "disparity", "px", least,
                           least + stereo->matching.disparities};
  }
  if (const auto* const depth = std::get_if<sim::DepthCameraParameters>(&kind)) {
    return CoordinateScale{geometry->coding, "range", "m", depth->farthest_m, depth->nearest_m};
  }
  return std::nullopt;
}

/// What is rendered for viewers while no client takes the pictures.
std::vector<PreviewedCamera> previewed_cameras(const RigConfiguration& configuration,
                                               const Rig& rig) {
  std::vector<PreviewedCamera> cameras;
  for (const auto& [name, station] : rig.camera_stations()) {
    const auto found = configuration.devices.find(name);
    const auto* const camera = found == configuration.devices.end()
                                   ? nullptr
                                   : fields::as<GigeCameraConfiguration>(found->second);
    if (camera != nullptr) {
      cameras.push_back({name, station, sensor_mount(configuration.machine, camera->mount),
                         camera->sees_own_link, camera->sensor, power_on_command(*camera)});
    }
  }
  return cameras;
}

std::vector<ShownSensor> shown_sensors(const RigConfiguration& configuration) {
  std::vector<ShownSensor> sensors;
  for (const auto& [name, device] : configuration.devices) {
    const auto copy = device->copy();
    const OutlineNode keys = outline_part(fields::Part::of(*copy));
    const auto mount = mount_of(keys);
    const auto* const lidar = fields::as<VelodyneConfiguration>(device);
    const auto* const camera = fields::as<GigeCameraConfiguration>(device);
    const bool inertial = has_key(keys, "gyroscope");
    if (!mount || !(lidar || camera || inertial || device->is_receiver())) {
      continue;
    }
    ShownSensor& shown = sensors.emplace_back();
    shown.name = name;
    shown.kind = camera ? "camera" : lidar ? "lidar" : device->is_receiver() ? "receiver" : "imu";
    shown.link = mount->link;
    shown.X_LS = sensor_mount(configuration.machine, *mount).X_LS;
    if (camera != nullptr) {
      std::tie(shown.horizontal_rad, shown.vertical_rad) = view_of(camera->sensor);
      shown.coordinates = coordinates_of(camera->sensor);
    }
  }
  return sensors;
}

/// The valve drivers of a line, or the one with a line of its own, of that name.
std::vector<NamedUnit> named_units(const RigConfiguration& configuration, const std::string& wire) {
  std::vector<NamedUnit> units;
  for (const auto& [name, device] : configuration.devices) {
    const auto* const valves = fields::as<ValveDriverConfiguration>(device);
    if (valves != nullptr && wire == (valves->line.empty() ? name : valves->line)) {
      const auto settings = driver_settings(*valves);
      units.push_back({name, valves->unit, settings.amplifier.sections,
                       emulators::ValveDriver(settings).map()});
    }
  }
  return units;
}

/// The whole of a recording that is shown: its end, and its events as `/events` has them.
std::string told_of(const Rerun& recording) {
  Json events = Json::array();
  for (const RecordedAct& event : recording.events()) {
    events.push_back({{"time_ns", (event.at - kStart).count()},
                      {"log", Json::parse(event.text, nullptr, false)}});
  }
  return Json{{"end_ns", (recording.end() - kStart).count()}, {"events", std::move(events)}}.dump();
}

}  // namespace

StreamedRun streamed_run(const RigConfiguration& configuration, const std::string& session) {
  StreamedRun run{
      configuration.name,
      session,
      unix_time(configuration.start).count(),
      make_local_frame(configuration.origin),
      recorded_clouds(configuration).lidars,
      {},
      [&configuration](const std::string& bus) { return bus_messages(configuration, bus); },
      [&configuration](const std::string& wire) { return named_units(configuration, wire); },
      shown_sensors(configuration)};
  for (const auto& [name, device] : configuration.devices) {
    if (device->is_receiver()) {
      run.receivers.insert(name);
    }
  }
  return run;
}

Dashboard::Dashboard(boost::asio::io_context& io, RunStream& stream, Rig& rig,
                     const RigConfiguration& configuration, std::optional<Duration> duration)
    : viewers_thread_(io, stream.io()),
      desk_thread_(stream.io(), io),
      timer_(io),
      stream_(stream),
      executive_(rig.executive()),
      duration_(duration) {
  const sim::Machine& machine = rig.world().machine();
  const Duration period =
      configuration.step * ((kTruthPeriod + configuration.step - Duration{1}) / configuration.step);
  rig.world().add_truth_observer(
      stream.truth_observer(rig.calendar(), machine.truth_fields(), machine.link_names()), period);
  rig.world().add(stream.world_view(rig.world().scene(), machine.link_names().size()));
  if (auto previews = stream.camera_previews(previewed_cameras(configuration, rig),
                                             configuration.seed, rig.world().scene(),
                                             rig.world().terrain(), rig.more_surroundings())) {
    rig.world().add(std::move(previews));
  }
  stream.follow([this] { return executive_.reached(); });
}

Dashboard::~Dashboard() = default;

void Dashboard::serve(Desk& desk) {
  desk_ = &desk;
  Viewers& viewers = stream_.viewers();
  status_ = viewers.add({"/status", "json", "rigwire.Status", R"({"type":"object"})", 1});
  if (desk.shown() != nullptr) {
    viewers.add({"/recorded", "json", "rigwire.Recorded", R"({"type":"object"})", 1,
                 [told = told_of(desk.shown()->rerun())] { return told; }});
  }
  offer_commands();
  viewers.offer({[this](const StreamParameters::Told& told) {
                   const auto answer = [told](const std::vector<LiveChanges::Setting>& settings) {
                     told(parameters_of(settings));
                   };
                   desk_thread_.go([this, answer = desk_thread_.back(answer)] {
                     answer(desk_->changes().settings());
                   });
                 },
                 [this](const auto& wanted, const auto& done) {
                   std::vector<std::string> refused;
                   auto requests = parameter_requests(wanted, refused);
                   desk_thread_.go([this, requests = std::move(requests),
                                    refused = std::move(refused),
                                    done = desk_thread_.back(done)]() mutable {
                     set_parameters(std::move(requests), std::move(refused), done);
                   });
                 }});
  if (duration_) {
    viewers.set_range(stream_.unix_ns(kStart), stream_.unix_ns(kStart + *duration_));
    viewers.on_playback([this](const auto& control, const auto& done) {
      desk_thread_.go(
          [this, control, done = desk_thread_.back(done)] { done(control_playback(control)); });
    });
  }
  tick();
}

void Dashboard::offer_commands() {
  for (StreamService& service : services_of(static_cast<Command*>(nullptr))) {
    service.call = [this, verb = service.name.substr(1)](std::string_view request,
                                                         const StreamService::Answer& answer) {
      std::string why;
      const auto json = viewer_object(request, why);
      if (!json) {
        answer(false, why);
        return;
      }
      const auto replied = desk_thread_.back([answer](const Reply& reply) {
        const bool done = reply.outcome == Reply::Outcome::done;
        answer(done, done ? reply.json : said(reply));
      });
      ParsedRequest parsed = parse_command(
          json->dump(-1, ' ', false, Json::error_handler_t::replace), "the request", verb);
      desk_thread_.go([this, replied, parsed = std::move(parsed)]() mutable {
        // The client has the port's token, but need not be this user.
        desk_->carry_out_parsed(std::move(parsed), replied, Desk::Asker::anybody);
      });
    };
    stream_.viewers().add(std::move(service));
  }
}

void Dashboard::tick() {
  const std::uint64_t now = stream_.unix_ns(executive_.now());
  const bool tells_status = ticks_++ % kTicksPerStatus == 0;
  viewers_thread_.go([&viewers = stream_.viewers(), now, tells_status] {
    viewers.tick(now);
    if (tells_status) {
      viewers.tell_parameters();
    }
  });
  if (tells_status && stream_.viewers().wanted(status_)) {
    desk_->carry_out(Request{ReadCommand{}}, [this, now](const Reply& reply) {
      viewers_thread_.go([this, now, text = reply.json] {
        Json json = Json::parse(text);
        const Viewers::Figures figures = stream_.viewers().figures();
        json["viewers"] = {{"count", figures.viewers},
                           {"sent", figures.sent},
                           {"dropped", figures.dropped},
                           {"not_shown", stream_.not_shown()}};
        stream_.viewers().put(status_, now, json.dump());
      });
    });
  }
  if (executive_.paused() != told_paused_) {
    tell_playback("");
  }
  timer_.expires_after(kTick);
  timer_.async_wait([this](const boost::system::error_code& error) {
    if (!error) {
      tick();
    }
  });
}

void Dashboard::set_parameters(std::vector<ParameterRequest> requests,
                               std::vector<std::string> refused,
                               const StreamParameters::Done& done) {
  for (ParameterRequest& request : requests) {
    // Answered at once, as it has no instant of its own.
    desk_->carry_out_parsed(
        std::move(request.parsed),
        [&refused, &on = request.on](const Reply& reply) {
          if (reply.outcome != Reply::Outcome::done) {
            refused.push_back(shortened(on) + ": " + said(reply));
          }
        },
        Desk::Asker::anybody);
  }
  done(refused);
}

std::string Dashboard::control_playback(const foxglove::PlaybackControl& control) {
  if (control.seek_ns) {
    std::string why = seek(*control.seek_ns, control.request);
    if (!why.empty()) {
      tell_playback(control.request);
    }
    return why;
  }
  std::string refused;
  const auto ask = [&](Command command) {
    bool done = false;
    desk_->carry_out(Request{std::move(command)}, [&](const Reply& reply) {
      done = reply.outcome == Reply::Outcome::done;
      refused = done ? refused : said(reply);
    });
    return done;
  };
  const double factor = static_cast<double>(control.speed);
  if (control.speed != speed_) {
    if (!(factor >= kLeastFactor && factor <= kGreatestFactor)) {
      refused = fmt::format("found speed {:g}, allowed {:g} to {:g}", factor, kLeastFactor,
                            kGreatestFactor);
    } else if (ask(SpeedCommand{factor})) {
      speed_ = control.speed;
    }
  }
  // Answered when what is due has left, after this.
  desk_->carry_out(Request{control.plays ? Command{ResumeCommand{}} : Command{PauseCommand{}}},
                   [](const Reply&) {});
  tell_playback(control.request);
  return refused;
}

std::string Dashboard::seek(std::uint64_t unix_ns, const std::string& request) {
  const std::uint64_t start = stream_.unix_ns(kStart);
  if (unix_ns < start || unix_ns - start > static_cast<std::uint64_t>(fields::kYear_ns)) {
    return "that instant is before the start, or more than a year behind it";
  }
  const SimTime until = kStart + Duration{static_cast<std::int64_t>(unix_ns - start)};
  Command command = RunUntilCommand{until - kStart};
  if (desk_->shown() != nullptr) {
    command = SeekCommand{until - kStart};
  } else if (until <= executive_.now()) {
    return "a run cannot go back, devices have sent what they have sent; start it again and go "
           "forward, or record it and show the recording (replay --dashboard)";
  } else if (desk_->clock().paced()) {
    return fmt::format(
        "this run follows the wall clock ({}); one with --clock step can be sent "
        "forward",
        to_string(desk_->clock()));
  }
  // The answer comes at once if refused, else when time pauses there, which may be after this
  // returns.
  const auto refused = std::make_shared<std::string>();
  desk_->carry_out(Request{std::move(command)}, [this, request, refused](const Reply& reply) {
    if (reply.outcome == Reply::Outcome::done) {
      tell_playback(request, true);
    } else {
      *refused = said(reply);
    }
  });
  return *refused;
}

void Dashboard::tell_playback(std::string_view request, bool did_seek) {
  told_paused_ = executive_.paused();
  if (duration_) {
    const auto status =
        told_paused_ ? foxglove::PlaybackStatus::paused : foxglove::PlaybackStatus::playing;
    viewers_thread_.go([&viewers = stream_.viewers(), status,
                        now = stream_.unix_ns(executive_.now()), speed = speed_, did_seek,
                        request = std::string(request)] {
      viewers.tell_playback(status, now, speed, did_seek, request);
    });
  }
}

}  // namespace rigwire::hil
