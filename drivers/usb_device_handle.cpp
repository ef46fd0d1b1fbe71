#include "drivers/usb_device_handle.h"

#include <libusb-1.0/libusb.h>

#include <algorithm>
#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <map>
#include <vector>

#include "drivers/endpoints.h"
#include "protocols/usb/descriptor_reader.h"
#include "protocols/usb/transfer.h"

namespace rigwire::drivers {

namespace asio = boost::asio;
namespace usb = protocols::usb;
using usb::Outcome;

namespace {

Outcome outcome_of(libusb_transfer_status status) {
  switch (status) {
    case LIBUSB_TRANSFER_COMPLETED:
      return Outcome::done;
    case LIBUSB_TRANSFER_STALL:
      return Outcome::stalled;
    case LIBUSB_TRANSFER_OVERFLOW:
      return Outcome::overflow;
    case LIBUSB_TRANSFER_TIMED_OUT:
    case LIBUSB_TRANSFER_CANCELLED:
      return Outcome::cancelled;
    case LIBUSB_TRANSFER_ERROR:
    case LIBUSB_TRANSFER_NO_DEVICE:
      break;
  }
  return Outcome::gone;
}

usb::Speed speed_of(libusb_device* device) {
  switch (libusb_get_device_speed(device)) {
    case LIBUSB_SPEED_LOW:
      return usb::Speed::low;
    case LIBUSB_SPEED_FULL:
      return usb::Speed::full;
    default:
      return usb::Speed::high;
  }
}

/// A descriptor as the device gives it; empty when it does not.
std::vector<std::uint8_t> descriptor(libusb_device_handle* handle, std::uint8_t type,
                                     std::uint8_t index, std::uint16_t language = 0) {
  std::vector<std::uint8_t> bytes(4096);
  constexpr unsigned kLimit_ms = 1000;
  const int size = libusb_control_transfer(
      handle, LIBUSB_ENDPOINT_IN, static_cast<std::uint8_t>(usb::StandardRequest::get_descriptor),
      static_cast<std::uint16_t>((type << 8U) | index), language, bytes.data(),
      static_cast<std::uint16_t>(bytes.size()), kLimit_ms);
  bytes.resize(static_cast<std::size_t>(std::max(size, 0)));
  return bytes;
}

std::string text(libusb_device_handle* handle, std::uint8_t index) {
  if (index == 0) {
    return {};
  }
  const auto bytes =
      descriptor(handle, usb::descriptor_type::kString, index, usb::kEnglishUnitedStates);
  const auto decoded = usb::decode_text(bytes);
  return decoded.ok() ? *decoded : std::string{};
}

usb::DeviceDescription describe(libusb_device_handle* handle, const std::string& address) {
  const auto device = usb::decode_device(descriptor(handle, usb::descriptor_type::kDevice, 0));
  const auto configuration =
      usb::decode_configuration(descriptor(handle, usb::descriptor_type::kConfiguration, 0));
  if (!device.ok() || !configuration.ok()) {
    throw EndpointError(address + ": its descriptors cannot be read; plug it in again");
  }
  usb::DeviceDescription description;
  description.usb_version = device->usb_version;
  description.device_class = device->device_class;
  description.subclass = device->subclass;
  description.protocol = device->protocol;
  description.control_packet_bytes = device->control_packet_bytes;
  description.vendor = device->vendor;
  description.product = device->product;
  description.release = device->release;
  description.manufacturer = text(handle, device->manufacturer_text);
  description.product_name = text(handle, device->product_text);
  description.serial_number = text(handle, device->serial_text);
  description.speed = speed_of(libusb_get_device(handle));
  description.self_powered = configuration->self_powered;
  description.maximum_power_2ma = configuration->maximum_power_2ma;
  description.configuration_value = configuration->value;
  for (const auto& listed : configuration->interfaces) {
    description.interfaces.push_back(listed.interface);
    description.interfaces.back().text = text(handle, listed.text);
  }
  return description;
}

struct HandleDeleter {
  void operator()(libusb_device_handle* handle) const { libusb_close(handle); }
};

struct TransferDeleter {
  void operator()(libusb_transfer* transfer) const { libusb_free_transfer(transfer); }
};

}  // namespace

struct UsbDeviceHandle::State : std::enable_shared_from_this<State> {
  /// One transfer; libusb has a pointer to it until it has ended.
  struct Open {
    State* owner = nullptr;
    Transfer number = 0;
    std::unique_ptr<libusb_transfer, TransferDeleter> transfer{libusb_alloc_transfer(0)};
    std::vector<std::uint8_t> buffer;
    std::size_t header = 0;  ///< Bytes of the buffer before the data.
    bool to_host = false;
    Done done;
  };

  State(asio::io_context& io_context, libusb_context* usb_context, libusb_device_handle* opened,
        std::string name)
      : io(io_context), context(usb_context), handle(opened), address(std::move(name)) {}

  [[nodiscard]] bool is_interrupt(std::uint8_t endpoint) const {
    for (const auto& interface : description.interfaces) {
      for (const auto& known : interface.endpoints) {
        if (known.address == endpoint) {
          return known.type == usb::TransferType::interrupt;
        }
      }
    }
    return false;
  }

  Transfer begin_data(std::uint8_t endpoint, std::vector<std::uint8_t> buffer, Done done) {
    auto open = std::make_unique<Open>();
    open->buffer = std::move(buffer);
    open->to_host = (endpoint & usb::kToHost) != 0;
    open->done = std::move(done);
    const auto fill =
        is_interrupt(endpoint) ? libusb_fill_interrupt_transfer : libusb_fill_bulk_transfer;
    fill(open->transfer.get(), handle.get(), endpoint, open->buffer.data(),
         static_cast<int>(open->buffer.size()), &State::ended, open.get(), 0);
    return begin(std::move(open));
  }

