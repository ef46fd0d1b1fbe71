#include "emulators/usb/usbip_export.h"

#include <algorithm>
#include <cassert>

namespace rigwire::emulators {

using namespace protocols::usbip;
using protocols::usb::Outcome;

namespace {

std::int32_t status_of(Outcome outcome) {
  switch (outcome) {
    case Outcome::done:
      return status::kDone;
    case Outcome::stalled:
      return status::kStalled;
    case Outcome::overflow:
      return status::kOverflow;
    case Outcome::cancelled:
      return status::kUnlinked;
    case Outcome::gone:
      break;
  }
  return status::kGone;
}

}  // namespace

UsbipServer::Export::Export(UsbDevice& device, ListedDevice listed, std::size_t transfers_max,
                            StreamOutput& output, std::vector<std::uint8_t>& scratch)
    : port_(device),
      listed_(std::move(listed)),
      transfers_max_(transfers_max),
      output_(output),
      scratch_(scratch) {
  open_.reserve(transfers_max);
}

void UsbipServer::Export::attach(SimTime now, ConnectionId importer) {
  importer_ = importer;
  port_.attach(now, *this);
}

void UsbipServer::Export::detach(SimTime now) {
  open_.clear();
  port_.detach(now);
  importer_ = 0;
}

void UsbipServer::Export::remove(SimTime now) {
  port_.detach(now);
  for (const Open& open : open_) {
    reply(now, open, status::kGone, {}, 0);
  }
  open_.clear();
  output_.close(importer_, now);
  importer_ = 0;
}

UsbipServer::Export::Verdict UsbipServer::Export::submit(SimTime now, const Submit& submit,
                                                         std::span<const std::uint8_t> data) {
  const DeviceRecord& record = listed_.device;
  if (submit.device != ((record.bus << 16U) | record.device) ||
      find(submit.number) != open_.end()) {
    return Verdict::broken;
  }
  const Open open{submit.number, submit.length, submit.to_host, (submit.flags & kShortNotOk) != 0};
  if (submit.packets != 0) {
    reply(now, open, status::kNotSupported, {}, 0);
    return Verdict::refused;
  }
  if (open_.size() >= transfers_max_) {
    reply(now, open, status::kNoMemory, {}, 0);
    return Verdict::refused;
  }
  open_.push_back(open);
  if (submit.endpoint == 0) {
    start_control(now, submit, data);
  } else if (submit.to_host) {
    port_.read(now, submit.number,
               static_cast<std::uint8_t>(submit.endpoint | protocols::usb::kToHost),
               std::min<std::size_t>(submit.length, kDataMaximum));
  } else {
    port_.write(now, submit.number, submit.endpoint, data);
  }
  return Verdict::served;
}

void UsbipServer::Export::start_control(SimTime now, const Submit& submit,
                                        std::span<const std::uint8_t> data) {
  auto setup = protocols::usb::decode_setup(submit.setup);
  // Without a data stage the direction has no meaning, and hosts differ in what they send.
  const bool agree = setup.length == 0 || setup.to_host() == submit.to_host;
  if (!agree || (!setup.to_host() && setup.length != data.size())) {
    complete(now, submit.number, Outcome::stalled, {}, 0);
    return;
  }
  setup.length = static_cast<std::uint16_t>(std::min<std::uint32_t>(setup.length, submit.length));
  port_.control(now, submit.number, setup, data);
}

UsbipServer::Export::Verdict UsbipServer::Export::unlink(SimTime now, const Unlink& unlink) {
  std::int32_t status = status::kDone;
  if (const auto open = find(unlink.transfer); open != open_.end()) {
    [[maybe_unused]] const bool was_open = port_.cancel(now, unlink.transfer);
    assert(was_open);
    open_.erase(open);
    status = status::kUnlinked;
  }
  output_.send(importer_, now, encode(UnlinkReply{unlink.number, status}));
  return Verdict::served;
}

void UsbipServer::Export::complete(SimTime now, UsbTransfer transfer, Outcome outcome,
                                   std::span<const std::uint8_t> data, std::size_t taken) {
  const auto found = find(transfer);
  assert(found != open_.end());
  if (found == open_.end()) {
    return;
  }
  const Open open = *found;
  open_.erase(found);
  reply(now, open, status_of(outcome), data, taken);
}

void UsbipServer::Export::reply(SimTime now, const Open& open, std::int32_t status,
                                std::span<const std::uint8_t> data, std::size_t taken) {
  assert(data.empty() || open.to_host);
  assert(data.size() <= open.length && taken <= open.length);
  data = open.to_host ? data.first(std::min<std::size_t>(data.size(), open.length))
                      : std::span<const std::uint8_t>{};
  SubmitReply answer{open.number, status, 0};
  answer.actual_length = static_cast<std::uint32_t>(
      open.to_host ? data.size() : std::min<std::size_t>(taken, open.length));
  if (open.to_host && open.short_not_ok && status == status::kDone && data.size() < open.length) {
    answer.status = status::kShort;
  }
  const CommandBytes header = encode(answer);
  scratch_.assign(header.begin(), header.end());
  scratch_.insert(scratch_.end(), data.begin(), data.end());
  output_.send(importer_, now, scratch_);
}

std::vector<UsbipServer::Export::Open>::iterator UsbipServer::Export::find(UsbTransfer number) {
  return std::ranges::find(open_, number, &Open::number);
}

}  // namespace rigwire::emulators
