#include "emulators/usb/usb_standard_requests.h"

#include <algorithm>

namespace rigwire::emulators {

using namespace protocols::usb;

namespace {

constexpr UsbStandardRequests::Answer kStall{};
constexpr UsbStandardRequests::Answer kDone{Outcome::done, {}};

constexpr std::uint8_t kAddressMaximum = 127;

}  // namespace

UsbStandardRequests::UsbStandardRequests(UsbDevice& device)
    : device_(device), descriptors_(device.description()) {
  const auto& interfaces = device.description().interfaces;
  alternates_.resize(static_cast<std::size_t>(
      std::ranges::count(interfaces, 0, &InterfaceDescription::alternate)));
}

void UsbStandardRequests::reset() {
  configuration_ = 0;
  std::ranges::fill(alternates_, std::uint8_t{0});
  halted_.reset();
}

std::optional<UsbStandardRequests::Answer> UsbStandardRequests::answer(SimTime now,
                                                                       const Setup& setup) {
  if (kind_of(setup) != RequestKind::standard) {
    return std::nullopt;
  }
  const auto request = static_cast<StandardRequest>(setup.request);
  if (request == StandardRequest::get_descriptor && setup.to_host() &&
      is_for(setup, Recipient::interface)) {
    return has_interface(setup.index) ? std::nullopt : std::optional(kStall);
  }
  const bool for_device = is_for(setup, Recipient::device);
  const bool empty_order = !setup.to_host() && setup.length == 0;
  switch (request) {
    case StandardRequest::get_descriptor:
      return setup.to_host() && for_device ? descriptor(setup) : kStall;
    case StandardRequest::get_status:
      return setup.to_host() && setup.value == 0 ? status(setup) : kStall;
    case StandardRequest::clear_feature:
      return empty_order ? feature(setup, false) : kStall;
    case StandardRequest::set_feature:
      return empty_order ? feature(setup, true) : kStall;
    case StandardRequest::set_address:
      return empty_order && for_device && setup.value <= kAddressMaximum ? kDone : kStall;
    case StandardRequest::get_configuration:
      if (!setup.to_host() || !for_device || setup.value != 0 || setup.index != 0) {
        return kStall;
      }
      reply_[0] = configuration_;
      return cut(setup, std::span(reply_).first(1));
    case StandardRequest::set_configuration:
      return empty_order && for_device ? set_configuration(now, setup) : kStall;
    case StandardRequest::get_interface:
      return setup.to_host() && setup.value == 0 ? get_interface(setup) : kStall;
    case StandardRequest::set_interface:
      return empty_order ? set_interface(now, setup) : kStall;
    case StandardRequest::set_descriptor:
    case StandardRequest::synch_frame:
      break;
  }
  return kStall;
}

const EndpointDescription* UsbStandardRequests::endpoint(std::uint8_t address) const {
  if (configuration_ == 0) {
    return nullptr;
  }
  for (const InterfaceDescription& interface : device_.description().interfaces) {
    if (interface.alternate == alternates_[interface.number]) {
      const auto found =
          std::ranges::find(interface.endpoints, address, &EndpointDescription::address);
      if (found != interface.endpoints.end()) {
        return &*found;
      }
    }
  }
  return nullptr;
}

bool UsbStandardRequests::has_interface(std::uint16_t index) const {
  return index < alternates_.size();
}

bool UsbStandardRequests::has_endpoint(std::uint16_t index) const {
  return index <= 0xFF && endpoint(static_cast<std::uint8_t>(index)) != nullptr;
}

UsbStandardRequests::Answer UsbStandardRequests::cut(const Setup& setup,
                                                     std::span<const std::uint8_t> bytes) const {
  return {Outcome::done, bytes.first(std::min<std::size_t>(bytes.size(), setup.length))};
}

UsbStandardRequests::Answer UsbStandardRequests::descriptor(const Setup& setup) const {
  const auto type = static_cast<std::uint8_t>(setup.value >> 8U);
  const auto index = static_cast<std::uint8_t>(setup.value);
  std::span<const std::uint8_t> bytes;
  if (type == descriptor_type::kDevice && index == 0) {
    bytes = descriptors_.device();
  } else if (type == descriptor_type::kConfiguration && index == 0) {
    bytes = descriptors_.configuration();
  } else if (type == descriptor_type::kString) {
    bytes = descriptors_.text(index);
  }
  return bytes.empty() ? kStall : cut(setup, bytes);
}

UsbStandardRequests::Answer UsbStandardRequests::status(const Setup& setup) {
  reply_ = {};
  if (is_for(setup, Recipient::device) && setup.index == 0) {
    reply_[0] = device_.description().self_powered ? 1 : 0;
  } else if (is_for(setup, Recipient::endpoint) &&
             ((setup.index & 0xFF7FU) == 0 || has_endpoint(setup.index))) {
    reply_[0] = halted(static_cast<std::uint8_t>(setup.index)) ? 1 : 0;
  } else if (!is_for(setup, Recipient::interface) || configuration_ == 0 ||
             !has_interface(setup.index)) {
    return kStall;
  }
  return cut(setup, reply_);
}

UsbStandardRequests::Answer UsbStandardRequests::feature(const Setup& setup, bool on) {
  const bool endpoint_zero = (setup.index & 0xFF7FU) == 0;  // halt means nothing there: 9.4.5
  if (!is_for(setup, Recipient::endpoint) ||
      setup.value != static_cast<std::uint16_t>(protocols::usb::Feature::endpoint_halt) ||
      (!endpoint_zero && !has_endpoint(setup.index))) {
    return kStall;
  }
  if (!endpoint_zero) {
    halted_.set(index_of(static_cast<std::uint8_t>(setup.index)), on);
  }
  return kDone;
}

UsbStandardRequests::Answer UsbStandardRequests::set_configuration(SimTime now,
                                                                   const Setup& setup) {
  if (setup.index != 0 ||
      (setup.value != 0 && setup.value != device_.description().configuration_value)) {
    return kStall;
  }
  reset();
  configuration_ = static_cast<std::uint8_t>(setup.value);
  device_.configured(now, configuration_);
  return kDone;
}

UsbStandardRequests::Answer UsbStandardRequests::get_interface(const Setup& setup) {
  if (!is_for(setup, Recipient::interface) || configuration_ == 0 || !has_interface(setup.index)) {
    return kStall;
  }
  reply_[0] = alternates_[setup.index];
  return cut(setup, std::span(reply_).first(1));
}

UsbStandardRequests::Answer UsbStandardRequests::set_interface(SimTime now, const Setup& setup) {
  if (!is_for(setup, Recipient::interface) || configuration_ == 0 || !has_interface(setup.index)) {
    return kStall;
  }
  const auto& interfaces = device_.description().interfaces;
  const auto wanted = std::ranges::find_if(interfaces, [&](const InterfaceDescription& interface) {
    return interface.number == setup.index && interface.alternate == setup.value;
  });
  if (wanted == interfaces.end()) {
    return kStall;
  }
  for (const EndpointDescription& endpoint : wanted->endpoints) {
    halted_.reset(index_of(endpoint.address));
  }
  alternates_[setup.index] = wanted->alternate;
  device_.selected(now, wanted->number, wanted->alternate);
  return kDone;
}

}  // namespace rigwire::emulators
