// What is said on the connection that has imported a device: transfers asked for, taken back and
// ended. A header of 48 bytes; behind a submit to the device its data, behind an answered submit to
// the host its data.
//
// Source: see constants.h.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <variant>

#include "protocols/result.h"
#include "protocols/usb/transfer.h"
#include "protocols/usbip/constants.h"

namespace rigwire::protocols::usbip {

/// The host requests a transfer.
struct Submit {
  std::uint32_t number = 0;  ///< Number of the transfer, chosen by the host.
  std::uint32_t device = 0;  ///< Bus in the upper half, device in the lower.
  bool to_host = false;
  std::uint8_t endpoint = 0;  ///< 0 .. 15, without direction.
  std::uint32_t flags = 0;    ///< URB_* of Linux.
  std::uint32_t length = 0;   ///< Bytes to send along, or that may come back; below 2^31.
  std::uint32_t start_frame = 0;
  std::uint32_t packets = 0;  ///< Isochronous packets; 0 for kNoPackets.
  std::uint32_t interval = 0;
  usb::SetupBytes setup{};  ///< Setup packet of control transfers.

  /// Bytes that follow the header: data to the device, records of isochronous packets.
  [[nodiscard]] std::size_t tail_size() const {
    return (to_host ? 0U : length) + std::size_t{packets} * kIsochronousRecordSize;
  }
  friend bool operator==(const Submit&, const Submit&) = default;
};

/// The host cancels a transfer.
struct Unlink {
  std::uint32_t number = 0;  ///< Number of this message.
  std::uint32_t device = 0;
  std::uint32_t transfer = 0;  ///< The number of the submit.

  friend bool operator==(const Unlink&, const Unlink&) = default;
};

struct SubmitReply {
  std::uint32_t number = 0;
  std::int32_t status = 0;
  std::uint32_t actual_length = 0;  ///< Bytes transferred; to the host they follow the header.

  friend bool operator==(const SubmitReply&, const SubmitReply&) = default;
};

/// status::kUnlinked: the transfer will not be answered. 0: it had been answered already.
struct UnlinkReply {
  std::uint32_t number = 0;
  std::int32_t status = 0;

  friend bool operator==(const UnlinkReply&, const UnlinkReply&) = default;
};

using FromHost = std::variant<Submit, Unlink>;
using FromDevice = std::variant<SubmitReply, UnlinkReply>;
using CommandBytes = std::array<std::uint8_t, kCommandHeaderSize>;

/// Takes the header only; Submit::tail_size() bytes follow. Malformed, because nothing behind it
/// could be trusted: another command, a direction other than 0 and 1, an endpoint above 15, a
/// length of 2^31 or more, data to the device beyond kDataMaximum, more than kPacketsMaximum
/// packets.
[[nodiscard]] Decoded<FromHost> decode_from_host(std::span<const std::uint8_t> bytes);
[[nodiscard]] CommandBytes encode(const Submit& submit);
[[nodiscard]] CommandBytes encode(const Unlink& unlink);

/// The host's side; of answered submits the header only.
[[nodiscard]] Decoded<FromDevice> decode_from_device(std::span<const std::uint8_t> bytes);
[[nodiscard]] CommandBytes encode(const SubmitReply& reply);
[[nodiscard]] CommandBytes encode(const UnlinkReply& reply);

}  // namespace rigwire::protocols::usbip
