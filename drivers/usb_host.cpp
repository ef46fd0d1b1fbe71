#include "drivers/usb_host.h"

#include <libusb-1.0/libusb.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/post.hpp>
#include <charconv>
#include <cstdio>
#include <fstream>
#include <map>
#include <optional>
#include <stdexcept>
#include <tuple>

namespace rigwire::drivers {

namespace {

std::optional<std::uint16_t> hexadecimal(std::string_view text) {
  std::uint16_t value = 0;
  const char* const end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(text.data(), end, value, 16);
  if (error != std::errc{} || stopped != end || text.size() != 4) {
    return std::nullopt;
  }
  return value;
}

bool is_place(std::string_view text) {
  const auto dash = text.find('-');
  const auto digits = [](std::string_view part) {
    return !part.empty() && std::ranges::all_of(part, [](char c) { return c >= '0' && c <= '9'; });
  };
  if (dash == std::string_view::npos || !digits(text.substr(0, dash))) {
    return false;
  }
  std::string_view ports = text.substr(dash + 1);
  for (;;) {
    const auto dot = ports.find('.');
    if (!digits(ports.substr(0, dot))) {
      return false;
    }
    if (dot == std::string_view::npos) {
      return true;
    }
    ports.remove_prefix(dot + 1);
  }
}

}  // namespace

bool UsbSelector::matches(const UsbListed& device) const {
  if (!place.empty()) {
    return place == device.place;
  }
  return vendor == device.vendor && product == device.product &&
         (serial_number.empty() || serial_number == device.serial_number);
}

UsbSelector parse_usb_selector(std::string_view text) {
  UsbSelector selector;
  if (is_place(text)) {
    selector.place = text;
    return selector;
  }
  if (text.size() >= 9 && text[4] == ':' && (text.size() == 9 || text[9] == ':')) {
    const auto vendor = hexadecimal(text.substr(0, 4));
    const auto product = hexadecimal(text.substr(5, 4));
    const std::string_view serial = text.size() > 9 ? text.substr(10) : std::string_view{};
    if (vendor && product && (text.size() == 9 || !serial.empty())) {
      selector.vendor = *vendor;
      selector.product = *product;
      selector.serial_number = serial;
      return selector;
    }
  }
  throw std::invalid_argument("USB device '" + std::string(text) +
                              "': vendor:product (1d50:606f), vendor:product:serial number, or the "
                              "place where it is plugged in (1-1.4) expected");
}

namespace asio = boost::asio;

namespace {

[[noreturn]] void fail(const std::string& what, int error, const std::string& mend) {
  throw EndpointError("USB: " + what + ": " + libusb_strerror(error) + "; " + mend);
}

libusb_context* make_context() {
  libusb_context* context = nullptr;
  if (const int error = libusb_init(&context); error != LIBUSB_SUCCESS) {
    fail("libusb does not start", error, "it needs /sys and /dev/bus/usb of the kernel");
  }
  return context;
}

struct ContextDeleter {
  void operator()(libusb_context* context) const { libusb_exit(context); }
};
using Context = std::unique_ptr<libusb_context, ContextDeleter>;

/// All devices of a context.
class DeviceList {
 public:
  explicit DeviceList(libusb_context* context) {
    const ssize_t count = libusb_get_device_list(context, &devices_);
    if (count < 0) {
      fail("the devices cannot be listed", static_cast<int>(count), "mount /dev and /sys");
    }
    count_ = static_cast<std::size_t>(count);
  }
  ~DeviceList() { libusb_free_device_list(devices_, 1); }
  DeviceList(const DeviceList&) = delete;
  DeviceList& operator=(const DeviceList&) = delete;

  [[nodiscard]] std::span<libusb_device* const> devices() const { return {devices_, count_}; }

