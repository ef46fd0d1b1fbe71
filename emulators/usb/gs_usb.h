// A USB to CAN adapter with the candleLight firmware: what the Linux driver gs_usb makes a canX of.
//
// On one side the USB device 1d50:606f with one channel; on the other a CAN controller on a bus
// (GsUsbWire), which the host's bit timing and mode open and close.
//
// - A frame from the host goes to the controller, three at a time, in order. It is returned with
//   its echo number when the controller says that it has been sent, stamped with its end of frame:
//   the host's queue moves at the pace of the bus. A frame that never will be (one-shot, bus-off)
//   is returned as well, because the host waits for its number and the protocol has no other word.
// - Frames from the bus, echoes and error frames share a memory of bounded size with those from the
//   host. When it is full, received frames are lost and counted, and the next one that gets through
//   says so (overflow flag); transfers from the host wait.
// - Error frames come with every change of the controller's error state; with each bus error only
//   when the host asked for it (Feature::kBusErrors). After a bus-off the adapter restarts its
//   controller by itself 100 ms later, unless the host took that over (Feature::kBusOffRecovery).
// - Loop-back stays inside: a frame takes its time on the wire, is returned, and is received.
//
// Source: candleLight_fw at 64dc8dc (src/usbd_gs_can.c, src/can_common.c, src/can/bxcan.c, board
// candleLight). docs/devices/gs-usb-adapter.md lists every request and all deviations: above all,
// that firmware returns a frame when a transmit mailbox took it, not when it was sent.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "emulators/bounded_queue.h"
#include "emulators/can/can_node.h"
#include "emulators/usb/usb_device.h"
#include "protocols/can/controller_report.h"
#include "protocols/can/frame.h"
#include "protocols/gs_usb/host_frame.h"
#include "protocols/gs_usb/requests.h"

namespace rigwire::emulators {

/// The adapter's controller, in front of a bus. What happens there goes back by the adapter's
/// received(), confirmed() and reported(), also from within these calls.
class GsUsbWire {
 public:
  virtual ~GsUsbWire() = default;
  /// The host opened or closed the controller (`present`), or it restarts after bus-off: then it is
  /// closed and opened. Closing drops the frames that were not sent yet.
  virtual void set_controller(SimTime now, const OutsideController& controller) = 0;
  /// Each frame is confirmed exactly once, in order, those that closing dropped included.
  virtual void send(SimTime now, const protocols::can::Frame& frame) = 0;
};

struct GsUsbSettings {
  std::string serial_number = "52494757495245474B555342";  ///< 24 hexadecimal digits.
  /// The firmware has 64. A host that is served over a network, or is busy otherwise, comes later
  /// than one with a cable: at 1 Mbit/s 64 frames are 8 ms.
  std::size_t memory_frames = 64;  ///< 16 .. 1024.
};

/// Throws std::invalid_argument with the quantity, the value found and what is allowed.
void validate(const GsUsbSettings& settings);

struct GsUsbCounters {
  std::uint64_t from_host = 0;         ///< Frames handed to the controller (or looped back).
  std::uint64_t echoed = 0;            ///< Those of them that were returned to the host.
  std::uint64_t abandoned = 0;         ///< Echoed frames that were never sent.
  std::uint64_t to_host = 0;           ///< Frames received from the bus and taken by the host.
  std::uint64_t lost = 0;              ///< Frames to the host without room, or too long to be read.
  std::uint64_t error_frames = 0;      ///< Error frames made for the host.
  std::uint64_t refused_requests = 0;  ///< Stalled, or taken and without effect as in the firmware.
  std::uint64_t malformed_frames = 0;  ///< Packets from the host that are no frame to send.
  std::uint64_t unsent = 0;            ///< Frames from the host while the channel was closed.
  std::uint64_t restarts = 0;          ///< From bus-off.
};

class GsUsbAdapter final : public UsbDevice {
 public:
  static constexpr std::size_t kMemoryMax = 1024;
  static constexpr std::size_t kTransmitMailboxes = 3;
  static constexpr std::size_t kReadsMax = 256;  ///< Open IN transfers; one more stalls.
  static constexpr std::size_t kWritesMax = 64;  ///< Waiting OUT transfers; one more stalls.
  static constexpr Duration kBusOffPause = std::chrono::milliseconds{100};

  /// `wire` must outlive the adapter.
  GsUsbAdapter(const GsUsbSettings& settings, GsUsbWire& wire);

