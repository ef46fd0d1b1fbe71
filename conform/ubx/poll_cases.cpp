// Each message that can be polled: UBX-13003221 R28, section 32.5.2, and the section of each.
#include <algorithm>

#include "conform/ubx/ubx_trial.h"

namespace rigwire::conform {

namespace {

Citations& of(UbxCitations& citations, const UbxMessage& message) {
  return message.document == UbxDocument::f9 ? citations.f9 : citations.m8;
}

/// Polls an unclaimed message: one of class CFG must be refused, others are not answered.
void unclaimed(UbxTrial& trial, const UbxMessage& message) {
  const UbxBytes selector(message.selector.begin(), message.selector.end());
  if (message.id.message_class == 0x06) {
    trial.refuses(message.id, selector);
    return;
  }
  if (!trial.send(UbxTrial::framed(message.id, selector), "poll of " + std::string(message.name))) {
    return;
  }
  const auto before = trial.until_version();
  if (before) {
    const bool silent = std::ranges::none_of(
        *before, [&](const UbxHeard& heard) { return heard.id == message.id; });
    trial.observe(silent ? "not answered" : "answered, though not claimed");
  }
}

}  // namespace

std::vector<UbxCase> ubx_poll_cases(UbxCitations& citations) {
  std::vector<UbxCase> all;
  for (const UbxMessage& message : ubx_messages()) {
    if (message.poll == UbxPoll::none) {
      continue;
    }
    const std::string name(message.name);
    const std::string title = "A poll of " + name + " is answered";
    UbxCase& made = all.emplace_back();
    made.identity = message.document == UbxDocument::recordings
                        ? citations.m8.next_in(name, title, source_of(message))
                        : of(citations, message).next(std::string(message.section), title);
    made.needs = {message.name};
    made.run = [&message](UbxTrial& trial) { static_cast<void>(trial.poll(message.name)); };
  }
  UbxCase& others = all.emplace_back();
  others.identity = citations.m8.next(
      "32.5.2", "Settings that are not claimed are refused, other messages not answered");
  others.run = [](UbxTrial& trial) {
    for (const UbxMessage& message : ubx_messages()) {
      if (message.poll != UbxPoll::none && !trial.claims().has(message.name)) {
        unclaimed(trial, message);
      }
    }
  };
  return all;
}

}  // namespace rigwire::conform
