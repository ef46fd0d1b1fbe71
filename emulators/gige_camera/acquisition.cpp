#include "emulators/gige_camera/acquisition.h"

#include <algorithm>

namespace rigwire::emulators {

void Acquisition::start(SimTime now, const AcquisitionMeans& means) {
  means_ = means;
  running_ = true;
  started_ = now;
  admitted_ = 0;
  make_plan(now);
}

void Acquisition::stop() {
  running_ = false;
  plan_ = {};
  delayed_.clear();
}

void Acquisition::change(SimTime now, const AcquisitionMeans& means) {
  if (means == means_) {
    return;
  }
  // The last exposure that was planned, so that the next one comes a whole period after it.
  SimTime last = kNever;
  if (plan_.first != kNever && plan_.first <= now) {
    last = plan_.first + (now - plan_.first) / plan_.period * plan_.period;
  }
  const bool free = !means.triggered && !means_.triggered;
  const bool same = means.period == means_.period;
  means_ = means;
  if (!running_ || (free && same)) {
    return;
  }
  make_plan(free && last != kNever ? std::max(now, last + means.period) : now);
}

void Acquisition::make_plan(SimTime from) {
  plan_ = {};
  if (!means_.triggered) {
    plan_ = {from, means_.period};
  } else if (means_.source == TriggerSource::line && means_.line.period > Duration::zero()) {
    // Every pulse for which the sensor is ready, from the first one on that is yet to come.
    const Duration pulse = means_.line.period;
    const std::int64_t passed_over = (means_.shortest + pulse - Duration{1}) / pulse;
    const SamplePlan pulses{kStart + means_.line.first + means_.trigger_delay, pulse};
    plan_ = {pulses.first >= from ? pulses.first : pulses.next_after(from - Duration{1}),
             std::max<std::int64_t>(passed_over, 1) * pulse};
  }
}

bool Acquisition::trigger(SimTime now) {
  const bool waits = running_ && means_.triggered && means_.source == TriggerSource::software;
  const SimTime exposure = now + means_.trigger_delay;
  if (!waits || exposure < ready_at_ || !delayed_.push(exposure)) {
    ++ignored_triggers_;
    return false;
  }
  ready_at_ = exposure + means_.shortest;
  advance(now);
  return true;
}

void Acquisition::advance(SimTime now) {
  while (!delayed_.empty() && delayed_.front() <= now) {
    [[maybe_unused]] const SimTime exposure = delayed_.pop();
    ++software_exposures_;
  }
}

SimTime Acquisition::next_event() const {
  return delayed_.empty() ? kNever : delayed_.front();
}

bool Acquisition::admit(SimTime exposure_start) {
  if (!running_ || exposure_start < started_) {
    return false;
  }
  ++admitted_;
  const bool last = means_.mode == AcquisitionMode::single_frame ||
                    (means_.mode == AcquisitionMode::multi_frame && admitted_ >= means_.frames);
  if (last) {
    stop();
  }
  return true;
}

}  // namespace rigwire::emulators
