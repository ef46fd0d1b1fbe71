#include "drivers/slcan_client.h"

#include <stdexcept>
#include <string>

#include "protocols/slcan/bit_rate.h"
#include "protocols/slcan/slcan.h"

namespace rigwire::drivers {

namespace slcan = protocols::slcan;
using slcan::ReplyKind;

SlcanClient::SlcanClient(ByteStream& line, std::uint32_t bit_rate_bps)
    : line_(line), rate_code_(0) {
  const auto code = slcan::rate_code(bit_rate_bps);
  if (!code) {
    throw std::invalid_argument("slcan: bit rate " + std::to_string(bit_rate_bps) +
                                " bit/s has no code S0..S8 (10000 .. 1000000)");
  }
  rate_code_ = *code;
}

SlcanClient::~SlcanClient() {
  line_.start({});
  write(slcan::write_command({slcan::Verb::close, 0, {}}).span());
}

void SlcanClient::start(Receiver receiver) {
  receiver_ = std::move(receiver);
  line_.start([this](std::span<const std::uint8_t> bytes) {
    for (const std::uint8_t byte : bytes) {
      if (const auto line = splitter_.push(byte)) {
        take_line(*line);
      }
    }
  });
  reopen();
}

void SlcanClient::reopen() {
  controller_ = {};
  write(slcan::write_command({slcan::Verb::close, 0, {}}).span());
  write(slcan::write_command({slcan::Verb::bit_rate, static_cast<std::uint16_t>(rate_code_), {}})
            .span());
  write(slcan::write_command({slcan::Verb::open, 0, {}}).span());
}

bool SlcanClient::send(const protocols::can::Frame& frame) {
  if (!flush()) {
    ++counters_.backlogged;
    return false;
  }
  write(slcan::write_frame(frame).span());
  return true;
}

EndpointStatus SlcanClient::status() const {
  return {"slcan " + line_.status().address, answered_ && line_.status().client_present};
}

void SlcanClient::take_line(const slcan::LineSplitter::Line& line) {
  const auto reply = slcan::parse_reply(line.text);
  if (line.too_long || !reply.ok()) {
    ++counters_.malformed;
    return;
  }
  answered_ = true;
  switch (reply->kind) {
    case ReplyKind::refused:
      ++counters_.refused;
      break;
    case ReplyKind::frame:
      if (receiver_) {
        receiver_(reply->frame);
      }
      break;
    case ReplyKind::bus_state:
    case ReplyKind::bus_errors:
      take_report(slcan::report_of(*reply));
      break;
    default:
      break;
  }
}

void SlcanClient::take_report(const protocols::can::ControllerReport& report) {
  if (report.state_changed) {
    controller_ = report;
  } else {
    ++counters_.bus_errors;
  }
  if (watcher_) {
    watcher_(report);
  }
}

bool SlcanClient::flush() {
  if (!kept_.empty()) {
    const std::size_t taken = line_.write(kept_);
    kept_.erase(kept_.begin(), kept_.begin() + static_cast<std::ptrdiff_t>(taken));
  }
  return kept_.empty();
}

void SlcanClient::write(std::span<const std::uint8_t> bytes) {
  const std::size_t taken = flush() ? line_.write(bytes) : 0;
  const auto rest = bytes.subspan(taken);
  kept_.insert(kept_.end(), rest.begin(), rest.end());
}

}  // namespace rigwire::drivers
