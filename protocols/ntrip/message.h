// NTRIP, by which casters hand RTCM streams to their clients: what a client asks, the source table,
// and how a stream begins. Versions 1 and 2 differ in their heads; which one a client uses, its
// header Ntrip-Version says.
//
// Sources: RTCM 10410.1 (version 2.0) and the open description of version 1.0 (BKG), as str2str of
// RTKLIB 2.4.3 b34 answers and asks on loopback, and gpsd's net_ntrip.c reads it. Heads in version
// 1 are not HTTP: "ICY 200 OK", "SOURCETABLE 200 OK".
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "protocols/result.h"

namespace rigwire::protocols::ntrip {

/// A head that has not ended by then is none.
inline constexpr std::size_t kGreatestHead = 4096;

struct Request {
  std::string method;  ///< "GET", "POST", "SOURCE".
  std::string target;  ///< "/", "/MOUNT".
  std::string user_agent;
  bool second_version = false;             ///< Ntrip-Version: Ntrip/2.x.
  std::optional<std::string> credentials;  ///< "user:password" of Authorization: Basic.

  /// The target without its slash and without a query.
  [[nodiscard]] std::string_view mount() const;
};

/// The head of a request, with the empty line that ends it. Lines may end without carriage return.
[[nodiscard]] Decoded<Request> decode_request(std::span<const std::uint8_t> bytes);

/// A line of the source table: RTCM 10410.1, section "STR".
struct Stream {
  std::string mount = "BASE";
  std::string identifier = "Rigwire";  ///< A place.
  std::string format = "RTCM 3.3";
  std::string details;          ///< "1005(1),1077(1)".
  int carrier = 1;              ///< 0 code, 1 one band, 2 both.
  std::string systems = "GPS";  ///< Joined by +.
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
  bool needs_position = false;
  bool needs_password = true;
  int bits_per_second = 9600;
};
[[nodiscard]] std::string table_line(const Stream& stream);

/// What a caster calls itself, and when it is: "Tue, 24 Nov 2026 12:00:00 GMT".
struct Caster {
  std::string_view name = "NTRIP Rigwire/1.0";
  std::string_view date;
};

/// The whole answer; `lines` end each with CR LF.
[[nodiscard]] std::string source_table(bool second_version, const Caster& caster,
                                       std::string_view lines);
/// What goes before the stream.
[[nodiscard]] std::string stream_head(bool second_version, bool chunked, const Caster& caster);
[[nodiscard]] std::string unauthorized(bool second_version, const Caster& caster,
                                       std::string_view mount);
/// Version 2 alone: in version 1 the source table is the answer.
[[nodiscard]] std::string not_found(const Caster& caster);
[[nodiscard]] std::string bad_request();
[[nodiscard]] std::string not_implemented();

/// Bytes of a stream as one chunk of HTTP.
[[nodiscard]] std::string chunk(std::span<const std::uint8_t> bytes);

/// Base64 of RFC 4648, section 4; nothing for what is none.
[[nodiscard]] std::optional<std::string> from_base64(std::string_view text);

}  // namespace rigwire::protocols::ntrip
