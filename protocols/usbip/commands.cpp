#include "protocols/usbip/commands.h"

#include <algorithm>

#include "protocols/bytes.h"

namespace rigwire::protocols::usbip {
namespace {

// Offsets in the header.
constexpr std::size_t kCommandAt = 0;
constexpr std::size_t kNumberAt = 4;
constexpr std::size_t kDeviceAt = 8;
constexpr std::size_t kDirectionAt = 12;
constexpr std::size_t kEndpointAt = 16;
constexpr std::size_t kFlagsAt = 20;     // submit
constexpr std::size_t kTransferAt = 20;  // unlink
constexpr std::size_t kStatusAt = 20;    // replies
constexpr std::size_t kLengthAt = 24;
constexpr std::size_t kStartFrameAt = 28;
constexpr std::size_t kPacketsAt = 32;
constexpr std::size_t kIntervalAt = 36;
constexpr std::size_t kSetupAt = 40;

std::uint32_t word(std::span<const std::uint8_t> bytes, std::size_t at) {
  return load_big<std::uint32_t>(bytes, at);
}

CommandBytes start(Command command, std::uint32_t number) {
  CommandBytes bytes{};
  store_big(bytes, kCommandAt, static_cast<std::uint32_t>(command));
  store_big(bytes, kNumberAt, number);
  return bytes;
}

Decoded<FromHost> decode_submit(std::span<const std::uint8_t> bytes) {
  if (word(bytes, kDirectionAt) > 1) {
    return Malformed{"direction is 0 or 1", kDirectionAt};
  }
  if (word(bytes, kEndpointAt) > 15) {
    return Malformed{"endpoint is 0 to 15", kEndpointAt};
  }
  Submit submit;
  submit.number = word(bytes, kNumberAt);
  submit.device = word(bytes, kDeviceAt);
  submit.to_host = word(bytes, kDirectionAt) == 1;
  submit.endpoint = static_cast<std::uint8_t>(word(bytes, kEndpointAt));
  submit.flags = word(bytes, kFlagsAt);
  submit.length = word(bytes, kLengthAt);
  submit.start_frame = word(bytes, kStartFrameAt);
  submit.packets = word(bytes, kPacketsAt) == kNoPackets ? 0 : word(bytes, kPacketsAt);
  submit.interval = word(bytes, kIntervalAt);
  std::ranges::copy(bytes.subspan(kSetupAt, usb::kSetupSize), submit.setup.begin());
  if (submit.length > 0x7FFFFFFFU || (!submit.to_host && submit.length > kDataMaximum)) {
    return Malformed{"length is below 2^31, and at most 1 MiB to the device", kLengthAt};
  }
  if (submit.packets > kPacketsMaximum) {
    return Malformed{"a transfer has at most 1024 packets", kPacketsAt};
  }
  return {FromHost{submit}, kCommandHeaderSize};
}

}  // namespace

Decoded<FromHost> decode_from_host(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < kCommandHeaderSize) {
    return Incomplete{kCommandHeaderSize, bytes.size()};
  }
  switch (static_cast<Command>(word(bytes, kCommandAt))) {
    case Command::submit:
      return decode_submit(bytes);
    case Command::unlink:
      return {FromHost{
                  Unlink{word(bytes, kNumberAt), word(bytes, kDeviceAt), word(bytes, kTransferAt)}},
              kCommandHeaderSize};
    default:
      return Malformed{"a host submits or unlinks", kCommandAt};
  }
}

CommandBytes encode(const Submit& submit) {
  CommandBytes bytes = start(Command::submit, submit.number);
  store_big(bytes, kDeviceAt, submit.device);
  store_big(bytes, kDirectionAt, std::uint32_t{submit.to_host ? 1U : 0U});
  store_big(bytes, kEndpointAt, std::uint32_t{submit.endpoint});
  store_big(bytes, kFlagsAt, submit.flags);
  store_big(bytes, kLengthAt, submit.length);
  store_big(bytes, kStartFrameAt, submit.start_frame);
  store_big(bytes, kPacketsAt, submit.packets);
  store_big(bytes, kIntervalAt, submit.interval);
  std::ranges::copy(submit.setup, bytes.begin() + kSetupAt);
  return bytes;
}

CommandBytes encode(const Unlink& unlink) {
  CommandBytes bytes = start(Command::unlink, unlink.number);
  store_big(bytes, kDeviceAt, unlink.device);
  store_big(bytes, kTransferAt, unlink.transfer);
  return bytes;
}

Decoded<FromDevice> decode_from_device(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < kCommandHeaderSize) {
    return Incomplete{kCommandHeaderSize, bytes.size()};
  }
  const std::uint32_t number = word(bytes, kNumberAt);
  const auto status = load_big<std::int32_t>(bytes, kStatusAt);
  switch (static_cast<Command>(word(bytes, kCommandAt))) {
    case Command::submit_reply:
      return {FromDevice{SubmitReply{number, status, word(bytes, kLengthAt)}}, kCommandHeaderSize};
    case Command::unlink_reply:
      return {FromDevice{UnlinkReply{number, status}}, kCommandHeaderSize};
    default:
      return Malformed{"a device answers submits and unlinks", kCommandAt};
  }
}

CommandBytes encode(const SubmitReply& reply) {
  CommandBytes bytes = start(Command::submit_reply, reply.number);
  store_big(bytes, kStatusAt, reply.status);
  store_big(bytes, kLengthAt, reply.actual_length);
  return bytes;
}

CommandBytes encode(const UnlinkReply& reply) {
  CommandBytes bytes = start(Command::unlink_reply, reply.number);
  store_big(bytes, kStatusAt, reply.status);
  return bytes;
}

}  // namespace rigwire::protocols::usbip
