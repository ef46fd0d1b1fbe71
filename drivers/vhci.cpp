#include "drivers/vhci.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>
#include <vector>

#include "drivers/descriptor.h"
#include "protocols/usbip/operations.h"

namespace rigwire::drivers {

namespace asio = boost::asio;
namespace usbip = protocols::usbip;

namespace {

constexpr const char* kController = "/sys/devices/platform/vhci_hcd.0";

std::string attribute(const char* name) {
  return std::string(kController) + "/" + name;
}

std::string read_all(const std::string& path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// Attributes take their value in one write; the answer is errno.
int write_attribute(const char* name, const std::string& value) {
  const Descriptor file(::open(attribute(name).c_str(), O_WRONLY | O_CLOEXEC));
  if (!file.open()) {
    return errno;
  }
  return ::write(file.get(), value.data(), value.size()) < 0 ? errno : 0;
}

}  // namespace

std::string vhci_obstacle() {
  if (::access(kController, F_OK) != 0) {
    return "no virtual USB host controller; sudo modprobe vhci-hcd";
  }
  if (::access(attribute("attach").c_str(), W_OK) != 0) {
    return "only root may attach USB devices; run `sudo usbip attach` yourself";
  }
  return {};
}

std::optional<unsigned> free_vhci_port(std::string_view status) {
  constexpr unsigned kFree = 4;  // enum usbip_device_status, VDEV_ST_NULL
  std::istringstream lines{std::string(status)};
  std::string line;
  while (std::getline(lines, line)) {
    std::istringstream words(line);
    std::string hub;
    unsigned port = 0;
    unsigned state = 0;
    if (words >> hub >> port >> state && hub == "hs" && state == kFree) {
      return port;
    }
  }
  return std::nullopt;
}

struct VhciAttachment::State : std::enable_shared_from_this<State> {
  State(asio::io_context& io, std::string wanted, Done when_done)
      : socket(io), bus_id(std::move(wanted)), done(std::move(when_done)) {}

  void connect(const std::string& address, std::uint16_t tcp_port) {
    boost::system::error_code bad;
    const auto numeric = asio::ip::make_address(address, bad);
    if (bad) {
      asio::post(socket.get_executor(), [self = shared_from_this(), address] {
        self->end("'" + address + "' is no numeric address");
      });
      return;
    }
    socket.async_connect({numeric, tcp_port}, [self = shared_from_this()](const auto& error) {
      self->next(error, [&] { self->ask(); });
    });
  }

  void ask() {
    usbip::ImportRequest import;
    std::copy_n(bus_id.begin(), std::min(bus_id.size(), import.bus_id.size() - 1),
                import.bus_id.begin());
    buffer = usbip::encode_request(import);
    asio::async_write(socket, asio::buffer(buffer),
                      [self = shared_from_this()](const auto& error, std::size_t) {
                        self->next(error, [&] { self->hear(usbip::kOperationHeaderSize); });
                      });
  }

  /// Reads the reply. It is short when the server refuses, which its first bytes show.
  void hear(std::size_t size) {
    const std::size_t had = size == usbip::kOperationHeaderSize ? 0 : buffer.size();
    buffer.resize(size);
    asio::async_read(socket, asio::buffer(buffer) + had,
                     [self = shared_from_this()](const auto& error, std::size_t) {
                       self->next(error, [&] { self->understand(); });
                     });
  }

  void understand() {
    const auto reply = usbip::decode_import_reply(buffer);
    if (reply.incomplete()) {
      hear(reply.shortage().needed);
    } else if (!reply.ok() || reply->status != usbip::OperationStatus::ok) {
      end("the server does not give it away: it is not there, or attached already");
    } else {
      hand_over(reply->device);
    }
  }

  void hand_over(const usbip::DeviceRecord& device) {
    const auto free = free_vhci_port(read_all(attribute("status")));
    if (!free) {
      end("the kernel's virtual host controller has no free port");
      return;
    }
    socket.non_blocking(false);
    const int refused = write_attribute(
        "attach", std::to_string(*free) + " " + std::to_string(socket.native_handle()) + " " +
                      std::to_string((device.bus << 16U) | device.device) + " " +
                      std::to_string(static_cast<unsigned>(device.speed)));
    if (refused != 0) {
      end(std::string("the kernel refuses it: ") + std::strerror(refused));
      return;
    }
    port = *free;
    socket.close();  // the kernel has its own hold on the connection
    end({});
  }

  void next(const boost::system::error_code& error, auto&& go_on) {
    if (stopped) {
      return;
    }
    if (error) {
      end(error.message());
    } else {
      go_on();
    }
  }

  void end(const std::string& error) {
    if (!stopped && done) {
      const Done told = std::move(done);
      done = nullptr;
      told(error.empty() ? error : "USB device " + bus_id + " cannot be attached: " + error);
    }
  }

  asio::ip::tcp::socket socket;
  std::string bus_id;
  Done done;
  std::vector<std::uint8_t> buffer;
  std::optional<unsigned> port;
  bool stopped = false;
};

VhciAttachment::VhciAttachment(asio::io_context& io, const std::string& address, std::uint16_t port,
                               std::string bus_id, Done done)
    : state_(std::make_shared<State>(io, std::move(bus_id), std::move(done))) {
  state_->connect(address, port);
}

VhciAttachment::~VhciAttachment() {
  state_->stopped = true;
  boost::system::error_code ignored;
  state_->socket.close(ignored);
  if (state_->port) {
    static_cast<void>(write_attribute("detach", std::to_string(*state_->port)));
  }
}

}  // namespace rigwire::drivers
