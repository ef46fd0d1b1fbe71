// Reports when something solid begins to push the machine, and when nothing pushes it any more.
#pragma once

#include <string>

#include "hil/record/run_events.h"
#include "hil/world/truth_observer.h"

namespace rigwire::hil {

/// Uses each record of the truth: a touch between two records is not seen. A contact that is
/// interrupted for less than kOver and returns with the same body and obstacle is one contact.
class ContactWatch final : public TruthObserver {
 public:
  static constexpr Duration kOver = std::chrono::milliseconds{100};

  /// `events` must outlive it.
  explicit ContactWatch(RunEvents& events) : events_(events) {}
  void record(const TruthRecord& record) override;

 private:
  RunEvents& events_;
  bool touching_ = false;
  SimTime last_touch_{};
  std::string body_;
  std::string with_;
};

}  // namespace rigwire::hil
