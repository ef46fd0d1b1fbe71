// The line of a serial device that has a USB socket instead: a stream like that of a pty, on a
// CDC-ACM device of the rig's USB bus.
//
// A client is present while it has the line open (emulators/usb/cdc_acm.h). Its speed is reported
// as 0, not known: on USB there is no line whose two ends could differ in speed, and receivers
// ignore what the client sets; line() has it.
#pragma once

#include <boost/asio/io_context.hpp>
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "drivers/endpoints.h"
#include "emulators/usb/cdc_acm.h"
#include "hil/wires/usb_bus.h"

namespace rigwire::hil {

class UsbSerialStream final : public drivers::ByteStream, private emulators::CdcAcmDevice {
 public:
  /// Plugs the device in; `bus` must outlive this. What a client writes faster than the device
  /// takes it is lost beyond kUnreadMaximum bytes. Throws std::invalid_argument.
  UsbSerialStream(boost::asio::io_context& io, UsbBus& bus,
                  const emulators::CdcAcmSettings& settings, std::string_view name);
  ~UsbSerialStream() override;

  static constexpr std::size_t kUnreadMaximum = 65536;

  void start(Receiver receiver) override;
  void on_client(ClientWatcher watcher) override { watcher_ = std::move(watcher); }
  std::size_t write(std::span<const std::uint8_t> bytes) override;
  [[nodiscard]] drivers::EndpointStatus status() const override;

  /// Returns the client's settings, whether or not it is present.
  [[nodiscard]] const emulators::CdcAcmLine& line() const { return usb_.line(); }
  [[nodiscard]] UsbBus::Socket socket() const { return socket_; }

 private:
  void received(SimTime now, std::span<const std::uint8_t> bytes) override;
  void line_changed(SimTime now, const emulators::CdcAcmLine& line) override;
  /// Posts the changes to the io_context, whatever caused them.
  void call_later();
  void hand_on();
  void tell(bool present);

  boost::asio::io_context& io_;
  UsbBus& bus_;
  emulators::CdcAcm usb_;
  UsbBus::Socket socket_;
  Receiver receiver_;
  ClientWatcher watcher_;
  std::vector<std::uint8_t> unread_;
  std::vector<std::uint8_t> handing_on_;
  bool told_present_ = false;
  bool call_pending_ = false;
  std::shared_ptr<char> alive_ = std::make_shared<char>();
};

}  // namespace rigwire::hil
