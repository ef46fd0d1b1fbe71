// Numbers in a tree of JSON by their paths: "joint_rad.1", "lateness_us.p99".
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rigwire::hil {

/// Returns what lies at "a.b.2"; null where nothing does. Elements of a list count from 0.
[[nodiscard]] const nlohmann::ordered_json* find_path(const nlohmann::ordered_json& tree,
                                                      std::string_view path);

/// Returns the number at a path, of a boolean 0 or 1. Nothing: there is no number. Not a number:
/// the tree has null there.
[[nodiscard]] std::optional<double> number_at(const nlohmann::ordered_json& tree,
                                              std::string_view path);

/// Returns the paths of all numbers and booleans of a tree, in its order.
[[nodiscard]] std::vector<std::string> number_paths(const nlohmann::ordered_json& tree);

}  // namespace rigwire::hil