 private:
  libusb_device** devices_ = nullptr;
  std::size_t count_ = 0;
};

/// The kernel's name of the place: its bus, and the ports on the way to the device.
std::string place_of(libusb_device* device) {
  constexpr int kDeepest = 7;  // USB 2.0, 4.1.1: seven tiers
  std::array<std::uint8_t, kDeepest> ports{};
  const int depth = libusb_get_port_numbers(device, ports.data(), kDeepest);
  const std::string bus = std::to_string(libusb_get_bus_number(device));
  if (depth <= 0) {
    return "usb" + bus;
  }
  std::string place = bus;
  for (int i = 0; i < depth; ++i) {
    place += (i == 0 ? "-" : ".") + std::to_string(ports[static_cast<std::size_t>(i)]);
  }
  return place;
}

std::string kernel_text(const std::string& place, const char* name) {
  std::ifstream file("/sys/bus/usb/devices/" + place + "/" + name);
  std::string text;
  std::getline(file, text);
  return text;
}

bool may_open(const UsbListed& device) {
  std::array<char, 32> path{};
  std::snprintf(path.data(), path.size(), "/dev/bus/usb/%03u/%03u", unsigned{device.bus},
                unsigned{device.address});
  return ::access(path.data(), R_OK | W_OK) == 0;
}

UsbListed describe(libusb_device* device, bool with_texts) {
  libusb_device_descriptor descriptor{};
  libusb_get_device_descriptor(device, &descriptor);  // kept in memory: cannot fail
  UsbListed listed;
  listed.vendor = descriptor.idVendor;
  listed.product = descriptor.idProduct;
  listed.bus = libusb_get_bus_number(device);
  listed.address = libusb_get_device_address(device);
  listed.place = place_of(device);
  if (with_texts) {
    listed.manufacturer = kernel_text(listed.place, "manufacturer");
    listed.product_name = kernel_text(listed.place, "product");
    listed.serial_number = kernel_text(listed.place, "serial");
    listed.permitted = may_open(listed);
  }
  return listed;
}

std::string numbers(const UsbListed& device) {
  std::array<char, 16> text{};
  std::snprintf(text.data(), text.size(), "%04x:%04x", unsigned{device.vendor},
                unsigned{device.product});
  return text.data();
}

std::string udev_rule(const UsbListed& device) {
  const std::string vendor_and_product = numbers(device);
  return "let users open it: echo 'SUBSYSTEM==\"usb\", ATTR{idVendor}==\"" +
         vendor_and_product.substr(0, 4) + "\", ATTR{idProduct}==\"" +
         vendor_and_product.substr(5) +
         "\", TAG+=\"uaccess\"' | sudo tee /etc/udev/rules.d/70-rigwire-usb.rules && sudo udevadm "
         "control --reload && sudo udevadm trigger";
}

}  // namespace

std::vector<UsbListed> list_usb_devices() {
  const Context context(make_context());
  const DeviceList list(context.get());
  std::vector<UsbListed> devices;
  for (libusb_device* const device : list.devices()) {
    devices.push_back(describe(device, true));
  }
  std::ranges::sort(devices, {},
                    [](const UsbListed& device) { return std::tuple(device.bus, device.address); });
  return devices;
}

struct UsbHost::State : std::enable_shared_from_this<State> {
  explicit State(asio::io_context& io_context) : io(io_context), context(make_context()) {}

  void start() {
    libusb_set_pollfd_notifiers(
        context.get(),
        [](int descriptor, short events, void* self) {
          static_cast<State*>(self)->add(descriptor, events);
        },
        [](int descriptor, void* self) { static_cast<State*>(self)->remove(descriptor); }, this);
    const libusb_pollfd** const descriptors = libusb_get_pollfds(context.get());
    for (auto item = descriptors; item != nullptr && *item != nullptr; ++item) {
      add((*item)->fd, (*item)->events);
    }
    libusb_free_pollfds(descriptors);
  }

  void stop() {
    libusb_set_pollfd_notifiers(context.get(), nullptr, nullptr, nullptr);
    while (!watched.empty()) {
      remove(watched.begin()->first);
    }
    watcher = {};
  }

