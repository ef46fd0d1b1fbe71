#include "hil/record/contact_watch.h"

#include <fmt/format.h>

namespace rigwire::hil {
namespace {

std::string named(const std::string& with) {
  return with.empty() ? "something solid" : with;
}

}  // namespace

void ContactWatch::record(const TruthRecord& record) {
  const bool pushes = record.contact && record.contact->touching;
  const bool is_other = pushes && (record.contact->body != body_ || record.contact->with != with_);
  if (touching_ && (is_other || (!pushes && record.time - last_touch_ >= kOver))) {
    touching_ = false;
    events_.tell_ahead(record.time, EventKind::contact_ended, LogLevel::info, body_,
                       fmt::format("{} is clear of {}", body_, named(with_)));
  }
  if (!pushes) {
    return;
  }
  last_touch_ = record.time;
  if (!touching_) {
    touching_ = true;
    body_ = record.contact->body;
    with_ = record.contact->with;
    events_.tell_ahead(record.time, EventKind::contact_begun, LogLevel::info, body_,
                       fmt::format("{} hits {} with {:.2f} kN", body_, named(with_),
                                   1e-3 * record.contact->force_W.norm()));
  }
}

}  // namespace rigwire::hil
