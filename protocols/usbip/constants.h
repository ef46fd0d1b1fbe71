// Numbers of USB/IP, version 1.1.1. Everything is big endian but what USB itself defines.
//
// Source: Linux, Documentation/usb/usbip_protocol.rst and drivers/usb/usbip/usbip_common.h (6.1).
// The document's offsets in the device record are off by one behind bcdDevice; the order of its
// fields is right.
#pragma once

#include <cstddef>
#include <cstdint>

namespace rigwire::protocols::usbip {

inline constexpr std::uint16_t kVersion = 0x0111;
inline constexpr std::uint16_t kPort = 3240;

/// Before a device is imported.
enum class Operation : std::uint16_t {
  device_list_request = 0x8005,
  device_list_reply = 0x0005,
  import_request = 0x8003,
  import_reply = 0x0003,
};

/// Status of an operation's reply. Linux knows more values, but distinguishes only failure from
/// success.
enum class OperationStatus : std::uint32_t { ok = 0, failed = 1 };

/// Commands on the connection that has imported a device.
enum class Command : std::uint32_t {
  submit = 1,
  unlink = 2,
  submit_reply = 3,
  unlink_reply = 4,
};

/// A transfer's status: negative error numbers of Linux.
namespace status {
inline constexpr std::int32_t kDone = 0;
inline constexpr std::int32_t kNoMemory = -12;      ///< ENOMEM: too many open transfers.
inline constexpr std::int32_t kGone = -19;          ///< ENODEV: unplugged.
inline constexpr std::int32_t kStalled = -32;       ///< EPIPE.
inline constexpr std::int32_t kNotSupported = -38;  ///< ENOSYS: isochronous transfers.
inline constexpr std::int32_t kOverflow = -75;      ///< EOVERFLOW.
inline constexpr std::int32_t kShort = -121;        ///< EREMOTEIO: short where flags forbade it.
inline constexpr std::int32_t kUnlinked = -104;     ///< ECONNRESET.
}  // namespace status

inline constexpr std::size_t kOperationHeaderSize =
    2 /* version */ + 2 /* operation */ + 4 /* status */;
inline constexpr std::size_t kPathSize = 256;
inline constexpr std::size_t kBusIdSize = 32;
inline constexpr std::size_t kDeviceRecordSize =
    kPathSize + kBusIdSize + 4 /* bus */ + 4 /* device */ + 4 /* speed */ + 2 /* vendor */ +
    2 /* product */ + 2 /* release */ + 1 /* class */ + 1 /* subclass */ + 1 /* protocol */ +
    1 /* configuration value */ + 1 /* configurations */ + 1 /* interfaces */;
static_assert(kDeviceRecordSize == 312);
inline constexpr std::size_t kInterfaceRecordSize =
    1 /* class */ + 1 /* subclass */ + 1 /* protocol */ + 1 /* padding */;
inline constexpr std::size_t kImportRequestSize = kOperationHeaderSize + kBusIdSize;
inline constexpr std::size_t kImportReplySize = kOperationHeaderSize + kDeviceRecordSize;
inline constexpr std::size_t kCommandHeaderSize =
    20 /* command, number, device, direction, endpoint */ + 20 /* of the command */ + 8 /* setup */;
static_assert(kCommandHeaderSize == 48);
inline constexpr std::size_t kIsochronousRecordSize =
    4 /* offset */ + 4 /* length */ + 4 /* actual */ + 4 /* status */;

/// Value for "no isochronous packets" in the document; Linux sends 0.
inline constexpr std::uint32_t kNoPackets = 0xFFFFFFFF;
/// Transfer flag: an answer shorter than asked for is an error.
inline constexpr std::uint32_t kShortNotOk = 1;
/// Max number of packets that Linux sends in one transfer.
inline constexpr std::uint32_t kPacketsMaximum = 1024;
/// Max bytes of one transfer to the device. Drivers of Linux stay far below; it limits the memory
/// of a connection.
inline constexpr std::size_t kDataMaximum = std::size_t{1} << 20U;

}  // namespace rigwire::protocols::usbip
