#include "protocols/canopen/sdo.h"

#include <algorithm>
#include <cassert>

#include "protocols/bytes.h"

namespace rigwire::protocols::canopen {
namespace {

// Command specifiers, already in bits 7..5.
constexpr std::uint8_t kClientDownloadSegment = 0x00;
constexpr std::uint8_t kClientDownload = 0x20;
constexpr std::uint8_t kClientUpload = 0x40;
constexpr std::uint8_t kClientUploadSegment = 0x60;
constexpr std::uint8_t kAbort = 0x80;
constexpr std::uint8_t kServerUploadSegment = 0x00;
constexpr std::uint8_t kServerDownloadSegment = 0x20;
constexpr std::uint8_t kServerUpload = 0x40;
constexpr std::uint8_t kServerDownload = 0x60;

constexpr std::uint8_t kSpecifier = 0xE0;
constexpr std::uint8_t kToggle = 0x10;
constexpr std::uint8_t kExpedited = 0x02;
constexpr std::uint8_t kSizeIndicated = 0x01;
constexpr std::uint8_t kLast = 0x01;

SdoPayload address(std::uint8_t command, ObjectAddress object) {
  SdoPayload payload{};
  payload[0] = command;
  store_little<std::uint16_t>(payload, 1, object.index);
  payload[3] = object.sub;
  return payload;
}

SdoPayload expedited(std::uint8_t specifier, ObjectAddress object,
                     std::span<const std::uint8_t> data) {
  assert(!data.empty() && data.size() <= kExpeditedBytes);
  const auto unused = static_cast<unsigned>(kExpeditedBytes - data.size());
  SdoPayload payload = address(
      static_cast<std::uint8_t>(specifier | (unused << 2U) | kExpedited | kSizeIndicated), object);
  std::copy(data.begin(), data.end(), payload.begin() + 4);
  return payload;
}

SdoPayload segment(std::uint8_t specifier, bool toggle) {
  SdoPayload payload{};
  payload[0] = static_cast<std::uint8_t>(specifier | (toggle ? kToggle : 0U));
  return payload;
}

}  // namespace

// Reads a client's request by its command specifier (CiA 301 V4.2.0, 7.2.4.3). Expedited data and
// segments give the number of unused bytes; `length` is the rest.
Decoded<SdoRequest> decode_sdo_request(std::span<const std::uint8_t> payload) {
  if (payload.size() != kSdoBytes) {
    return Malformed{"an SDO frame has exactly 8 bytes", payload.size()};
  }
  const std::uint8_t command = payload[0];
  SdoRequest request;
  request.object = {load_little<std::uint16_t>(payload, 1), payload[3]};
  request.toggle = (command & kToggle) != 0;
  switch (command & kSpecifier) {
    case kClientDownload:
      request.size_indicated = (command & kSizeIndicated) != 0;
      if ((command & kExpedited) == 0) {
        request.kind = SdoRequestKind::download_segments;
        request.announced = request.size_indicated ? load_little<std::uint32_t>(payload, 4) : 0U;
        break;
      }
      request.kind = SdoRequestKind::download;
      request.length = static_cast<std::uint8_t>(
          request.size_indicated ? kExpeditedBytes - ((command >> 2U) & 3U) : kExpeditedBytes);
      std::copy_n(payload.begin() + 4, request.length, request.data.begin());
      break;
    case kClientDownloadSegment:
      request.kind = SdoRequestKind::download_segment;
      request.last = (command & kLast) != 0;
      request.length = static_cast<std::uint8_t>(kSdoSegmentBytes - ((command >> 1U) & 7U));
      std::copy_n(payload.begin() + 1, request.length, request.data.begin());
      break;
    case kClientUpload:
      request.kind = SdoRequestKind::upload;
      break;
    case kClientUploadSegment:
      request.kind = SdoRequestKind::upload_segment;
      break;
    case kAbort:
      request.kind = SdoRequestKind::abort;
      break;
    default:
      break;
  }
  return {request, kSdoBytes};
}

SdoPayload make_download(ObjectAddress object, std::span<const std::uint8_t> data) {
  return expedited(kClientDownload, object, data);
}

SdoPayload make_upload(ObjectAddress object) {
  return address(kClientUpload, object);
}

SdoPayload make_upload_segment_request(bool toggle) {
  return segment(kClientUploadSegment, toggle);
}

SdoPayload make_download_answer(ObjectAddress object) {
  return address(kServerDownload, object);
}

SdoPayload make_download_segment_answer(bool toggle) {
  return segment(kServerDownloadSegment, toggle);
}

SdoPayload make_upload_answer(ObjectAddress object, std::span<const std::uint8_t> data) {
  return expedited(kServerUpload, object, data);
}

SdoPayload make_upload_announcement(ObjectAddress object, std::uint32_t bytes) {
  SdoPayload payload = address(kServerUpload | kSizeIndicated, object);
  store_little<std::uint32_t>(payload, 4, bytes);
  return payload;
}

SdoPayload make_upload_segment(bool toggle, bool last, std::span<const std::uint8_t> data) {
  assert(data.size() <= kSdoSegmentBytes);
  SdoPayload payload = segment(kServerUploadSegment, toggle);
  const auto unused = static_cast<unsigned>(kSdoSegmentBytes - data.size());
  payload[0] = static_cast<std::uint8_t>(payload[0] | (unused << 1U) | (last ? kLast : 0U));
  std::copy(data.begin(), data.end(), payload.begin() + 1);
  return payload;
}

SdoPayload make_abort(ObjectAddress object, SdoAbort code) {
  SdoPayload payload = address(kAbort, object);
  store_little<std::uint32_t>(payload, 4, static_cast<std::uint32_t>(code));
  return payload;
}

}  // namespace rigwire::protocols::canopen