  [[nodiscard]] const protocols::usb::DeviceDescription& description() const override {
    return description_;
  }
  void plugged(SimTime now, UsbHost& host) override;
  void unplugged(SimTime now) override;
  void control(SimTime now, UsbTransfer transfer, const protocols::usb::Setup& setup,
               std::span<const std::uint8_t> data) override;
  void read(SimTime now, UsbTransfer transfer, std::uint8_t endpoint, std::size_t length) override;
  void write(SimTime now, UsbTransfer transfer, std::uint8_t endpoint,
             std::span<const std::uint8_t> data) override;
  [[nodiscard]] bool cancel(SimTime now, UsbTransfer transfer) override;
  void advance(SimTime now) override;
  [[nodiscard]] SimTime next_event() const override;

  /// A frame that another node sent, complete at `now`. False when it was lost.
  bool received(SimTime now, const protocols::can::Frame& frame);
  /// The oldest unconfirmed frame of GsUsbWire::send() was complete at `now`, or never will be.
  void confirmed(SimTime now, bool sent);
  /// Reports the state of the controller to the host. Returns false if the host could not be
  /// notified.
  bool reported(SimTime now, const protocols::can::ControllerReport& report);

  [[nodiscard]] bool attached() const { return host_ != nullptr; }
  /// Returns the controller as set by the host; not present while the channel is closed or looped
  /// back.
  [[nodiscard]] const OutsideController& controller() const { return controller_; }
  /// Returns whether the host requested the blinking that identifies the adapter.
  [[nodiscard]] bool identifying() const { return identifying_; }
  [[nodiscard]] const GsUsbCounters& counters() const { return counters_; }

 private:
  using HostFrame = protocols::gs_usb::HostFrame;
  using Setup = protocols::usb::Setup;
  struct Read {
    UsbTransfer transfer = 0;
    std::size_t length = 0;
  };
  struct Write {
    UsbTransfer transfer = 0;
    std::array<std::uint8_t, protocols::gs_usb::kPacketBytes> bytes{};
    std::size_t size = 0;
  };

  // Requests.
  void stall(SimTime now, UsbTransfer transfer);
  void answer(SimTime now, UsbTransfer transfer, const Setup& setup,
              std::span<const std::uint8_t> bytes);
  void vendor_to_host(SimTime now, UsbTransfer transfer, const Setup& setup);
  void vendor_from_host(SimTime now, UsbTransfer transfer, const Setup& setup,
                        std::span<const std::uint8_t> data);
  void firmware_upgrade(SimTime now, UsbTransfer transfer, const Setup& setup);
  /// False when it has no effect.
  [[nodiscard]] bool set_bit_timing(const protocols::gs_usb::BitTiming& timing);
  [[nodiscard]] bool set_mode(SimTime now, const protocols::gs_usb::Mode& mode);
  [[nodiscard]] protocols::gs_usb::ControllerState state() const;

  // Frames.
  [[nodiscard]] std::size_t room() const;
  [[nodiscard]] bool asked(std::uint32_t feature) const { return (flags_ & feature) != 0; }
  void start(SimTime now);
  void stop(SimTime now);
  void restart(SimTime now);
  /// The frames in the controller will be confirmed, but are forgotten.
  void drop_mailboxes();
  void accept(std::span<const std::uint8_t> packet);
  /// Hands frames to the controller as long as it has a free mailbox.
  void pump(SimTime now);
  void begin_loop(SimTime now);
  void end_loop();
  /// Queues an error frame; false without room.
  [[nodiscard]] bool tell(SimTime now, const protocols::can::ControllerReport& report);
  void queue_to_host(SimTime now, HostFrame frame);
  void echo(SimTime now, HostFrame frame);
  /// Ends reads and writes as far as frames and room go.
  void settle(SimTime now);

  protocols::usb::DeviceDescription description_;
  std::size_t memory_frames_;
  GsUsbWire& wire_;
  UsbHost* host_ = nullptr;

  std::optional<std::uint32_t> bit_rate_bps_;
  OutsideController controller_;
  bool started_ = false;
  std::uint32_t flags_ = 0;  ///< Flags of the mode request.
  bool identifying_ = false;
  protocols::can::ControllerReport latest_;
  SimTime restart_at_ = kNever;

  BoundedQueue<HostFrame, kMemoryMax> from_host_;
  BoundedQueue<HostFrame, kTransmitMailboxes> in_controller_;
  std::size_t dropped_ = 0;  ///< Frames whose confirmation is to be ignored.
  BoundedQueue<HostFrame, kMemoryMax> to_host_;
  bool overflowed_ = false;  ///< To be said with the next received frame.
  BoundedQueue<Read, kReadsMax> reads_;
  BoundedQueue<Write, kWritesMax> writes_;
  std::optional<HostFrame> looping_;
  SimTime loop_end_ = kNever;
  SimTime loop_free_ = kStart;
  GsUsbCounters counters_;
};

}  // namespace rigwire::emulators
