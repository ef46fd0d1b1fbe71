#include "drivers/slcan_adapter.h"

#include <stdexcept>
#include <string>
#include <string_view>

#include "protocols/slcan/bit_rate.h"
#include "protocols/slcan/slcan.h"

namespace rigwire::drivers {

namespace slcan = protocols::slcan;
using protocols::can::BusError;
using protocols::can::ControllerReport;
using protocols::can::ErrorState;
using slcan::Reply;
using slcan::ReplyKind;

namespace {

constexpr std::string_view kVersion = "V1013\r";  // hardware 1.0, software 1.3
constexpr std::string_view kDetailedVersion = "v1014\r";
constexpr std::string_view kSerialNumber = "NRW01\r";
/// Answers beyond this are dropped: a client that floods commands and reads nothing.
constexpr std::size_t kGreatestBacklog = 4096;
/// How long the absence of the kernel's driver is believed.
constexpr auto kKernelPeriod = std::chrono::milliseconds(50);

enum Flag : std::uint16_t {
  kReceiveQueueFull = 0x01,
  kTransmitQueueFull = 0x02,
  kErrorWarning = 0x04,
  kDataOverrun = 0x08,
  kErrorPassive = 0x20,
  kArbitrationLost = 0x40,
  kBusError = 0x80,
};

std::span<const std::uint8_t> as_bytes(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

Reply plain(ReplyKind kind) {
  Reply reply;
  reply.kind = kind;
  return reply;
}

Reply done_if(bool possible) {
  return plain(possible ? ReplyKind::done : ReplyKind::refused);
}

std::uint16_t as_flags(const ControllerReport& report) {
  unsigned flags = 0;
  flags |= report.receive_overflow ? unsigned{kDataOverrun} : 0U;
  flags |= report.transmit_overflow ? unsigned{kTransmitQueueFull} : 0U;
  flags |= report.arbitration_lost ? unsigned{kArbitrationLost} : 0U;
  flags |= report.error != BusError::none ? unsigned{kBusError} : 0U;
  return static_cast<std::uint16_t>(flags);
}

}  // namespace

SlcanAdapter::SlcanAdapter(ByteStream& line, SlcanAdapterSettings settings)
    : line_(line), settings_(std::move(settings)) {
  if (settings_.bit_rate_bps < 5'000 || settings_.bit_rate_bps > 1'000'000) {
    throw std::invalid_argument("slcan: bit rate is " + std::to_string(settings_.bit_rate_bps) +
                                " bit/s, allowed is 5000 .. 1000000");
  }
  kept_.reserve(kGreatestBacklog);
}

SlcanAdapter::SlcanAdapter(ByteStream& line, std::uint32_t bit_rate_bps)
    : SlcanAdapter(line, SlcanAdapterSettings{bit_rate_bps, SlcanDialect::automatic, {}, 0}) {}

void SlcanAdapter::start(Receiver receiver) {
  receiver_ = std::move(receiver);
  line_.on_client([this](const LineClient& client) {
    if (!client.present) {
      power_up();
    }
  });
  line_.start([this](std::span<const std::uint8_t> bytes) {
    flush();
    for (const std::uint8_t byte : bytes) {
      if (const auto line = splitter_.push(byte)) {
        take_line(*line);
      }
    }
  });
}

bool SlcanAdapter::deliver(const protocols::can::Frame& frame, Stamp stamp) {
  newest_stamp_ = stamp;
  if (session_.channel == Channel::closed) {
    return true;
  }
  if (!hears_bus()) {
    ++counters_.wrong_rate;
    return true;
  }
  if (!session_.filter.accepts(frame)) {
    ++counters_.filtered;
    return true;
  }
  Reply reply = plain(ReplyKind::frame);
  reply.frame = frame;
  if (session_.time_stamps) {
    const auto time = std::chrono::duration_cast<std::chrono::milliseconds>(stamp);
    reply.time_stamp_ms = static_cast<std::uint16_t>(time.count() % slcan::kTimeStampModulus);
  }
  const bool polled = session_.auto_poll == false;
  if (polled ? session_.fetched.size() == kFetched : !flush()) {
    ++counters_.backlogged;
    session_.flags |= kReceiveQueueFull | kDataOverrun;
    return false;
  }
  if (polled) {
    session_.fetched.push_back(reply);
    return true;
  }
  return write(slcan::write_reply(reply).span());
}

void SlcanAdapter::confirm(bool sent, Stamp stamp) {
  newest_stamp_ = stamp;
  unconfirmed_ -= unconfirmed_ > 0 ? 1 : 0;
  counters_.unsent += sent ? 0 : 1;
}

bool SlcanAdapter::report(const ControllerReport& report, Stamp stamp) {
  newest_stamp_ = stamp;
  if (session_.channel == Channel::closed) {
    return true;
  }
  session_.state = report.state;
  session_.flags |= as_flags(report);
  if (!announces(stamp)) {
    return true;
  }
  bool passed_on = true;
  for (const auto& line : {slcan::error_line(report), slcan::state_line(report)}) {
    passed_on = (!line || write(slcan::write_reply(*line).span())) && passed_on;
  }
  return passed_on;
}

EndpointStatus SlcanAdapter::status() const {
  EndpointStatus status = line_.status();
  status.address = "slcan " + status.address;
  status.client_present = session_.channel != Channel::closed && status.client_present;
  return status;
}

void SlcanAdapter::take_line(const slcan::LineSplitter::Line& line) {
  if (line.too_long) {
    ++counters_.too_long_lines;
    answer(plain(ReplyKind::refused));
    return;
  }
  if (line.text.empty()) {
    return;  // masters send a few CR to clear the line
  }
  const auto command = slcan::parse_command(line.text);
  if (!command.ok()) {
    answer(plain(ReplyKind::refused));
    return;
  }
  switch (command->verb) {
    case slcan::Verb::version:
      write(as_bytes(kVersion));
      break;
    case slcan::Verb::detailed_version:
      write(as_bytes(kDetailedVersion));
      break;
    case slcan::Verb::serial_number:
      write(as_bytes(kSerialNumber));
      break;
    default:
      answer(execute(*command));
      break;
  }
}

Reply SlcanAdapter::execute(const slcan::Command& command) {
  const bool closed = session_.channel == Channel::closed;
  switch (command.verb) {
    case slcan::Verb::open:
      set_channel(Channel::open);
      return done_if(true);
    case slcan::Verb::listen_only:
      set_channel(Channel::listening);
      return done_if(true);
    case slcan::Verb::close:
      set_channel(Channel::closed);
      return done_if(true);
    case slcan::Verb::bit_rate:
      return done_if(set_bit_rate(slcan::rate_of_code(command.number, settings_.bit_rate_bps)));
    case slcan::Verb::bit_timing:
      return done_if(
          set_bit_rate(slcan::rate_of_registers(static_cast<std::uint16_t>(command.number))));
    case slcan::Verb::acceptance_code:
    case slcan::Verb::acceptance_mask:
    case slcan::Verb::filter_mode:
      return done_if(set_filter(command));
    case slcan::Verb::time_stamps:
      session_.time_stamps = command.number != 0;
      return done_if(true);
    case slcan::Verb::auto_poll:
      session_.auto_poll = command.number != 0;
      return done_if(true);
    case slcan::Verb::line_speed:
      return done_if(true);
    case slcan::Verb::poll: {
      if (closed || session_.auto_poll != false) {
        return done_if(false);
      }
      if (session_.fetched.empty()) {
        return done_if(true);
      }
      const Reply frame = session_.fetched.front();
      session_.fetched.pop_front();
      return frame;
    }
    case slcan::Verb::poll_all:
      return closed || session_.auto_poll != false ? done_if(false) : fetch_all();
    case slcan::Verb::status_flags: {
      Reply flags = plain(ReplyKind::status_flags);
      flags.number = closed ? std::uint16_t{0} : take_flags();
      return closed ? done_if(false) : flags;
    }
    case slcan::Verb::frame:
      return take_frame(command.frame);
    default:
      return done_if(false);
  }
}

Reply SlcanAdapter::take_frame(const protocols::can::Frame& frame) {
  if (session_.channel != Channel::open) {
    return done_if(false);
  }
  if (settings_.transmit_queue_frames != 0) {
    if (unconfirmed_ >= settings_.transmit_queue_frames) {
      ++counters_.queue_full;
      ControllerReport full;
      full.state = session_.state;
      full.transmit_overflow = true;
      report(full, newest_stamp_);
      return done_if(false);
    }
    ++unconfirmed_;
  }
  if (receiver_) {
    receiver_(frame);
  }
  Reply taken = plain(session_.auto_poll == true ? ReplyKind::frame_taken : ReplyKind::done);
  taken.frame = frame;
  return taken;
}

bool SlcanAdapter::set_bit_rate(std::optional<std::uint32_t> rate_bps) {
  if (session_.channel != Channel::closed || !rate_bps) {
    return false;
  }
  session_.bit_rate_bps = slcan::rates_agree(*rate_bps, settings_.bit_rate_bps) ? 0 : *rate_bps;
  return true;
}

bool SlcanAdapter::set_filter(const slcan::Command& command) {
  if (session_.channel != Channel::closed) {
    return false;
  }
  if (command.verb == slcan::Verb::acceptance_code) {
    session_.filter.code = command.number;
  } else if (command.verb == slcan::Verb::acceptance_mask) {
    session_.filter.mask = command.number;
  } else {
    session_.filter.single = command.number != 0;
  }
  return true;
}

Reply SlcanAdapter::fetch_all() {
  for (const Reply& frame : session_.fetched) {
    write(slcan::write_reply(frame).span());
  }
  session_.fetched.clear();
  return plain(ReplyKind::all_polled);
}

std::uint16_t SlcanAdapter::take_flags() {
  unsigned flags = session_.flags;
  flags |= session_.state == ErrorState::warning ? unsigned{kErrorWarning} : 0U;
  flags |= session_.state == ErrorState::passive || session_.state == ErrorState::bus_off
               ? unsigned{kErrorWarning} | kErrorPassive
               : 0U;
  session_.flags = 0;
  return static_cast<std::uint16_t>(flags);
}

void SlcanAdapter::set_channel(Channel channel) {
  if (channel == session_.channel) {
    return;
  }
  session_.channel = channel;
  session_.flags = 0;
  session_.state = ErrorState::active;
  session_.fetched.clear();
  const bool open = channel != Channel::closed;
  const CanClient client{open, open ? session_.bit_rate_bps : 0, channel == Channel::listening,
                         false};
  if (watcher_ && client != told_) {
    told_ = client;
    watcher_(client);
  }
}

void SlcanAdapter::power_up() {
  set_channel(Channel::closed);
  session_ = Session{};
  splitter_ = {};
  kept_.clear();
}

bool SlcanAdapter::announces(Stamp stamp) {
  if (settings_.dialect != SlcanDialect::automatic) {
    return settings_.dialect == SlcanDialect::kernel;
  }
  const auto& looked = session_.looked_for_kernel;
  if (!session_.kernel_seen && settings_.kernel_attached &&
      (!looked || stamp - *looked >= kKernelPeriod || stamp < *looked)) {
    session_.looked_for_kernel = stamp;
    session_.kernel_seen = settings_.kernel_attached();
  }
  return session_.kernel_seen;
}

bool SlcanAdapter::hears_bus() const {
  return session_.bit_rate_bps == 0 || session_.bit_rate_bps == settings_.bit_rate_bps;
}

void SlcanAdapter::answer(const Reply& reply) {
  if (reply.kind == ReplyKind::refused) {
    ++counters_.refused_commands;
  }
  write(slcan::write_reply(reply).span());
}

bool SlcanAdapter::flush() {
  if (!kept_.empty()) {
    const std::size_t taken = line_.write(kept_);
    kept_.erase(kept_.begin(), kept_.begin() + static_cast<std::ptrdiff_t>(taken));
  }
  return kept_.empty();
}

bool SlcanAdapter::write(std::span<const std::uint8_t> bytes) {
  const std::size_t taken = flush() ? line_.write(bytes) : 0;
  const auto rest = bytes.subspan(taken);
  if (kept_.size() + rest.size() > kGreatestBacklog) {
    ++counters_.unanswered;
    return false;
  }
  kept_.insert(kept_.end(), rest.begin(), rest.end());
  return true;
}

}  // namespace rigwire::drivers
