// A serial line on USB (CDC-ACM), as devices with a USB socket of their own have it.
//
// The device's side sends bytes in and is notified of what the host sent and how it set the line.
// What is sent waits in a queue of `queue_bytes` for the host's reads; a unit that does not fit is
// lost whole and counted. While no client has the line open nothing waits: bytes are taken and
// forgotten, and what the last client left unread goes with it.
//
// A client is present while DTR is set or the host reads: a host opens the line by one or the
// other. The host has stopped reading when it takes its last read back, or has had it answered and
// asks for nothing within kReadPause.
//
// A read of the host ends with the bytes that there are, at most as many as it asks for. It ends
// short, by a packet that is not full or, after a multiple of the packet size, by an empty one;
// USB/IP carries transfers, so that the packets themselves do not show.
//
// Requests: SET and GET_LINE_CODING, SET_CONTROL_LINE_STATE, SEND_BREAK where the capabilities have
// it; others stall. The notification SERIAL_STATE goes out on the interrupt endpoint.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "emulators/usb/usb_device.h"
#include "protocols/usb/cdc.h"

namespace rigwire::emulators {

struct CdcAcmSettings {
  std::uint16_t usb_version = 0x0110;  ///< Binary coded decimal.
  std::uint16_t vendor = 0;
  std::uint16_t product = 0;
  std::uint16_t release = 0x0100;
  std::string manufacturer;
  std::string product_name;
  std::string serial_number;
  bool self_powered = true;
  std::uint8_t maximum_power_2ma = 50;
  std::uint8_t capabilities = protocols::usb::cdc::kHasLineCoding;
  /// The descriptor that joins both interfaces. Some devices lack it; hosts then go by the call
  /// management descriptor.
  bool union_descriptor = true;
  std::uint8_t data_protocol = 0;
  protocols::usb::cdc::LineCoding line_coding;  ///< After power-on.
  std::size_t queue_bytes = 4096;               ///< 64 .. 65536.
};

/// How the host has set the line.
struct CdcAcmLine {
  bool client_present = false;
  bool data_terminal_ready = false;
  bool request_to_send = false;
  bool sending_break = false;
  protocols::usb::cdc::LineCoding coding;

  friend bool operator==(const CdcAcmLine&, const CdcAcmLine&) = default;
};

/// The device behind the line.
class CdcAcmDevice {
 public:
  virtual ~CdcAcmDevice() = default;
  virtual void received(SimTime now, std::span<const std::uint8_t> bytes) = 0;
  /// After every change.
  virtual void line_changed(SimTime now, const CdcAcmLine& line) = 0;
};

class CdcAcm final : public UsbDevice {
 public:
  static constexpr std::uint8_t kNotificationEndpoint = 0x83;
  static constexpr std::uint8_t kOutEndpoint = 0x01;
  static constexpr std::uint8_t kInEndpoint = 0x82;
  static constexpr std::uint16_t kPacketBytes = 64;
  /// Longer than any host needs to ask again.
  static constexpr Duration kReadPause = std::chrono::milliseconds(200);

  /// `device` must outlive this. Throws std::invalid_argument.
  CdcAcm(const CdcAcmSettings& settings, CdcAcmDevice& device);

  /// False when the bytes did not fit.
  bool send(SimTime now, std::span<const std::uint8_t> bytes);
  /// Bits of serial_state; sent to the host when they changed or are events.
  void set_serial_state(SimTime now, std::uint16_t state);
  [[nodiscard]] const CdcAcmLine& line() const { return line_; }
  [[nodiscard]] std::uint64_t lost_bytes() const { return lost_bytes_; }

  [[nodiscard]] const protocols::usb::DeviceDescription& description() const override {
    return description_;
  }
  void plugged(SimTime now, UsbHost& host) override;
  void unplugged(SimTime now) override;
  void configured(SimTime now, std::uint8_t configuration) override;
  void control(SimTime now, UsbTransfer transfer, const protocols::usb::Setup& setup,
               std::span<const std::uint8_t> data) override;
  void read(SimTime now, UsbTransfer transfer, std::uint8_t endpoint, std::size_t length) override;
  void write(SimTime now, UsbTransfer transfer, std::uint8_t endpoint,
             std::span<const std::uint8_t> data) override;
  [[nodiscard]] bool cancel(SimTime now, UsbTransfer transfer) override;
  void advance(SimTime now) override;
  [[nodiscard]] SimTime next_event() const override;

 private:
  struct Read {
    UsbTransfer transfer = 0;
    std::size_t length = 0;
  };

  void power_on(SimTime now);
  /// Hands queued bytes to open reads.
  void pump(SimTime now);
  void pump_notifications(SimTime now);
  /// Updates whether a client is present, and notifies the device of any change.
  void update_line(SimTime now, CdcAcmLine line);
  [[nodiscard]] bool serve(SimTime now, UsbTransfer transfer, const protocols::usb::Setup& setup,
                           std::span<const std::uint8_t> data);

  CdcAcmSettings settings_;
  CdcAcmDevice& device_;
  protocols::usb::DeviceDescription description_;
  UsbHost* host_ = nullptr;
  CdcAcmLine line_;
  bool reading_ = false;           ///< The host keeps reads open.
  SimTime reading_ends_ = kNever;  ///< Unless it asks again.
  std::vector<Read> reads_;
  std::vector<Read> notification_reads_;
  std::vector<std::uint8_t> queue_;
  std::size_t queue_begin_ = 0;
  std::uint16_t serial_state_ = 0;
  bool notify_ = false;
  SimTime break_ends_ = kNever;
  std::uint64_t lost_bytes_ = 0;
};

/// How u-blox receivers present themselves on their USB socket: generation 7 byte for byte as such
/// a device was read. Generations 8 and 9 differ from it by what is commonly reported of them
/// (product id, product name, release); their other descriptors were not read from a device and are
/// taken to be the same. A receiver ignores the line coding: its USB port has no speed.
///
/// `generation` is UbloxProfile::generation: 7, 8 or 9. Throws std::invalid_argument.
[[nodiscard]] CdcAcmSettings ublox_usb(int generation);

}  // namespace rigwire::emulators
