// Binary frames of the Foxglove WebSocket protocol, by which viewers (Foxglove, Lichtblick) follow
// a running system. Everything else of it is JSON text.
//
// Source: foxglove/ws-protocol, docs/spec.md, as of version 1 ("foxglove.websocket.v1"), sections
// "Binary messages"; foxglove/foxglove-sdk for playback control ("foxglove.sdk.v1"). All numbers
// are little-endian; lengths are of what follows them.
//
//   server 0x01 message            subscription u32, time u64, payload
//          0x02 time               time u64
//          0x03 service response   service u32, call u32, length u32, encoding, payload
//          0x04 asset              request u32, status u8, length u32, error, data
//          0x05 playback state     status u8, time u64, speed f32, did seek u8, length u32, request
//   client 0x02 service request    service u32, call u32, length u32, encoding, payload
//          0x03 playback control   command u8, speed f32, had seek u8, time u64, length u32,
//          request
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "protocols/result.h"

namespace rigwire::protocols::foxglove {

/// Names of the protocol that a client may offer; both are the same frames.
inline constexpr std::array<std::string_view, 2> kSubprotocols{"foxglove.sdk.v1",
                                                               "foxglove.websocket.v1"};

[[nodiscard]] std::string message_frame(std::uint32_t subscription, std::uint64_t time_ns,
                                        std::string_view payload);
[[nodiscard]] std::string time_frame(std::uint64_t time_ns);
[[nodiscard]] std::string service_response_frame(std::uint32_t service, std::uint32_t call,
                                                 std::string_view encoding,
                                                 std::string_view payload);
[[nodiscard]] std::string asset_frame(std::uint32_t request, std::string_view data);
[[nodiscard]] std::string asset_error_frame(std::uint32_t request, std::string_view error);

enum class PlaybackStatus : std::uint8_t { playing = 0, paused = 1, buffering = 2, ended = 3 };
[[nodiscard]] std::string playback_state_frame(PlaybackStatus status, std::uint64_t time_ns,
                                               float speed, bool did_seek,
                                               std::string_view request);

// Frames sent by clients; texts point into the bytes that they were decoded from.

struct ServiceRequest {
  std::uint32_t service = 0;
  std::uint32_t call = 0;
  std::string_view encoding;
  std::string_view payload;
};
struct PlaybackControl {
  bool plays = false;  ///< Else it pauses.
  float speed = 1.0F;
  std::optional<std::uint64_t> seek_ns;
  std::string request;  ///< To be in the answering state.
};
using ClientFrame = std::variant<ServiceRequest, PlaybackControl>;

/// One frame, all of it. Malformed when it is of another kind, ends early, or a length leads beyond
/// its end; never incomplete, since frames come whole.
[[nodiscard]] Decoded<ClientFrame> decode_client_frame(std::string_view bytes);

}  // namespace rigwire::protocols::foxglove
