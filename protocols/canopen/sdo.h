// Service data objects: how a client reads and writes a node's object dictionary, one entry at a
// time. Both directions are eight bytes:
//
//   byte 0   command: specifier in bits 7..5, the rest by kind
//   initiate (expedited, or announcing segments):
//            bits 3..2 unused bytes, bit 1 expedited, bit 0 size indicated
//            bytes 1-2 index, 3 sub-index (little-endian), 4..7 data or length
//   segment  bit 4 toggle, bits 3..1 unused bytes, bit 0 last; bytes 1..7 data
//   abort    0x80; index, sub-index, abort code
//
// Source: CiA 301 V4.2.0, 7.2.4.3. Block transfer is not part of this header.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "protocols/can/frame.h"
#include "protocols/result.h"

namespace rigwire::protocols::canopen {

/// CiA 301, 7.2.4.3.17.
enum class SdoAbort : std::uint32_t {
  toggle_not_alternated = 0x05030000,
  unknown_command = 0x05040001,
  read_of_write_only = 0x06010001,
  write_of_read_only = 0x06010002,
  no_such_object = 0x06020000,
  not_mappable = 0x06040041,
  mapping_too_long = 0x06040042,
  length_mismatch = 0x06070010,
  too_long = 0x06070012,
  too_short = 0x06070013,
  no_such_subindex = 0x06090011,
  value_range = 0x06090030,
  value_too_high = 0x06090031,
  value_too_low = 0x06090032,
  cannot_store = 0x08000020,
  not_in_this_state = 0x08000022,
  no_data = 0x08000024,
};

/// Where in the dictionary.
struct ObjectAddress {
  std::uint16_t index = 0;
  std::uint8_t sub = 0;

  friend bool operator==(const ObjectAddress&, const ObjectAddress&) = default;
};

inline constexpr std::size_t kSdoBytes = 8;         ///< Length of every SDO frame.
inline constexpr std::size_t kExpeditedBytes = 4;   ///< Max data bytes in one frame.
inline constexpr std::size_t kSdoSegmentBytes = 7;  ///< Max data bytes in one segment.

/// Kind of a client's request.
enum class SdoRequestKind : std::uint8_t {
  download,           ///< Write, expedited: `data` holds it.
  download_segments,  ///< Write in segments: `announced` bytes (0: not said).
  download_segment,
  upload,  ///< Read.
  upload_segment,
  abort,
  other,  ///< A command that this header does not know (block transfer).
};

struct SdoRequest {
  SdoRequestKind kind = SdoRequestKind::other;
  ObjectAddress object = {};    ///< Not of segments.
  std::uint32_t announced = 0;  ///< Bytes of a segmented download; 0 when not indicated.
  bool size_indicated = false;  ///< Expedited: `length` is said, not assumed to be 4.
  bool toggle = false;          ///< Segments.
  bool last = false;            ///< Segments.
  std::uint8_t length = 0;      ///< Bytes of `data`.
  std::array<std::uint8_t, kSdoSegmentBytes> data{};
};

/// Malformed unless the payload has exactly eight bytes.
[[nodiscard]] Decoded<SdoRequest> decode_sdo_request(std::span<const std::uint8_t> payload);

using SdoPayload = std::array<std::uint8_t, kSdoBytes>;

/// The client's side, for masters and tests. Precondition: data.size() is 1..4.
[[nodiscard]] SdoPayload make_download(ObjectAddress object, std::span<const std::uint8_t> data);
[[nodiscard]] SdoPayload make_upload(ObjectAddress object);
[[nodiscard]] SdoPayload make_upload_segment_request(bool toggle);

/// The server's answers.
[[nodiscard]] SdoPayload make_download_answer(ObjectAddress object);
[[nodiscard]] SdoPayload make_download_segment_answer(bool toggle);
/// Precondition: data.size() is 1..4.
[[nodiscard]] SdoPayload make_upload_answer(ObjectAddress object,
                                            std::span<const std::uint8_t> data);
/// `bytes` will follow in segments.
[[nodiscard]] SdoPayload make_upload_announcement(ObjectAddress object, std::uint32_t bytes);
/// Precondition: data.size() <= 7.
[[nodiscard]] SdoPayload make_upload_segment(bool toggle, bool last,
                                             std::span<const std::uint8_t> data);
[[nodiscard]] SdoPayload make_abort(ObjectAddress object, SdoAbort code);

}  // namespace rigwire::protocols::canopen
