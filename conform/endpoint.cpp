#include "conform/endpoint.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <string_view>

namespace rigwire::conform {

namespace {

using Kind = Endpoint::Kind;

struct Scheme {
  std::string_view name;
  Kind kind;
};
constexpr std::array<Scheme, 5> kSchemes{{{"tcp", Kind::tcp},
                                          {"serial", Kind::serial},
                                          {"can", Kind::can},
                                          {"slcan", Kind::slcan},
                                          {"udp", Kind::udp}}};

template <class Number>
std::optional<Number> number_in(std::string_view text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() && value > 0
             ? std::optional(value)
             : std::nullopt;
}

bool has_rate(Kind kind) {
  return kind == Kind::serial || kind == Kind::slcan;
}

/// "PATH", "PATH@RATE".
bool take_path(std::string_view rest, Endpoint& endpoint) {
  const std::size_t at = has_rate(endpoint.kind) ? rest.rfind('@') : std::string_view::npos;
  endpoint.address = rest.substr(0, at);
  if (at == std::string_view::npos) {
    return !endpoint.address.empty();
  }
  const auto rate = number_in<std::uint32_t>(rest.substr(at + 1));
  endpoint.rate = rate.value_or(0);
  return rate && !endpoint.address.empty();
}

/// "ADDRESS", "ADDRESS:PORT", "[ADDRESS]:PORT"; of UDP "PORT" and "", too.
bool take_address(std::string_view rest, Endpoint& endpoint) {
  std::string_view number;
  const bool datagrams = endpoint.kind == Kind::udp;
  if (datagrams && rest.find_first_not_of("0123456789") == std::string_view::npos) {
    number = rest;
  } else if (rest.starts_with('[')) {
    const std::size_t end = rest.find(']');
    if (end == std::string_view::npos) {
      return false;
    }
    endpoint.address = rest.substr(1, end - 1);
    rest.remove_prefix(end + 1);
    number = rest.starts_with(':') ? rest.substr(1) : rest;
  } else {
    const std::size_t colon = rest.find(':');
    endpoint.address = rest.substr(0, colon);
    number = colon == std::string_view::npos ? std::string_view() : rest.substr(colon + 1);
  }
  if (!number.empty()) {
    const auto chosen = number_in<std::uint16_t>(number);
    if (!chosen) {
      return false;
    }
    endpoint.port = *chosen;
  }
  return datagrams || !endpoint.address.empty();
}

}  // namespace

std::string Endpoint::text() const {
  const auto* const scheme = std::ranges::find(kSchemes, kind, &Scheme::kind);
  const std::string begin = std::string(scheme->name) + ":";
  if (kind != Kind::tcp && kind != Kind::udp) {
    return begin + address + (has_rate(kind) ? "@" + std::to_string(rate) : "");
  }
  const bool v6 = address.find(':') != std::string::npos;
  return begin + (v6 ? "[" + address + "]" : address) + (address.empty() ? "" : ":") +
         std::to_string(port);
}

bool Endpoint::local() const {
  const bool internet = kind == Kind::tcp || kind == Kind::udp;
  return !internet || address.starts_with("127.") || address == "::1";
}

std::optional<Endpoint> parse_endpoint(const std::string& text, const EndpointDefaults& defaults) {
  const std::size_t colon = text.find(':');
  const std::string_view name = std::string_view(text).substr(0, colon);
  const auto* const scheme = std::ranges::find(kSchemes, name, &Scheme::name);
  if (colon == std::string::npos || scheme == kSchemes.end()) {
    return std::nullopt;
  }
  Endpoint endpoint;
  endpoint.kind = scheme->kind;
  endpoint.port = defaults.port;
  endpoint.rate = defaults.rate;
  const std::string_view rest = std::string_view(text).substr(colon + 1);
  const bool internet = endpoint.kind == Kind::tcp || endpoint.kind == Kind::udp;
  const bool taken = internet ? take_address(rest, endpoint) : take_path(rest, endpoint);
  return taken ? std::optional(endpoint) : std::nullopt;
}

}  // namespace rigwire::conform
