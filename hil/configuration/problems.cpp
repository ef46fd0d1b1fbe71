#include "hil/configuration/problems.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "hil/configuration/plain_text.h"

namespace rigwire::hil {

std::string Location::text() const {
  if (is_default()) {
    return "default";
  }
  // The whole of a request has no place that helps to find it.
  if (line == 1 && column == 1 && source->find_first_of("./") == std::string::npos) {
    return *source;
  }
  return line == 0 ? *source : fmt::format("{}:{}:{}", *source, line, column);
}

std::string Location::line_text() const {
  if (is_default()) {
    return "default";
  }
  return line == 0 ? *source : fmt::format("{}:{}", *source, line);
}

std::string shortened(const std::string& text) {
  constexpr std::size_t kMaxShown = 1000;
  return text.size() <= kMaxShown
             ? text
             : text.substr(0, kMaxShown) + fmt::format("... ({} bytes)", text.size());
}

std::string Problem::line() const {
  std::string text = where.text() + ": ";
  if (!path.empty()) {
    text += shortened(path) + ": ";
  }
  text += what;
  if (!found.empty()) {
    text += ", found " + shortened(found);
  }
  if (!allowed.empty()) {
    text += ", allowed " + allowed;
  }
  if (!suggestion.empty()) {
    text += ", did you mean " + suggestion + "?";
  }
  return printable(text);
}

void Problems::add(Problem problem) {
  if (full()) {
    ++untold_;
  } else {
    list_.push_back(std::move(problem));
  }
}

void Problems::name_as_written(const Origins& origins) {
  std::set<std::string> said;
  std::erase_if(list_, [&](Problem& problem) {
    const std::string path = origins.written(problem.path);
    const bool moved = path != problem.path;
    problem.path = path;
    return moved && !said.insert(problem.line()).second;
  });
}

std::vector<Problem> Problems::sorted() const {
  std::map<std::string, std::size_t> order;
  for (const Problem& problem : list_) {
    order.emplace(problem.where.source ? *problem.where.source : "", order.size());
  }
  std::vector<Problem> result = list_;
  const auto rank = [&](const Problem& problem) {
    return std::tuple(order.at(problem.where.source ? *problem.where.source : ""),
                      problem.where.line, problem.where.column);
  };
  std::stable_sort(result.begin(), result.end(),
                   [&](const Problem& a, const Problem& b) { return rank(a) < rank(b); });
  if (untold_ > 0) {
    result.push_back({result.back().where, "", fmt::format("and {} more", untold_), "", "", ""});
  }
  return result;
}

void Problems::throw_if_any() const {
  if (!list_.empty()) {
    throw ConfigurationError(sorted());
  }
}

namespace {

std::string joined(const std::vector<Problem>& problems) {
  std::string text;
  for (const Problem& problem : problems) {
    text += (text.empty() ? "" : "\n") + problem.line();
  }
  return text;
}

}  // namespace

ConfigurationError::ConfigurationError(std::vector<Problem> problems)
    : std::runtime_error(joined(problems)), problems_(std::move(problems)) {}

Location Origins::of(const std::string& path) const {
  const auto it = places_.find(path);
  return it == places_.end() ? Location{} : it->second;
}

std::string Origins::written(const std::string& path) const {
  for (std::size_t end = path.size(); end != std::string::npos && end > 0;
       end = path.rfind('.', end - 1)) {
    if (const auto it = written_.find(path.substr(0, end)); it != written_.end()) {
      return it->second + path.substr(end);
    }
  }
  return path;
}

Location Origins::nearest(std::string path) const {
  while (true) {
    const auto it = places_.find(path);
    if (it != places_.end()) {
      return it->second;
    }
    if (path.empty()) {
      return {};
    }
    const std::size_t dot = path.rfind('.');
    path = dot == std::string::npos ? std::string() : path.substr(0, dot);
  }
}

}  // namespace rigwire::hil
