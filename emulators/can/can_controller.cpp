#include "emulators/can/can_controller.h"

#include <algorithm>
#include <utility>

namespace rigwire::emulators {

using protocols::can::BusError;
using protocols::can::ControllerReport;
using protocols::can::ErrorState;
using protocols::can::Frame;
using protocols::can::FrameField;

CanController::CanController(const CanNodeSettings& settings, FrameOutput* exit)
    : settings_(settings), exit_(exit), queue_(settings.queue_frames, settings.order) {}

void CanController::connect(SimTime now, bool* stale) {
  stale_ = stale;
  available_from_ = std::max(available_from_, now);
  recessive_since_ = std::max(recessive_since_, now);
  suspended_ = false;
  wake();
}

void CanController::send(SimTime due, const Frame& frame) {
  ++counters_.offered;
  if (!acknowledges()) {
    ++counters_.abandoned;
    refuse(due);
  } else if (!queue_.push(due, frame)) {
    ++counters_.overflowed;
    if (outside_ != nullptr) {
      ControllerReport report = status();
      report.transmit_overflow = true;
      outside_->report(due, report);
    }
    refuse(due);
  } else {
    wake();
  }
}

/// Confirms to the client that the frame was refused, after all frames that it sent before.
void CanController::refuse(SimTime now) {
  if (outside_ == nullptr) {
    return;
  }
  if (CanWaitingFrame* newest = queue_.newest(); newest != nullptr) {
    ++newest->refused_behind;
  } else if (on_wire_) {
    ++on_wire_->refused_behind;
  } else {
    outside_->confirm(now, false);
  }
}

void CanController::settle(SimTime now, const CanWaitingFrame& frame, bool was_sent) {
  ++(was_sent ? counters_.sent : counters_.abandoned);
  if (outside_ == nullptr) {
    return;
  }
  outside_->confirm(now, was_sent);
  for (std::uint64_t i = 0; i < frame.refused_behind; ++i) {
    outside_->confirm(now, false);
  }
}

void CanController::give_up_all(SimTime now) {
  if (on_wire_) {
    settle(now, *std::exchange(on_wire_, std::nullopt), false);
  }
  while (queue_.size() > 0) {
    settle(now, queue_.drop(), false);
  }
}

void CanController::configure(SimTime now, const OutsideController& client,
                              std::uint32_t bus_rate_bps) {
  open_ = client.present;
  settings_.bit_rate_bps = client.bit_rate_bps != 0 ? client.bit_rate_bps : bus_rate_bps;
  settings_.listen_only = client.listen_only;
  settings_.one_shot = client.one_shot;
  settings_.restart_after = client.restart_after;
  if (!acknowledges()) {
    give_up_all(now);
  }
  confinement_.reset();
  recovering_ = false;
  suspended_ = false;
  restart_at_ = kNever;
  available_from_ = now;
  if (announced_ != ErrorState::active) {
    announce(now, {});
  }
  wake();
}

void CanController::begin(SimTime start, SimTime offered_at) {
  on_wire_ = queue_.take(offered_at);
  start_of_frame_ = start;
  counters_.retransmissions += on_wire_->failed_before ? 1U : 0U;
}

void CanController::sent(SimTime now) {
  if (!on_wire_) {
    return;
  }
  const CanWaitingFrame frame = *std::exchange(on_wire_, std::nullopt);
  counters_.longest_wait = std::max(counters_.longest_wait, start_of_frame_ - frame.due);
  confinement_.transmitted();
  settle(now, frame, true);
  if (confinement_.state() != announced_) {
    announce(now, {});
  }
}

void CanController::failed(SimTime now) {
  if (!on_wire_) {
    return;
  }
  on_wire_->failed_before = true;
  const CanWaitingFrame frame = *std::exchange(on_wire_, std::nullopt);
  if (settings_.one_shot) {
    settle(now, frame, false);
  } else {
    queue_.put_back(frame);
  }
}

void CanController::lost(SimTime now, std::uint8_t bit, FrameField field) {
  if (!on_wire_) {
    return;
  }
  lose_arbitration();
  const CanWaitingFrame frame = *std::exchange(on_wire_, std::nullopt);
  if (!settings_.one_shot) {
    queue_.put_back(frame);
    return;
  }
  settle(now, frame, false);
  ControllerReport report;
  report.arbitration_lost = true;
  report.bit = bit;
  report.field = field;
  announce(now, report);
}

void CanController::receive(SimTime now, const Frame& frame, bool from_outside) {
  ++counters_.received;
  if (!settings_.listen_only) {
    confinement_.received();
    if (confinement_.state() != announced_) {
      announce(now, {});
    }
  }
  if (device_ == nullptr) {
    return;
  }
  const std::uint64_t accepted = from_outside ? device_->received().accepted : 0;
  device_->receive(now, frame);
  if (from_outside && device_->received().accepted != accepted) {
    last_request_ = {now, frame};
  }
}

/// Counts the error by its kind, applies the rule of ISO 11898-1:2015, 12.1.4, to the error
/// counters and announces the new state. A controller that reaches bus-off gives up its frames.
void CanController::count_error(SimTime now, CanErrorRule rule, ControllerReport report) {
  switch (report.error) {
    case BusError::none:
      break;
    case BusError::bit:
      ++counters_.errors.bit;
      break;
    case BusError::stuff:
      ++counters_.errors.stuff;
      break;
    case BusError::form:
      ++counters_.errors.form;
      break;
    case BusError::crc:
      ++counters_.errors.crc;
      break;
    case BusError::acknowledgement:
      ++counters_.errors.acknowledgement;
      break;
  }
  if (!settings_.listen_only) {
    switch (rule) {
      case CanErrorRule::none:
        break;
      case CanErrorRule::transmit:
        confinement_.transmit_error();
        break;
      case CanErrorRule::receive:
        confinement_.receive_error();
        break;
      case CanErrorRule::severe_receive:
        confinement_.severe_receive_error();
        break;
    }
  }
  const bool goes_off = confinement_.bus_off() && announced_ != ErrorState::bus_off;
  if (report.error != BusError::none || confinement_.state() != announced_) {
    announce(now, report);
  }
  if (goes_off) {
    ++counters_.bus_offs;
    give_up_all(now);
    restart_at_ = settings_.restart_after ? now + *settings_.restart_after : kNever;
    wake();
  }
}

void CanController::restart(SimTime now) {
  if (open_ && confinement_.bus_off() && !recovering_) {
    begin_recovery(now);
  }
}

void CanController::begin_recovery(SimTime now) {
  restart_at_ = kNever;
  recovering_ = true;
  sequences_left_ = kRecoverySequences;
  recessive_since_ = now;
  wake();
}

void CanController::end_recessive_run(std::uint64_t bits) {
  const std::uint64_t sequences = bits / kSequenceBits;
  sequences_left_ -= static_cast<unsigned>(std::min<std::uint64_t>(sequences, sequences_left_));
}

void CanController::recover(SimTime now) {
  recovering_ = false;
  confinement_.reset();
  available_from_ = now;
  ControllerReport report;
  report.restarted = true;
  announce(now, report);
  wake();
}

ControllerReport CanController::status() const {
  ControllerReport report;
  report.state = confinement_.state();
  report.transmit_errors = confinement_.transmit_errors();
  report.receive_errors = confinement_.receive_errors();
  return report;
}

void CanController::announce(SimTime now, ControllerReport report) {
  const ControllerReport present = status();
  report.state = present.state;
  report.transmit_errors = present.transmit_errors;
  report.receive_errors = present.receive_errors;
  report.state_changed = report.state != announced_;
  announced_ = report.state;
  if (outside_ != nullptr) {
    outside_->report(now, report);
  }
  if (device_ != nullptr) {
    device_->controller(now, report);
  }
}

CanNodeCounters CanController::counters() const {
  CanNodeCounters result = counters_;
  result.queued = queue_.size() + (on_wire_ ? 1U : 0U);
  return result;
}

}  // namespace rigwire::emulators
