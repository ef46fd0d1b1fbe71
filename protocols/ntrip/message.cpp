#include "protocols/ntrip/message.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdio>

namespace rigwire::protocols::ntrip {
namespace {

constexpr std::string_view kEnd = "\r\n";

bool same_letters(std::string_view a, std::string_view b) {
  return std::ranges::equal(a, b, [](char x, char y) {
    return std::tolower(static_cast<unsigned char>(x)) ==
           std::tolower(static_cast<unsigned char>(y));
  });
}

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t");
  if (begin == std::string_view::npos) {
    return {};
  }
  return text.substr(begin, text.find_last_not_of(" \t") - begin + 1);
}

/// Takes the first line away, without its end; nothing when it has none yet.
std::optional<std::string_view> take_line(std::string_view& text) {
  const std::size_t end = text.find('\n');
  if (end == std::string_view::npos) {
    return std::nullopt;
  }
  std::string_view line = text.substr(0, end);
  text.remove_prefix(end + 1);
  if (!line.empty() && line.back() == '\r') {
    line.remove_suffix(1);
  }
  return line;
}

std::string_view take_word(std::string_view& line) {
  line = trimmed(line);
  const std::string_view word = line.substr(0, line.find(' '));
  line.remove_prefix(word.size());
  return word;
}

void read_header(std::string_view line, Request& request) {
  const std::size_t colon = line.find(':');
  if (colon == std::string_view::npos) {
    return;
  }
  const std::string_view name = line.substr(0, colon);
  std::string_view value = trimmed(line.substr(colon + 1));
  if (same_letters(name, "User-Agent") || same_letters(name, "Source-Agent")) {
    request.user_agent = value;
  } else if (same_letters(name, "Ntrip-Version")) {
    request.second_version = same_letters(value.substr(0, 7), "Ntrip/2");
  } else if (same_letters(name, "Authorization") && same_letters(take_word(value), "Basic")) {
    request.credentials = from_base64(trimmed(value));
  }
}

template <class... Parts>
std::string joined(const Parts&... parts) {
  std::string text;
  (text.append(parts), ...);
  return text;
}

std::string length_of(std::string_view body) {
  return joined("Content-Length: ", std::to_string(body.size()), kEnd);
}

std::string second_head(std::string_view status, const Caster& caster) {
  return joined("HTTP/1.1 ", status, kEnd, "Ntrip-Version: Ntrip/2.0", kEnd,
                "Server: ", caster.name, kEnd, "Date: ", caster.date, kEnd, "Connection: close",
                kEnd);
}

std::string decimals(const char* format, double value) {
  std::array<char, 32> text{};
  const int size = std::snprintf(text.data(), text.size(), format, value);
  return {text.data(), static_cast<std::size_t>(std::max(size, 0))};
}

}  // namespace

std::string_view Request::mount() const {
  std::string_view name = target;
  name = name.substr(0, name.find('?'));
  if (!name.empty() && name.front() == '/') {
    name.remove_prefix(1);
  }
  return name;
}

Decoded<Request> decode_request(std::span<const std::uint8_t> bytes) {
  std::string_view text(reinterpret_cast<const char*>(bytes.data()),
                        std::min(bytes.size(), kGreatestHead));
  const std::size_t offered = text.size();
  const auto more = [&]() -> Decoded<Request> {
    if (offered == kGreatestHead) {
      return Malformed{"an NTRIP head of at most 4096 bytes", offered};
    }
    return Incomplete{offered + 1, offered};
  };
  const bool printable = std::ranges::all_of(text.substr(0, text.find('\n')), [](char c) {
    return static_cast<unsigned char>(c) >= ' ' || c == '\r' || c == '\t';
  });
  if (!printable) {
    return Malformed{"an NTRIP request line", 0};
  }
  auto line = take_line(text);
  if (!line) {
    return more();
  }
  Request request;
  request.method = take_word(*line);
  request.target = take_word(*line);
  if (request.method.empty() || request.target.empty()) {
    return Malformed{"an NTRIP request line of method and target", 0};
  }
  for (;;) {
    line = take_line(text);
    if (!line) {
      return more();
    }
    if (line->empty()) {
      return {std::move(request), offered - text.size()};
    }
    read_header(*line, request);
  }
}

