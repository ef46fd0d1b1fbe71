#include "protocols/ubx/version.h"

#include <algorithm>

#include "protocols/ubx/monitor.h"

namespace rigwire::protocols::ubx {
namespace {

void put_text(std::string_view text, std::span<std::uint8_t> field) {
  std::ranges::fill(field, std::uint8_t{0});
  std::ranges::copy(text.substr(0, field.size()), field.begin());
}

std::string get_text(std::span<const std::uint8_t> field) {
  return {field.begin(), std::ranges::find(field, std::uint8_t{0})};
}

}  // namespace

std::vector<std::uint8_t> version_payload(const Version& version) {
  constexpr std::size_t kBlock = MonVerExtension::kLength;
  std::vector<std::uint8_t> payload(MonVerHead::kLength + kBlock * version.extensions.size());
  MonVerHead head;
  put_text(version.software, head.software);
  put_text(version.hardware, head.hardware);
  write_payload(head, std::span(payload).first(MonVerHead::kLength));
  for (std::size_t i = 0; i < version.extensions.size(); ++i) {
    MonVerExtension extension;
    put_text(version.extensions[i], extension.text);
    write_payload(extension, std::span(payload).subspan(MonVerHead::kLength + i * kBlock, kBlock));
  }
  return payload;
}

Decoded<Version> decode_version(const FrameView& frame) {
  constexpr std::size_t kBlock = MonVerExtension::kLength;
  if (frame.id != MonVerHead::kId) {
    return Malformed{"another UBX message", 2};
  }
  if (frame.payload.size() < MonVerHead::kLength ||
      (frame.payload.size() - MonVerHead::kLength) % kBlock != 0) {
    return Malformed{"UBX payload length", 4};
  }
  Version version;
  const auto head = read_payload<MonVerHead>(frame.payload);
  version.software = get_text(head.software);
  version.hardware = get_text(head.hardware);
  for (std::size_t at = MonVerHead::kLength; at < frame.payload.size(); at += kBlock) {
    version.extensions.push_back(
        get_text(read_payload<MonVerExtension>(frame.payload.subspan(at)).text));
  }
  return {std::move(version), kOverheadBytes + frame.payload.size()};
}

}  // namespace rigwire::protocols::ubx
