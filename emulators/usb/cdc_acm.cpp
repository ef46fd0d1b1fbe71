#include "emulators/usb/cdc_acm.h"

#include <algorithm>
#include <stdexcept>

#include "emulators/usb/usb_port.h"

namespace rigwire::emulators {

using namespace protocols::usb;

namespace {

constexpr std::uint16_t kEvents = cdc::serial_state::kFramingError |
                                  cdc::serial_state::kParityError | cdc::serial_state::kOverrun;

std::vector<std::uint8_t> functional_descriptors(const CdcAcmSettings& settings) {
  constexpr std::uint8_t kHeader = 0;
  constexpr std::uint8_t kCallManagement = 1;
  constexpr std::uint8_t kAbstractControl = 2;
  constexpr std::uint8_t kUnion = 6;
  std::vector<std::uint8_t> bytes{
      5,    cdc::kClassInterface, kHeader,          0x10,
      0x01,                                                                 // version 1.10
      4,    cdc::kClassInterface, kAbstractControl, settings.capabilities,  //
      5,    cdc::kClassInterface, kCallManagement,  0x03,
      1};  // data interface 1
  if (settings.union_descriptor) {
    bytes.insert(bytes.end(), {5, cdc::kClassInterface, kUnion, 0, 1});
  }
  return bytes;
}

DeviceDescription describe(const CdcAcmSettings& settings) {
  DeviceDescription d;
  d.usb_version = settings.usb_version;
  d.device_class = cdc::kCommunicationsClass;
  d.vendor = settings.vendor;
  d.product = settings.product;
  d.release = settings.release;
  d.manufacturer = settings.manufacturer;
  d.product_name = settings.product_name;
  d.serial_number = settings.serial_number;
  d.self_powered = settings.self_powered;
  d.maximum_power_2ma = settings.maximum_power_2ma;
  InterfaceDescription control;
  control.device_class = cdc::kCommunicationsClass;
  control.subclass = cdc::kAbstractControlModel;
  control.protocol = cdc::kAtCommands;
  control.extra = functional_descriptors(settings);
  control.endpoints.push_back(
      {CdcAcm::kNotificationEndpoint, TransferType::interrupt, CdcAcm::kPacketBytes, 255});
  InterfaceDescription data;
  data.number = 1;
  data.device_class = cdc::kDataClass;
  data.protocol = settings.data_protocol;
  data.endpoints.push_back({CdcAcm::kOutEndpoint, TransferType::bulk, CdcAcm::kPacketBytes, 0});
  data.endpoints.push_back({CdcAcm::kInEndpoint, TransferType::bulk, CdcAcm::kPacketBytes, 0});
  d.interfaces = {control, data};
  return d;
}

}  // namespace

CdcAcm::CdcAcm(const CdcAcmSettings& settings, CdcAcmDevice& device)
    : settings_(settings), device_(device), description_(describe(settings)) {
  if (settings.queue_bytes < kPacketBytes || settings.queue_bytes > 65536) {
    throw std::invalid_argument("usb serial queue_bytes: found " +
                                std::to_string(settings.queue_bytes) + ", allowed 64 .. 65536");
  }
  validate(description_);
  queue_.reserve(settings.queue_bytes);
  line_.coding = settings.line_coding;
}

bool CdcAcm::send(SimTime now, std::span<const std::uint8_t> bytes) {
  if (!line_.client_present) {
    return true;
  }
  if (queue_.size() - queue_begin_ + bytes.size() > settings_.queue_bytes) {
    lost_bytes_ += bytes.size();
    return false;
  }
  if (queue_.size() + bytes.size() > settings_.queue_bytes) {
    queue_.erase(queue_.begin(), queue_.begin() + static_cast<std::ptrdiff_t>(queue_begin_));
    queue_begin_ = 0;
  }
  queue_.insert(queue_.end(), bytes.begin(), bytes.end());
  pump(now);
  return true;
}

void CdcAcm::set_serial_state(SimTime now, std::uint16_t state) {
  if (state == serial_state_ && (state & kEvents) == 0) {
    return;
  }
  serial_state_ = state;
  notify_ = true;
  pump_notifications(now);
}

void CdcAcm::plugged(SimTime now, UsbHost& host) {
  host_ = &host;
  power_on(now);
}

void CdcAcm::unplugged(SimTime now) {
  host_ = nullptr;
  power_on(now);
}

void CdcAcm::configured(SimTime now, std::uint8_t /*configuration*/) {
  power_on(now);
}

void CdcAcm::power_on(SimTime now) {
  reads_.clear();
  notification_reads_.clear();
  reading_ = false;
  reading_ends_ = kNever;
  serial_state_ = 0;
  notify_ = false;
  break_ends_ = kNever;
  CdcAcmLine line;
  line.coding = settings_.line_coding;
  update_line(now, line);
}

void CdcAcm::control(SimTime now, UsbTransfer transfer, const Setup& setup,
                     std::span<const std::uint8_t> data) {
  if (!serve(now, transfer, setup, data)) {
    host_->complete(now, transfer, Outcome::stalled, {}, 0);
  }
}

bool CdcAcm::serve(SimTime now, UsbTransfer transfer, const Setup& setup,
                   std::span<const std::uint8_t> data) {
  if (kind_of(setup) != RequestKind::by_class || !is_for(setup, Recipient::interface) ||
      setup.index != 0) {
    return false;
  }
  const bool has_line = (settings_.capabilities & cdc::kHasLineCoding) != 0;
  const bool has_break = (settings_.capabilities & cdc::kHasBreak) != 0;
  CdcAcmLine line = line_;
  switch (static_cast<cdc::Request>(setup.request)) {
    case cdc::Request::get_line_coding:
      if (!has_line || !setup.to_host()) {
        return false;
      }
      complete_to(*host_, now, transfer, setup, cdc::encode(line_.coding));
      return true;
    case cdc::Request::set_line_coding:
      if (!has_line || setup.to_host() || data.size() != cdc::kLineCodingSize) {
        return false;
      }
      line.coding = cdc::decode_line_coding(data.first<cdc::kLineCodingSize>());
      break;
    case cdc::Request::set_control_line_state:
      if (!has_line || setup.to_host() || !data.empty()) {
        return false;
      }
      line.data_terminal_ready = (setup.value & cdc::kDataTerminalReady) != 0;
      line.request_to_send = (setup.value & cdc::kRequestToSend) != 0;
      break;
    case cdc::Request::send_break:
      if (!has_break || setup.to_host() || !data.empty()) {
        return false;
      }
      line.sending_break = setup.value != 0;
      break_ends_ = setup.value == 0 || setup.value == cdc::kBreakUntilCleared
                        ? kNever
                        : now + std::chrono::milliseconds(setup.value);
      break;
    default:
      return false;
  }
  host_->complete(now, transfer, Outcome::done, {}, data.size());
  update_line(now, line);
  return true;
}

void CdcAcm::read(SimTime now, UsbTransfer transfer, std::uint8_t endpoint, std::size_t length) {
  if (endpoint == kNotificationEndpoint) {
    notification_reads_.push_back({transfer, length});
    pump_notifications(now);
    return;
  }
  reads_.push_back({transfer, length});
  reading_ = true;
  reading_ends_ = kNever;
  update_line(now, line_);
  pump(now);
}

void CdcAcm::write(SimTime now, UsbTransfer transfer, std::uint8_t /*endpoint*/,
                   std::span<const std::uint8_t> data) {
  host_->complete(now, transfer, Outcome::done, {}, data.size());
  if (!data.empty()) {
    device_.received(now, data);
  }
}

bool CdcAcm::cancel(SimTime now, UsbTransfer transfer) {
  const auto is_it = [transfer](const Read& read) { return read.transfer == transfer; };
  if (std::erase_if(notification_reads_, is_it) > 0) {
    return true;
  }
  if (std::erase_if(reads_, is_it) == 0) {
    return false;
  }
  if (reads_.empty()) {
    reading_ = false;
    update_line(now, line_);
  }
  return true;
}

void CdcAcm::advance(SimTime now) {
  if (now >= break_ends_) {
    break_ends_ = kNever;
    CdcAcmLine line = line_;
    line.sending_break = false;
    update_line(now, line);
  }
  if (now >= reading_ends_) {
    update_line(now, line_);
  }
}

SimTime CdcAcm::next_event() const {
  return std::min(break_ends_, line_.data_terminal_ready ? kNever : reading_ends_);
}

void CdcAcm::pump(SimTime now) {
  while (!reads_.empty() && queue_begin_ < queue_.size()) {
    const Read read = reads_.front();
    reads_.erase(reads_.begin());
    const auto data = std::span(queue_).subspan(
        queue_begin_, std::min(read.length, queue_.size() - queue_begin_));
    queue_begin_ += data.size();
    host_->complete(now, read.transfer, Outcome::done, data, 0);
  }
  if (reading_ && reads_.empty() && reading_ends_ == kNever) {
    reading_ends_ = now + kReadPause;
  }
  if (queue_begin_ == queue_.size()) {
    queue_.clear();
    queue_begin_ = 0;
  }
}

void CdcAcm::pump_notifications(SimTime now) {
  if (!notify_ || notification_reads_.empty()) {
    return;
  }
  const Read read = notification_reads_.front();
  notification_reads_.erase(notification_reads_.begin());
  const auto bytes = cdc::encode_serial_state(0, serial_state_);
  serial_state_ = static_cast<std::uint16_t>(serial_state_ & ~kEvents);
  notify_ = false;
  host_->complete(now, read.transfer, Outcome::done,
                  std::span(bytes).first(std::min(bytes.size(), read.length)), 0);
}

void CdcAcm::update_line(SimTime now, CdcAcmLine line) {
  if (now >= reading_ends_) {
    reading_ = false;
    reading_ends_ = kNever;
  }
  line.client_present = host_ != nullptr && (line.data_terminal_ready || reading_);
  if (!line.client_present) {
    queue_.clear();
    queue_begin_ = 0;
  }
  if (line != line_) {
    line_ = line;
    device_.line_changed(now, line_);
  }
}

CdcAcmSettings ublox_usb(int generation) {
  CdcAcmSettings settings;
  settings.vendor = 0x1546;
  settings.manufacturer = "u-blox AG - www.u-blox.com";
  settings.product_name = "u-blox GNSS receiver";
  settings.union_descriptor = false;
  settings.data_protocol = 0xFF;
  switch (generation) {
    case 7:
      settings.product = 0x01A7;
      settings.product_name = "u-blox 7 - GPS/GNSS Receiver";
      break;
    case 8:
      settings.product = 0x01A8;
      settings.release = 0x0301;
      break;
    case 9:
      settings.product = 0x01A9;
      break;
    default:
      throw std::invalid_argument("u-blox generation: found " + std::to_string(generation) +
                                  ", allowed 7, 8, 9");
  }
  return settings;
}

}  // namespace rigwire::emulators
