// What viewers of a run send as JSON, within bounds: printing a value takes as much stack as it is
// deep, so depth is limited before anything looks at it.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>

namespace rigwire::hil {

/// Deepest object or list within others: a request's own depth within a viewer's message.
inline constexpr int kMaximumViewerDepth = 24;

/// Returns the text as a JSON object, or nothing, and in `why` what it is instead.
[[nodiscard]] std::optional<nlohmann::json> viewer_object(std::string_view text, std::string& why);

}  // namespace rigwire::hil
