#include "hil/files/motion_mcap.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "hil/files/mcap_file.h"
#include "protocols/mcap/mcap.h"

namespace rigwire::hil {
namespace {

namespace mcap = protocols::mcap;
using Json = nlohmann::json;

class McapMotion {
 public:
  McapMotion(const MotionSettings& settings, MotionContents& contents)
      : settings_(settings), contents_(contents) {}

  void read() {
    each_mcap_record(settings_.file, kMotionFile,
                     [&](const mcap::Record& record) { take(record); });
  }

 private:
  enum class Kind { transforms, transform, pose, motion, truth };
  static constexpr std::array<std::pair<std::string_view, Kind>, 5> kSchemas{
      {{"foxglove.FrameTransforms", Kind::transforms},
       {"foxglove.FrameTransform", Kind::transform},
       {"foxglove.PoseInFrame", Kind::pose},
       {"rigwire.Motion", Kind::motion},
       {"rigwire.Truth", Kind::truth}}};

  void take(const mcap::Record& record) {
    if (record.opcode == mcap::Opcode::schema) {
      if (const auto schema = mcap::read_schema(record.content); schema.ok()) {
        schemas_[schema->id] = schema->name;
      }
    } else if (record.opcode == mcap::Opcode::channel) {
      if (const auto channel = mcap::read_channel(record.content); channel.ok()) {
        meet(*channel);
      }
    } else if (record.opcode == mcap::Opcode::message) {
      const auto message = mcap::read_message(record.content);
      const auto kind = message.ok() ? channels_.find(message->channel) : channels_.end();
      if (kind != channels_.end()) {
        try {
          take(kind->second, static_cast<std::int64_t>(message->time_ns),
               Json::parse(message->data));
        } catch (const Json::exception& error) {
          refuse_motion(settings_.file,
                        fmt::format("a message of {} at {} ns: {}", topics_[message->channel],
                                    message->time_ns, error.what()));
        }
      }
    }
  }

  void meet(const mcap::Channel& channel) {
    for (const auto& [name, kind] : kSchemas) {
      if (schemas_[channel.schema] == name) {
        if (channel.encoding != "json") {
          refuse_motion(settings_.file, fmt::format("topic {}: messages as \"{}\", allowed json",
                                                    channel.topic, channel.encoding));
        }
        channels_[channel.id] = kind;
        topics_[channel.id] = channel.topic;
      }
    }
  }

  static Eigen::Vector3d vector(const Json& v) {
    return {v.at("x").get<double>(), v.at("y").get<double>(), v.at("z").get<double>()};
  }
  static Eigen::Quaterniond turn(const Json& q) {
    return {q.at("w").get<double>(), q.at("x").get<double>(), q.at("y").get<double>(),
            q.at("z").get<double>()};
  }
  static Eigen::Vector3d three(const Json& v) {
    return {v.at(0).get<double>(), v.at(1).get<double>(), v.at(2).get<double>()};
  }

  /// By the message's own stamp, where it has one: that of logging is when it came.
  static std::int64_t stamp(const Json& message, std::int64_t logged_ns) {
    const auto found = message.find("timestamp");
    if (found == message.end()) {
      return logged_ns;
    }
    const auto nanoseconds = found->find("nsec") != found->end() ? "nsec" : "nanosec";
    return found->at("sec").get<std::int64_t>() * 1'000'000'000 +
           found->at(nanoseconds).get<std::int64_t>();
  }

  void take_transform(const Json& transform, std::int64_t logged_ns) {
    const auto link = contents_.link(transform.at("child_frame_id").get<std::string>());
    if (!link) {
      return;
    }
    const std::int64_t at_ns = stamp(transform, logged_ns);
    Eigen::Isometry3d X =
        pose_of(vector(transform.at("translation")), turn(transform.at("rotation")));
    if (const auto parent = contents_.link(transform.at("parent_frame_id").get<std::string>())) {
      const auto& X_WP = contents_.at(*parent, at_ns).X_WL;
      if (!X_WP) {
        refuse_motion(
            settings_.file,
            fmt::format("at {} ns the pose of {} counts from {}, which has none at that instant "
                        "before it",
                        at_ns, contents_.names()[*link], contents_.names()[*parent]));
      }
      X = *X_WP * X;
    }
    contents_.at(*link, at_ns).X_WL = X;
  }

  void take(Kind kind, std::int64_t logged_ns, const Json& message) {
    switch (kind) {
      case Kind::transforms:
        for (const Json& transform : message.at("transforms")) {
          take_transform(transform, logged_ns);
        }
        break;
      case Kind::transform:
        take_transform(message, logged_ns);
        break;
      case Kind::pose: {
        const Json& pose = message.at("pose");
        contents_.at(0, stamp(message, logged_ns)).X_WL =
            pose_of(vector(pose.at("position")), turn(pose.at("orientation")));
        break;
      }
      case Kind::motion:
        take_motion(message, logged_ns);
        break;
      case Kind::truth:
        if (!contents_.has_zero()) {
          contents_.set_zero(logged_ns - std::llround(message.at("sim_s").get<double>() * 1e9));
        }
        take_numbers_of(message, contents_.truth, logged_ns);
        break;
    }
  }

  void take_motion(const Json& message, std::int64_t at_ns) {
    for (const auto& [name, link] : message.at("links").items()) {
      if (const auto index = contents_.link(name)) {
        sim::LinkMotion& rates = contents_.at(*index, at_ns).rates.emplace();
        rates.v_WL_W = three(link.at("velocity_mps"));
        rates.w_WL_W = three(link.at("rate_radps"));
        rates.a_WL_W = three(link.at("acceleration_mps2"));
        rates.alpha_WL_W = three(link.at("angular_acceleration_radps2"));
      }
    }
    const auto port = [&](const char* key, NumberTable& table) {
      if (const auto found = message.find(key); found != message.end() && !table.places.empty()) {
        take_numbers_of(*found, table, at_ns);
      }
    };
    port("valves", contents_.valves);
    port("vehicle", contents_.vehicle);
    port("power_unit", contents_.power_unit);
  }

  /// Members that the table has, a number or a list of them; null is no number.
  static void take_numbers_of(const Json& message, NumberTable& table, std::int64_t at_ns) {
    for (const auto& [name, value] : message.items()) {
      const auto put = [&, &key = name](std::size_t index, const Json& number) {
        if (const auto place = table.place(key, index)) {
          table.at(at_ns)[*place] = number.is_null() ? NumberTable::kMissing : number.get<double>();
        }
      };
      if (value.is_array()) {
        for (std::size_t i = 0; i < value.size(); ++i) {
          put(i, value[i]);
        }
      } else if (!value.is_object() && !value.is_string() && !value.is_boolean()) {
        put(0, value);
      }
    }
  }

  const MotionSettings& settings_;
  MotionContents& contents_;
  std::map<std::uint16_t, std::string> schemas_;
  std::map<std::uint16_t, Kind> channels_;
  std::map<std::uint16_t, std::string> topics_;
};

}  // namespace

void read_mcap_motion(const MotionSettings& settings, MotionContents& contents) {
  McapMotion(settings, contents).read();
}

}  // namespace rigwire::hil
