#include "hil/record/truth_messages.h"

#include <fmt/format.h>

#include <initializer_list>
#include <iterator>
#include <nlohmann/json.hpp>

#include "hil/record/truth_tap.h"

namespace rigwire::hil {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kTimestamp =
    R"({"type":"object","properties":{"sec":{"type":"integer"},"nsec":{"type":"integer"}}})";

std::string object(std::string_view properties) {
  return fmt::format(R"({{"type":"object","properties":{{{}}}}})", properties);
}

std::string numbers(std::initializer_list<std::string_view> names) {
  std::string all;
  for (const std::string_view name : names) {
    all += fmt::format(R"({}"{}":{{"type":"number"}})", all.empty() ? "" : ",", name);
  }
  return object(all);
}

std::string transforms_schema() {
  return object(fmt::format(
      R"("transforms":{{"type":"array","items":{}}})",
      object(fmt::format(R"("timestamp":{},"parent_frame_id":{{"type":"string"}},)"
                         R"("child_frame_id":{{"type":"string"}},"translation":{},"rotation":{})",
                         kTimestamp, numbers({"x", "y", "z"}), numbers({"x", "y", "z", "w"})))));
}

std::string location_schema() {
  return object(
      fmt::format(R"("timestamp":{},"frame_id":{{"type":"string"}},"latitude":{{"type":"number"}},)"
                  R"("longitude":{{"type":"number"}},"altitude":{{"type":"number"}},)"
                  R"("position_covariance":{{"type":"array","items":{{"type":"number"}}}},)"
                  R"("position_covariance_type":{{"type":"integer"}})",
                  kTimestamp));
}

std::string log_schema() {
  return object(fmt::format(
      R"("timestamp":{},"level":{{"type":"integer"}},"message":{{"type":"string"}},)"
      R"("name":{{"type":"string"}},"file":{{"type":"string"}},"line":{{"type":"integer"}})",
      kTimestamp));
}

std::string joints_schema() {
  return object(fmt::format(
      R"("timestamp":{},"joints":{{"type":"array","items":{}}})", kTimestamp,
      object(
          R"("name":{"type":"string"},"position":{"type":"number"},"velocity":{"type":"number"})")));
}

std::string points_schema() {
  return object(fmt::format(
      R"("timestamp":{},"frame_id":{{"type":"string"}},"pose":{},)"
      R"("point_stride":{{"type":"integer"}},"fields":{{"type":"array","items":{}}},)"
      R"("data":{{"type":"string","contentEncoding":"base64"}})",
      kTimestamp,
      object(fmt::format(R"("position":{},"orientation":{})", numbers({"x", "y", "z"}),
                         numbers({"x", "y", "z", "w"}))),
      object(R"("name":{"type":"string"},"offset":{"type":"integer"},"type":{"type":"integer"})")));
}

}  // namespace

std::array<ChannelRow, kTruthTracks> channel_rows() {
  return {{{"/truth", "rigwire.Truth", object("")},
           {"/tf", "foxglove.FrameTransforms", transforms_schema()},
           {"/antenna", "foxglove.LocationFix", location_schema()},
           {"/statistics", "rigwire.Statistics", object("")},
           {"/events", "foxglove.Log", log_schema()},
           {"/motion", "rigwire.Motion", object("")},
           {"/joints", "foxglove.JointStates", joints_schema()},
           {"/points", "foxglove.PointCloud", points_schema()}}};
}

std::string timestamp(std::int64_t start_unix_ns, SimTime at) {
  const std::int64_t ns = start_unix_ns + at.time_since_epoch().count();
  return fmt::format(R"({{"sec":{},"nsec":{}}})", ns / 1'000'000'000, ns % 1'000'000'000);
}

std::string location_message(const std::string& timestamp, std::string_view frame_id,
                             const sim::GeodeticPoint& place, const LocationSpread& spread,
                             std::string_view more) {
  const auto variance = [&](std::size_t axis) {
    return spread.sigma_m[axis] * spread.sigma_m[axis];
  };
  return fmt::format(
      R"({{"timestamp":{},"frame_id":{},"latitude":{:.10f},"longitude":{:.10f},)"
      R"("altitude":{:.4f},"position_covariance":[{:.6g},0,0,0,{:.6g},0,0,0,{:.6g}],)"
      R"("position_covariance_type":{}{}}})",
      timestamp, Json(std::string(frame_id)).dump(), place.latitude_deg, place.longitude_deg,
      place.ellipsoid_height_m, variance(0), variance(1), variance(2),
      static_cast<int>(spread.kind), more);
}

std::string log_message(std::int64_t start_unix_ns, SimTime at, LogLevel level,
                        std::string_view name, std::string_view text) {
  const Json json{{"message", text}, {"name", name}, {"file", ""}, {"line", 0}};
  // Levels of foxglove.Log: 1 debug, 2 info, 3 warning, 4 error.
  const std::string members = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  return fmt::format(R"({{"timestamp":{},"level":{},{})", timestamp(start_unix_ns, at),
                     static_cast<int>(level) + 1, members.substr(1));
}

void TransformsMessage::add(const std::string& timestamp, std::string_view parent,
                            std::string_view frame, const Eigen::Isometry3d& X_PF) {
  const Eigen::Vector3d p = X_PF.translation();
  const Eigen::Quaterniond q(X_PF.linear());
  fmt::format_to(std::back_inserter(text_),
                 R"({}{{"timestamp":{},"parent_frame_id":{},"child_frame_id":{},)"
                 R"("translation":{{"x":{:.12g},"y":{:.12g},"z":{:.12g}}},)"
                 R"("rotation":{{"x":{:.12g},"y":{:.12g},"z":{:.12g},"w":{:.12g}}}}})",
                 text_.ends_with('[') ? "" : ",", timestamp, Json(std::string(parent)).dump(),
                 Json(std::string(frame)).dump(), p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w());
}

TruthMessages::TruthMessages(std::int64_t start_unix_ns, const Calendar& calendar,
                             std::span<const sim::TruthField> fields,
                             std::span<const std::string_view> links)
    : start_unix_ns_(start_unix_ns),
      calendar_(calendar),
      fields_(fields.begin(), fields.end()),
      links_(links.begin(), links.end()),
      joints_(fields, links) {}

void TruthMessages::tell(const TruthRecord& record, const Wanted& wanted, const Put& put) {
  if (wanted(TruthTrack::truth)) {
    put(TruthTrack::truth, record.time, truth_line(record, calendar_, fields_));
  }
  const std::string stamp = timestamp(start_unix_ns_, record.time);
  if (wanted(TruthTrack::transforms)) {
    transforms_.begin();
    for (std::size_t i = 0; i < links_.size() && i < record.links.size(); ++i) {
      transforms_.add(stamp, "world", links_[i], record.links[i].X_WL);
    }
    put(TruthTrack::transforms, record.time, transforms_.end());
  }
  if (wanted(TruthTrack::motion)) {
    put(TruthTrack::motion, record.time, motion_line(record, links_));
  }
  if (!joints_.empty() && wanted(TruthTrack::joints)) {
    put(TruthTrack::joints, record.time, joints_.line(record.machine, stamp));
  }
  if (wanted(TruthTrack::location)) {
    for (const AntennaTruth& antenna : record.antennas) {
      put(TruthTrack::location, record.time,
          location_message(stamp, antenna.device, antenna.place));
    }
  }
}

}  // namespace rigwire::hil