  // libusb calls these two while it opens and closes devices, and while it handles events.
  void add(int descriptor, short events) {
    auto watch = std::make_shared<asio::posix::stream_descriptor>(io, descriptor);
    watched.insert_or_assign(descriptor, watch);
    wait(watch, events);
  }
  void remove(int descriptor) {
    if (const auto found = watched.find(descriptor); found != watched.end()) {
      found->second->release();  // libusb closes it
      watched.erase(found);
    }
  }

  void wait(const std::shared_ptr<asio::posix::stream_descriptor>& watch, short events) {
    const auto direction = (events & POLLOUT) != 0 ? asio::posix::stream_descriptor::wait_write
                                                   : asio::posix::stream_descriptor::wait_read;
    watch->async_wait(direction, [self = weak_from_this(), watch,
                                  events](const boost::system::error_code& error) {
      const auto state = self.lock();
      if (error || !state || !watch->is_open()) {
        return;
      }
      timeval none{};
      libusb_handle_events_timeout_completed(state->context.get(), &none, nullptr);
      if (watch->is_open()) {
        state->wait(watch, events);
      }
    });
  }

  asio::io_context& io;
  Context context;
  std::map<int, std::shared_ptr<asio::posix::stream_descriptor>> watched;
  DeviceWatcher watcher;
};

UsbHost::UsbHost(asio::io_context& context) : state_(std::make_shared<State>(context)) {
  state_->start();
}

UsbHost::~UsbHost() {
  state_->stop();
}

void UsbHost::on_device(DeviceWatcher watcher) {
  state_->watcher = std::move(watcher);
  const int error = libusb_hotplug_register_callback(
      state_->context.get(), LIBUSB_HOTPLUG_EVENT_DEVICE_ARRIVED | LIBUSB_HOTPLUG_EVENT_DEVICE_LEFT,
      0, LIBUSB_HOTPLUG_MATCH_ANY, LIBUSB_HOTPLUG_MATCH_ANY, LIBUSB_HOTPLUG_MATCH_ANY,
      [](libusb_context*, libusb_device* device, libusb_hotplug_event event, void* self) {
        auto& state = *static_cast<State*>(self);
        const bool arrived = event == LIBUSB_HOTPLUG_EVENT_DEVICE_ARRIVED;
        // Devices must not be opened from within libusb's own call.
        asio::post(state.io,
                   [weak = state.weak_from_this(), listed = describe(device, arrived), arrived] {
                     if (const auto alive = weak.lock(); alive && alive->watcher) {
                       alive->watcher(listed, arrived);
                     }
                   });
        return 0;
      },
      state_.get(), nullptr);
  if (error != LIBUSB_SUCCESS) {
    fail("devices that come and go cannot be watched", error, "libusb needs udev for it");
  }
}

std::unique_ptr<UsbDeviceHandle> UsbHost::open(const UsbSelector& selector) {
  const DeviceList list(state_->context.get());
  std::string there;
  for (libusb_device* const device : list.devices()) {
    const UsbListed listed = describe(device, true);
    const std::string name = listed.place + " " + numbers(listed);
    if (!selector.matches(listed)) {
      there += (there.empty() ? "" : ", ") + name;
      continue;
    }
    libusb_device_handle* handle = nullptr;
    const int error = libusb_open(device, &handle);
    if (error == LIBUSB_ERROR_ACCESS) {
      fail("device " + name + " cannot be opened", error, udev_rule(listed));
    }
    if (error != LIBUSB_SUCCESS) {
      fail("device " + name + " cannot be opened", error, "plug it in again");
    }
    return std::make_unique<UsbDeviceHandle>(state_->io, state_->context.get(), handle,
                                             "usb " + name);
  }
  throw EndpointError("USB: no such device; there " +
                      (there.empty() ? std::string("is none") : "are " + there) +
                      "; `rigwire doctor` and `lsusb` list them");
}

}  // namespace rigwire::drivers
