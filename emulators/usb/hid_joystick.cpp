#include "emulators/usb/hid_joystick.h"

#include <algorithm>
#include <cmath>

#include "emulators/usb/usb_port.h"
#include "fields/check.h"
#include "fields/visitor.h"
#include "protocols/bytes.h"
#include "protocols/usb/descriptors.h"
#include "protocols/usb/hid.h"

namespace rigwire::emulators {

using namespace protocols::usb;
using protocols::store_little;

namespace {

constexpr auto kIdleUnit = std::chrono::milliseconds(4);
constexpr std::size_t kDial = static_cast<std::size_t>(JoystickAxis::dial);

std::vector<std::uint8_t> describe_report() {
  using enum hid::Item;
  return hid::encode_items({{usage_page, hid::page::kGenericDesktop},
                            {usage, hid::usage::kJoystick},
                            {collection, hid::kApplication},
                            {logical_minimum, -32767},
                            {logical_maximum, 32767},
                            {report_size, 16},
                            {report_count, 6},
                            {usage, hid::usage::kX},
                            {usage, hid::usage::kY},
                            {usage, hid::usage::kRx},
                            {usage, hid::usage::kRy},
                            {usage, hid::usage::kZ},
                            {usage, hid::usage::kRz},
                            {input, hid::kDataVariable},
                            {logical_minimum, 0},
                            {report_count, 1},
                            {usage, hid::usage::kSlider},
                            {input, hid::kDataVariable},
                            {usage_page, hid::page::kButton},
                            {usage_minimum, 1},
                            {usage_maximum, static_cast<int>(kJoystickButtons)},
                            {logical_maximum, 1},
                            {report_size, 1},
                            {report_count, static_cast<int>(kJoystickButtons)},
                            {input, hid::kDataVariable},
                            {end_collection, 0}});
}

std::vector<std::uint8_t> describe_hid(std::size_t report_descriptor_size) {
  return {static_cast<std::uint8_t>(hid::kHidDescriptorSize),
          hid::kHidDescriptor,
          0x11,  // version 1.11
          0x01,
          0,  // no country
          1,  // descriptors
          hid::kReportDescriptor,
          static_cast<std::uint8_t>(report_descriptor_size),
          static_cast<std::uint8_t>(report_descriptor_size >> 8U)};
}

DeviceDescription describe(const HidJoystickSettings& settings,
                           const std::vector<std::uint8_t>& hid_descriptor) {
  DeviceDescription d;
  d.vendor = settings.vendor;
  d.product = settings.product;
  d.manufacturer = settings.manufacturer;
  d.product_name = settings.product_name;
  d.serial_number = settings.serial_number;
  InterfaceDescription levers;
  levers.device_class = hid::kClass;
  levers.extra = hid_descriptor;
  levers.endpoints.push_back(
      {HidJoystick::kEndpoint, TransferType::interrupt, HidJoystick::kReportSize,
       static_cast<std::uint8_t>(settings.interval / std::chrono::milliseconds(1))});
  d.interfaces.push_back(levers);
  return d;
}

}  // namespace

void visit(fields::Visitor& v, HidJoystickSettings& p) {
  v.duration("interval", p.interval, {1'000'000, 255'000'000},
             "Least time between two reports, in whole milliseconds.");
  v.check(p.interval % std::chrono::milliseconds(1) == Duration{0}, "interval",
          "its descriptor counts milliseconds", fields::print_duration(p.interval.count()),
          "whole milliseconds");
  v.text("serial_number", p.serial_number, "Serial number as a USB string; empty = none.");
}

void validate(const HidJoystickSettings& settings) {
  fields::check(settings);
}

HidJoystick::HidJoystick(const HidJoystickSettings& settings) : settings_(settings) {
  validate(settings);
  report_descriptor_ = describe_report();
  hid_descriptor_ = describe_hid(report_descriptor_.size());
  description_ = describe(settings, hid_descriptor_);
  validate(description_);
}

void HidJoystick::update(const JoystickSample& sample) {
  advance(sample.time);
  const std::span bytes(report_);
  for (std::size_t i = 0; i < kJoystickAxes; ++i) {
    const double axis = std::isnan(sample.axes[i]) ? 0.0 : sample.axes[i];
    const double limited = std::clamp(axis, i == kDial ? 0.0 : -1.0, 1.0);
    store_little(bytes, 2 * i, static_cast<std::int16_t>(std::lround(limited * kFullTravel)));
  }
  store_little(bytes, 2 * kJoystickAxes, static_cast<std::uint16_t>(sample.buttons.to_ulong()));
  news_ = !reported_ || report_ != sent_;
  advance(sample.time);
}

void HidJoystick::plugged(SimTime /*now*/, UsbHost& host) {
  host_ = &host;
  reset();
}

void HidJoystick::unplugged(SimTime /*now*/) {
  host_ = nullptr;
  reset();
}

void HidJoystick::configured(SimTime /*now*/, std::uint8_t /*configuration*/) {
  reset();
}

void HidJoystick::reset() {
  reads_.clear();
  idle_4ms_ = 0;
  reported_ = false;
  news_ = true;
}

void HidJoystick::control(SimTime now, UsbTransfer transfer, const Setup& setup,
                          std::span<const std::uint8_t> /*data*/) {
  if (serve(now, transfer, setup)) {
    ++counters_.accepted;
    last_request_ = {now, setup};
  } else {
    ++counters_.ignored;
    host_->complete(now, transfer, Outcome::stalled, {}, 0);
  }
}

bool HidJoystick::serve(SimTime now, UsbTransfer transfer, const Setup& setup) {
  if (!is_for(setup, Recipient::interface) || setup.index != 0) {
    return false;
  }
  const auto upper = static_cast<std::uint8_t>(setup.value >> 8U);
  const auto lower = static_cast<std::uint8_t>(setup.value);
  if (kind_of(setup) == RequestKind::standard) {  // GET_DESCRIPTOR is all that comes here
    if (lower != 0 || (upper != hid::kHidDescriptor && upper != hid::kReportDescriptor)) {
      return false;
    }
    complete_to(*host_, now, transfer, setup,
                upper == hid::kHidDescriptor ? hid_descriptor_ : report_descriptor_);
    return true;
  }
  if (kind_of(setup) != RequestKind::by_class) {
    return false;
  }
  switch (static_cast<hid::Request>(setup.request)) {
    case hid::Request::get_report:
      if (!setup.to_host() || upper != static_cast<std::uint8_t>(hid::ReportType::input) ||
          lower != 0) {
        return false;
      }
      complete_to(*host_, now, transfer, setup, report_);
      return true;
    case hid::Request::get_idle:
      if (!setup.to_host() || lower != 0) {
        return false;
      }
      complete_to(*host_, now, transfer, setup, std::span(&idle_4ms_, 1));
      return true;
    case hid::Request::set_idle:
      if (setup.to_host() || lower != 0 || setup.length != 0) {
        return false;
      }
      idle_4ms_ = upper;
      host_->complete(now, transfer, Outcome::done, {}, 0);
      return true;
    default:
      return false;
  }
}

void HidJoystick::read(SimTime now, UsbTransfer transfer, std::uint8_t /*endpoint*/,
                       std::size_t length) {
  reads_.push_back({transfer, length});
  advance(now);
}

void HidJoystick::write(SimTime now, UsbTransfer transfer, std::uint8_t /*endpoint*/,
                        std::span<const std::uint8_t> /*data*/) {
  host_->complete(now, transfer, Outcome::stalled, {}, 0);  // there is no OUT endpoint
}

bool HidJoystick::cancel(SimTime /*now*/, UsbTransfer transfer) {
  return std::erase_if(reads_, [&](const Read& read) { return read.transfer == transfer; }) > 0;
}

void HidJoystick::advance(SimTime now) {
  lived_ = std::max(lived_, now);
  for (SimTime due = next_event(); due <= lived_; due = next_event()) {
    const Read read = reads_.front();
    reads_.erase(reads_.begin());
    sent_ = report_;
    reported_ = true;
    news_ = false;
    last_report_ = std::max(due, last_report_);
    ++reports_sent_;
    host_->complete(lived_, read.transfer, Outcome::done,
                    std::span(sent_).first(std::min(sent_.size(), read.length)), 0);
  }
}

SimTime HidJoystick::next_event() const {
  if (reads_.empty()) {
    return kNever;
  }
  if (!reported_) {
    return lived_;
  }
  if (news_) {
    return std::max(lived_, last_report_ + settings_.interval);
  }
  return idle_4ms_ == 0 ? kNever
                        : std::max(lived_, last_report_ + std::max<Duration>(idle_4ms_ * kIdleUnit,
                                                                             settings_.interval));
}

std::span<const Quantity> HidJoystick::quantities() const {
  constexpr double kCount = 1.0 / kFullTravel;
  static constexpr std::array<Quantity, kJoystickAxes> kQuantities{
      {{"left stick, right", "of full travel", -1.0, 1.0, kCount},
       {"left stick, back", "of full travel", -1.0, 1.0, kCount},
       {"right stick, right", "of full travel", -1.0, 1.0, kCount},
       {"right stick, back", "of full travel", -1.0, 1.0, kCount},
       {"left pedal, forward", "of full travel", -1.0, 1.0, kCount},
       {"right pedal, forward", "of full travel", -1.0, 1.0, kCount},
       {"dial", "of full travel", 0.0, 1.0, kCount}}};
  return kQuantities;
}

}  // namespace rigwire::emulators
