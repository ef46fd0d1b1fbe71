// One exported device of a UsbipServer: its port, its importer, its open transfers.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "emulators/usb/usbip_server.h"

namespace rigwire::emulators {

class UsbipServer::Export final : public UsbHost {
 public:
  /// `scratch` is memory for one answer, shared by all exports of a server.
  Export(UsbDevice& device, protocols::usbip::ListedDevice listed, std::size_t transfers_max,
         StreamOutput& output, std::vector<std::uint8_t>& scratch);

  [[nodiscard]] const protocols::usbip::ListedDevice& listed() const { return listed_; }
  [[nodiscard]] UsbDevice& device() const { return port_.device(); }
  [[nodiscard]] bool plugged() const { return plugged_; }
  void set_plugged(bool plugged) { plugged_ = plugged; }
  [[nodiscard]] bool imported() const { return port_.attached(); }
  [[nodiscard]] ConnectionId importer() const { return importer_; }
  [[nodiscard]] std::size_t open_transfers() const { return open_.size(); }

  void attach(SimTime now, ConnectionId importer);
  /// Forgets the open transfers.
  void detach(SimTime now);
  /// Answers the open transfers first.
  void remove(SimTime now);

  enum class Verdict { served, refused, broken };
  [[nodiscard]] Verdict submit(SimTime now, const protocols::usbip::Submit& submit,
                               std::span<const std::uint8_t> data);
  [[nodiscard]] Verdict unlink(SimTime now, const protocols::usbip::Unlink& unlink);

  void complete(SimTime now, UsbTransfer transfer, protocols::usb::Outcome outcome,
                std::span<const std::uint8_t> data, std::size_t taken) override;

 private:
  struct Open {
    UsbTransfer number = 0;
    std::uint32_t length = 0;  ///< Asked for or sent along.
    bool to_host = false;
    bool short_not_ok = false;
  };

  [[nodiscard]] std::vector<Open>::iterator find(UsbTransfer number);
  void start_control(SimTime now, const protocols::usbip::Submit& submit,
                     std::span<const std::uint8_t> data);
  void reply(SimTime now, const Open& open, std::int32_t status, std::span<const std::uint8_t> data,
             std::size_t taken);

  UsbPort port_;
  protocols::usbip::ListedDevice listed_;
  std::size_t transfers_max_;
  StreamOutput& output_;
  std::vector<std::uint8_t>& scratch_;
  std::vector<Open> open_;  ///< In the order of their submits.
  ConnectionId importer_ = 0;
  bool plugged_ = true;
};

}  // namespace rigwire::emulators
