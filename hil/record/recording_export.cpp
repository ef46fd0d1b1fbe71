#include "hil/record/recording_export.h"

#include <fmt/format.h>

#include <cerrno>
#include <fstream>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "drivers/endpoints.h"
#include "hil/record/recording.h"

namespace rigwire::hil {
namespace {

using Json = nlohmann::ordered_json;

/// Every member that is neither object nor list, by its path.
void flatten(const Json& value, const std::string& path,
             const std::function<void(const std::string& path, const Json& leaf)>& use) {
  const auto below = [&](const std::string& key) { return path.empty() ? key : path + "." + key; };
  if (value.is_object()) {
    for (const auto& [key, member] : value.items()) {
      flatten(member, below(key), use);
    }
  } else if (value.is_array()) {
    for (std::size_t i = 0; i < value.size(); ++i) {
      flatten(value[i], below(std::to_string(i)), use);
    }
  } else {
    use(path, value);
  }
}

std::string in_quotes(std::string_view text) {
  std::string all = "\"";
  for (const char letter : text) {
    all += letter == '"' ? "\"\"" : std::string(1, letter);
  }
  return all + '"';
}

std::string field(const Json& leaf) {
  if (leaf.is_null()) {
    return "";
  }
  return leaf.is_string() ? in_quotes(leaf.get<std::string>()) : leaf.dump();
}

constexpr std::string_view kTime = "sim_s";

}  // namespace

std::size_t export_csv(const std::filesystem::path& folder, TruthTrack topic,
                       const std::filesystem::path& path) {
  std::vector<std::string> names;
  std::map<std::string, std::size_t> places;
  const auto each = [&](const std::function<void(SimTime, const Json&)>& use) {
    each_message(folder, [&](TruthTrack track, SimTime at, std::string_view text) {
      if (track == topic) {
        use(at, Json::parse(text, nullptr, false));
      }
    });
  };
  each([&](SimTime, const Json& message) {
    flatten(message, "", [&](const std::string& name, const Json&) {
      if (name != kTime && places.try_emplace(name, names.size()).second) {
        names.push_back(name);
      }
    });
  });
  errno = 0;
  std::ofstream file(path, std::ios::binary);
  file << kTime;
  for (const std::string& name : names) {
    file << ',' << (name.find_first_of(",\"\n") == std::string::npos ? name : in_quotes(name));
  }
  file << '\n';
  std::size_t rows = 0;
  std::vector<std::string> row(names.size());
  each([&](SimTime at, const Json& message) {
    for (std::string& place : row) {
      place.clear();
    }
    flatten(message, "", [&](const std::string& name, const Json& leaf) {
      if (name != kTime) {
        row[places.at(name)] = field(leaf);
      }
    });
    file << instant_text(at);
    for (const std::string& place : row) {
      file << ',' << place;
    }
    file << '\n';
    ++rows;
  });
  file.flush();
  if (!file) {
    throw drivers::EndpointError(
        fmt::format("{}: {}", path.string(), std::generic_category().message(errno)));
  }
  return rows;
}

}  // namespace rigwire::hil
