#include "hil/stream/viewer_json.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace rigwire::hil {

std::optional<nlohmann::json> viewer_object(std::string_view text, std::string& why) {
  bool too_deep = false;
  nlohmann::json json = nlohmann::json::parse(
      text,
      [&too_deep](int depth, nlohmann::json::parse_event_t /*event*/, nlohmann::json& /*parsed*/) {
        too_deep = too_deep || depth > kMaximumViewerDepth;
        return !too_deep;
      },
      false);
  if (too_deep) {
    why = fmt::format("the request is nested deeper than {} levels", kMaximumViewerDepth);
    return std::nullopt;
  }
  if (!json.is_object()) {
    why = "the request is no JSON object";
    return std::nullopt;
  }
  return json;
}

}  // namespace rigwire::hil