std::string table_line(const Stream& s) {
  return joined("STR;", s.mount, ";", s.identifier, ";", s.format, ";", s.details, ";",
                std::to_string(s.carrier), ";", s.systems, ";none;;",
                decimals("%.2f", s.latitude_deg), ";", decimals("%.2f", s.longitude_deg), ";",
                s.needs_position ? "1" : "0", ";0;Rigwire;none;", s.needs_password ? "B" : "N",
                ";N;", std::to_string(s.bits_per_second), ";", kEnd);
}

std::string source_table(bool second_version, const Caster& caster, std::string_view lines) {
  const std::string body = joined(lines, "ENDSOURCETABLE", kEnd);
  if (second_version) {
    return joined(second_head("200 OK", caster), "Content-Type: gnss/sourcetable", kEnd,
                  length_of(body), kEnd, body);
  }
  return joined("SOURCETABLE 200 OK", kEnd, "Server: ", caster.name, kEnd, "Date: ", caster.date,
                kEnd, "Connection: close", kEnd, "Content-Type: text/plain", kEnd, length_of(body),
                kEnd, body);
}

std::string stream_head(bool second_version, bool chunked, const Caster& caster) {
  if (!second_version) {
    // Every byte after this line is the stream's to str2str; others read over an empty line.
    return joined("ICY 200 OK", kEnd);
  }
  return joined(second_head("200 OK", caster), "Cache-Control: no-store, no-cache, max-age=0", kEnd,
                "Pragma: no-cache", kEnd, "Content-Type: gnss/data", kEnd,
                chunked ? joined("Transfer-Encoding: chunked", kEnd) : std::string(), kEnd);
}

std::string unauthorized(bool second_version, const Caster& caster, std::string_view mount) {
  const std::string realm = joined("WWW-Authenticate: Basic realm=\"/", mount, "\"", kEnd, kEnd);
  return second_version ? joined(second_head("401 Unauthorized", caster), realm)
                        : joined("HTTP/1.0 401 Unauthorized", kEnd, realm);
}

std::string not_found(const Caster& caster) {
  return joined(second_head("404 Not Found", caster), kEnd);
}
std::string bad_request() {
  return joined("HTTP/1.1 400 Bad Request", kEnd, "Connection: close", kEnd, kEnd);
}
std::string not_implemented() {
  return joined("HTTP/1.1 501 Not Implemented", kEnd, "Connection: close", kEnd, kEnd);
}

std::string chunk(std::span<const std::uint8_t> bytes) {
  std::array<char, 24> size{};
  const int count = std::snprintf(size.data(), size.size(), "%zx\r\n", bytes.size());
  std::string text(size.data(), static_cast<std::size_t>(std::max(count, 0)));
  text.append(bytes.begin(), bytes.end());
  return text.append(kEnd);
}

std::optional<std::string> from_base64(std::string_view text) {
  constexpr std::string_view kLetters =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  while (!text.empty() && text.back() == '=') {
    text.remove_suffix(1);
  }
  std::string bytes;
  std::uint32_t bits = 0;
  unsigned count = 0;
  for (const char letter : text) {
    const std::size_t value = kLetters.find(letter);
    if (value == std::string_view::npos) {
      return std::nullopt;
    }
    bits = bits << 6U | static_cast<std::uint32_t>(value);
    count += 6;
    if (count >= 8) {
      count -= 8;
      bytes.push_back(static_cast<char>(bits >> count & 0xFFU));
    }
  }
  return bytes;
}

}  // namespace rigwire::protocols::ntrip
