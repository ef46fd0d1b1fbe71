// Exports USB devices by USB/IP: what a client's kernel attaches as if it were plugged in there.
//
// - Each port has one device, with the bus id "1-<port>" (ports count from 1) and bus and device
//   number 1 and <port>. A device that is not plugged in is neither listed nor given away.
// - One client has a device at a time. A second one that asks for it is refused with status 1, as
//   is one that asks for a bus id that is not there.
// - An import is a power-on of the device; the end of the connection, by either side, is the
//   removal of its host. USB/IP does not report bus resets and suspension to the device, and has no
//   frame clock: the device paces its data itself.
// - Submits are answered when the device ends the transfer; up to `transfers_max` may be open, more
//   are answered with ENOMEM. Isochronous transfers are answered with ENOSYS.
// - An unlink that finds its transfer open is answered with ECONNRESET, and the transfer not at
//   all; otherwise it is answered with 0.
// - unplug() answers open transfers with ENODEV and ends the connection, which is how the client's
//   port becomes empty. plug() makes the device available again.
// - Nothing behind a malformed message can be trusted: it ends the connection. So does a number
//   that is still open, a device number other than the imported one's, and a client that does not
//   read (by the endpoint, drivers/tcp_server.h).
// Memory is bounded: of each connection one message (1 MiB of data and 16 KiB of packet records),
// of each port its open transfers.
//
// Source: see protocols/usbip/constants.h; Linux 6.1, drivers/usb/usbip/stub_rx.c and vhci_rx.c for
// what the other side expects.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "emulators/device.h"
#include "emulators/usb/usb_port.h"
#include "protocols/usbip/commands.h"
#include "protocols/usbip/operations.h"

namespace rigwire::emulators {

struct UsbipServerSettings {
  std::size_t transfers_max = 1024;  ///< Open at once on one device, 1 .. 65536.
};
/// Throws std::invalid_argument.
void validate(const UsbipServerSettings& settings);

class UsbipServer final : public StreamDevice {
 public:
  /// Number of a port, from 1 up.
  using PortNumber = std::uint16_t;

  /// `output` must outlive the server. It must not call disconnected() from within send() or
  /// close(). Throws std::invalid_argument.
  UsbipServer(const UsbipServerSettings& settings, StreamOutput& output);
  ~UsbipServer() override;

  /// A new port with `device`, which must outlive the server, plugged in. `name` is what the list
  /// shows as path, behind "/rigwire/". Throws std::invalid_argument when the device's description
  /// is not valid or the name does not fit.
  PortNumber add(UsbDevice& device, std::string_view name);

  void plug(SimTime now, PortNumber port);
  void unplug(SimTime now, PortNumber port);
  [[nodiscard]] bool plugged(PortNumber port) const;
  /// A client has it.
  [[nodiscard]] bool imported(PortNumber port) const;
  [[nodiscard]] const std::string& bus_id(PortNumber port) const;
  [[nodiscard]] std::size_t open_transfers(PortNumber port) const;

  void connected(SimTime now, ConnectionId connection) override;
  void receive(SimTime now, ConnectionId connection, std::span<const std::uint8_t> bytes) override;
  void disconnected(SimTime now, ConnectionId connection) override;

  /// Lets all devices live, in order of their events.
  void advance(SimTime now) override;
  [[nodiscard]] SimTime next_event() const override;
  [[nodiscard]] SamplePlan sample_plan() const override { return {}; }
  /// accepted: requests, submits and unlinks served. ignored: imports refused, transfers refused
  /// for their number or kind, bytes on a connection that is being closed. malformed: what ended a
  /// connection.
  [[nodiscard]] ReceiveCounters received() const override { return counters_; }
  [[nodiscard]] double nominal_rate_hz() const override { return 0.0; }
  [[nodiscard]] std::span<const Quantity> quantities() const override { return {}; }

 private:
  class Export;
  struct Connection {
    ConnectionId id = 0;
    Export* device = nullptr;  ///< Imported.
    bool closing = false;
    std::vector<std::uint8_t> buffer;  ///< The beginning of a message.
  };

  [[nodiscard]] Connection* find(ConnectionId connection);
  [[nodiscard]] Export& at(PortNumber port) const;
  [[nodiscard]] std::size_t consume(SimTime now, Connection& connection,
                                    std::span<const std::uint8_t> bytes);
  [[nodiscard]] std::size_t consume_request(SimTime now, Connection& connection,
                                            std::span<const std::uint8_t> bytes);
  [[nodiscard]] std::size_t consume_command(SimTime now, Connection& connection,
                                            std::span<const std::uint8_t> bytes);
  void import(SimTime now, Connection& connection, std::string_view bus_id);
  void send_list(SimTime now, const Connection& connection);
  void reject(SimTime now, Connection& connection);

  UsbipServerSettings settings_;
  StreamOutput& output_;
  std::vector<std::unique_ptr<Export>> exports_;
  std::vector<Connection> connections_;
  std::vector<std::uint8_t> scratch_;  ///< One answer.
  ReceiveCounters counters_;
};

}  // namespace rigwire::emulators
