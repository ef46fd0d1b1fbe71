#include "hil/record/number_paths.h"

#include <charconv>
#include <cstddef>
#include <limits>
#include <nlohmann/json.hpp>

namespace rigwire::hil {

using NumberTree = nlohmann::ordered_json;

namespace {

void add_number_paths(const NumberTree& tree, const std::string& path,
                      std::vector<std::string>& paths) {
  if (tree.is_number() || tree.is_boolean()) {
    paths.push_back(path);
  } else if (tree.is_structured()) {
    for (const auto& [key, value] : tree.items()) {
      add_number_paths(value, path.empty() ? key : path + "." + key, paths);
    }
  }
}

}  // namespace

const NumberTree* find_path(const NumberTree& tree, std::string_view path) {
  const NumberTree* node = &tree;
  while (node != nullptr) {
    const std::size_t dot = path.find('.');
    const std::string key(path.substr(0, dot));
    std::size_t number = 0;
    const auto [end, error] = std::from_chars(key.data(), key.data() + key.size(), number);
    const bool is_number = error == std::errc() && end == key.data() + key.size();
    if (node->is_object() && node->contains(key)) {
      node = &(*node)[key];
    } else if (node->is_array() && is_number && number < node->size()) {
      node = &(*node)[number];
    } else {
      node = nullptr;
    }
    if (dot == std::string_view::npos) {
      break;
    }
    path.remove_prefix(dot + 1);
  }
  return node;
}

std::optional<double> number_at(const NumberTree& tree, std::string_view path) {
  const NumberTree* const node = find_path(tree, path);
  if (node == nullptr || node->is_structured() || node->is_string()) {
    return std::nullopt;
  }
  return node->is_null()      ? std::numeric_limits<double>::quiet_NaN()
         : node->is_boolean() ? static_cast<double>(node->get<bool>())
                              : node->get<double>();
}

std::vector<std::string> number_paths(const NumberTree& tree) {
  std::vector<std::string> paths;
  add_number_paths(tree, "", paths);
  return paths;
}

}  // namespace rigwire::hil
