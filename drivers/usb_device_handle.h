// One USB device that this program has opened.
//
// Transfers end in the order that the device likes, each exactly once, from within the io_context
// of the UsbHost, never from within the call that began it. A transfer that cannot be begun
// (unplugged, not claimed) ends the same way.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>

#include "protocols/usb/descriptors.h"
#include "protocols/usb/transfer.h"

struct libusb_context;
struct libusb_device_handle;

namespace boost::asio {
class io_context;
}

namespace rigwire::drivers {

class UsbDeviceHandle {
 public:
  /// Number of a transfer, never reused.
  using Transfer = std::uint64_t;
  struct Result {
    protocols::usb::Outcome outcome = protocols::usb::Outcome::done;
    std::span<const std::uint8_t> data{};  ///< From the device; valid during the call.
    std::size_t taken = 0;                 ///< Bytes that the device took.
  };
  using Done = std::function<void(const Result&)>;

  /// UsbHost::open() makes one. Takes `handle` over. Throws EndpointError when the device does not
  /// give its descriptors.
  UsbDeviceHandle(boost::asio::io_context& io, libusb_context* context,
                  libusb_device_handle* handle, std::string address);
  /// Takes open transfers back without ending them, and gives the interfaces to the kernel's
  /// drivers again.
  ~UsbDeviceHandle();
  UsbDeviceHandle(const UsbDeviceHandle&) = delete;
  UsbDeviceHandle& operator=(const UsbDeviceHandle&) = delete;

  /// Read from the device, its present configuration.
  [[nodiscard]] const protocols::usb::DeviceDescription& description() const;
  /// "usb 1-1.4 1d50:606f"
  [[nodiscard]] const std::string& address() const;

  /// Takes an interface from the kernel's driver, if it has one. Throws EndpointError.
  void claim(std::uint8_t interface);
  void release(std::uint8_t interface);

  /// `data`: what goes to the device, setup.length bytes; none for a request to the host.
  Transfer control(const protocols::usb::Setup& setup, std::span<const std::uint8_t> data,
                   Done done, std::chrono::milliseconds limit = std::chrono::seconds{1});
  /// Bulk or interrupt, as the endpoint is; no time limit.
  Transfer read(std::uint8_t endpoint, std::size_t length, Done done);
  Transfer write(std::uint8_t endpoint, std::span<const std::uint8_t> data, Done done);
  /// It ends with Outcome::cancelled unless it has ended already.
  void cancel(Transfer transfer);
  /// Lets a stalled endpoint go on. Blocks for one control transfer; false when refused.
  bool clear_halt(std::uint8_t endpoint);
  [[nodiscard]] std::size_t open_transfers() const;

 private:
  struct State;
  std::shared_ptr<State> state_;
};

}  // namespace rigwire::drivers