  Transfer begin(std::unique_ptr<Open> open) {
    const Transfer number = ++newest;
    open->owner = this;
    open->number = number;
    if (libusb_submit_transfer(open->transfer.get()) == LIBUSB_SUCCESS) {
      transfers.emplace(number, std::move(open));
    } else {
      tell(std::move(open), {.outcome = Outcome::gone});
    }
    return number;
  }

  /// From within libusb.
  static void LIBUSB_CALL ended(libusb_transfer* transfer) {
    State& state = *static_cast<Open*>(transfer->user_data)->owner;
    auto node = state.transfers.extract(static_cast<Open*>(transfer->user_data)->number);
    std::unique_ptr<Open> open = std::move(node.mapped());
    const auto actual = static_cast<std::size_t>(transfer->actual_length);
    Result result{.outcome = outcome_of(transfer->status)};
    if (open->to_host) {
      result.data = std::span(open->buffer).subspan(open->header, actual);
    } else {
      result.taken = actual;
    }
    state.tell(std::move(open), result);
  }

  /// Calls `done` from the io_context: it may begin, cancel and close transfers, which must not
  /// happen from within libusb.
  void tell(std::shared_ptr<Open> open, Result result) {
    asio::post(io, [weak = weak_from_this(), open = std::move(open), result] {
      if (weak.lock()) {
        open->done(result);
      }
    });
  }

  /// Cancelled transfers come back at once: the kernel holds them, not the device.
  void close() {
    for (const auto& [number, open] : transfers) {
      libusb_cancel_transfer(open->transfer.get());
    }
    for (int attempt = 0; !transfers.empty() && attempt < 100; ++attempt) {
      timeval limit{.tv_sec = 0, .tv_usec = 10'000};
      libusb_handle_events_timeout_completed(context, &limit, nullptr);
    }
  }

  asio::io_context& io;
  libusb_context* context;
  std::unique_ptr<libusb_device_handle, HandleDeleter> handle;
  std::string address;
  usb::DeviceDescription description;
  std::map<Transfer, std::unique_ptr<Open>> transfers;
  Transfer newest = 0;
};

UsbDeviceHandle::UsbDeviceHandle(asio::io_context& io, libusb_context* context,
                                 libusb_device_handle* handle, std::string address)
    : state_(std::make_shared<State>(io, context, handle, std::move(address))) {
  state_->description = describe(handle, state_->address);
  libusb_set_auto_detach_kernel_driver(handle, 1);
}

UsbDeviceHandle::~UsbDeviceHandle() {
  state_->close();
}

const usb::DeviceDescription& UsbDeviceHandle::description() const {
  return state_->description;
}

const std::string& UsbDeviceHandle::address() const {
  return state_->address;
}

void UsbDeviceHandle::claim(std::uint8_t interface) {
  const int error = libusb_claim_interface(state_->handle.get(), interface);
  if (error != LIBUSB_SUCCESS) {
    throw EndpointError(state_->address + ": interface " + std::to_string(interface) +
                        " cannot be claimed: " + libusb_strerror(error) +
                        (error == LIBUSB_ERROR_BUSY ? "; another program has it: close that"
                                                    : "; plug the device in again"));
  }
}

void UsbDeviceHandle::release(std::uint8_t interface) {
  static_cast<void>(libusb_release_interface(state_->handle.get(), interface));
}

UsbDeviceHandle::Transfer UsbDeviceHandle::control(const usb::Setup& setup,
                                                   std::span<const std::uint8_t> data, Done done,
                                                   std::chrono::milliseconds limit) {
  auto open = std::make_unique<State::Open>();
  const auto header = usb::encode_setup(setup);
  open->header = header.size();
  open->buffer.resize(header.size() + setup.length);
  std::ranges::copy(header, open->buffer.begin());
  if (!setup.to_host()) {
    std::ranges::copy(data.first(std::min<std::size_t>(data.size(), setup.length)),
                      open->buffer.begin() + static_cast<std::ptrdiff_t>(header.size()));
  }
  open->to_host = setup.to_host();
  open->done = std::move(done);
  libusb_fill_control_transfer(open->transfer.get(), state_->handle.get(), open->buffer.data(),
                               &State::ended, open.get(), static_cast<unsigned>(limit.count()));
  return state_->begin(std::move(open));
}

UsbDeviceHandle::Transfer UsbDeviceHandle::read(std::uint8_t endpoint, std::size_t length,
                                                Done done) {
  return state_->begin_data(endpoint, std::vector<std::uint8_t>(length), std::move(done));
}

UsbDeviceHandle::Transfer UsbDeviceHandle::write(std::uint8_t endpoint,
                                                 std::span<const std::uint8_t> data, Done done) {
  return state_->begin_data(endpoint, {data.begin(), data.end()}, std::move(done));
}

void UsbDeviceHandle::cancel(Transfer transfer) {
  if (const auto found = state_->transfers.find(transfer); found != state_->transfers.end()) {
    static_cast<void>(libusb_cancel_transfer(found->second->transfer.get()));
  }
}

bool UsbDeviceHandle::clear_halt(std::uint8_t endpoint) {
  return libusb_clear_halt(state_->handle.get(), endpoint) == LIBUSB_SUCCESS;
}

std::size_t UsbDeviceHandle::open_transfers() const {
  return state_->transfers.size();
}

}  // namespace rigwire::drivers
