// Frames, checks and acknowledgements: UBX-13003221 R28, sections 32.2, 32.4 and 32.5.
#include <algorithm>
#include <array>

#include "conform/ubx/ubx_trial.h"

namespace rigwire::conform {

namespace ubx = protocols::ubx;
using std::chrono::milliseconds;

namespace {

using T = UbxTrial;

constexpr UbxId kVersion{0x0A, 0x04};
constexpr UbxId kRate{0x06, 0x08};
// A message of class CFG that no document here has.
constexpr UbxId kUnknownSetting{0x06, 0xFE};

void answered(T& trial, const UbxBytes& bytes, const std::string& words) {
  if (trial.send(bytes, words)) {
    static_cast<void>(trial.until_version());
  }
}

void in_pieces(T& trial, std::size_t piece) {
  const UbxBytes frame = T::framed(kVersion, {});
  for (std::size_t at = 0; at < frame.size(); at += piece) {
    const auto end =
        frame.begin() + static_cast<std::ptrdiff_t>(std::min(frame.size(), at + piece));
    const UbxBytes bytes(frame.begin() + static_cast<std::ptrdiff_t>(at), end);
    if (!trial.send(bytes, "a piece of a poll of MON-VER")) {
      return;
    }
    if (end != frame.end()) {
      static_cast<void>(trial.listen(milliseconds(20)));
    }
  }
  bool came = false;
  for (const UbxHeard& heard : trial.listen(trial.claims().patience)) {
    if (heard.kind == UbxHeard::Kind::frame && heard.id == kVersion) {
      trial.show(heard);
      came = true;
      break;
    }
  }
  trial.expect(came, "MON-VER", "none");
}

/// A poll of MON-VER with one byte changed.
UbxBytes spoiled(std::size_t at, std::uint8_t by) {
  UbxBytes frame = T::framed(kVersion, {});
  frame[at] = static_cast<std::uint8_t>(frame[at] ^ by);
  return frame;
}

void wrong_check(T& trial, std::size_t at) {
  trial.ignores(spoiled(at, 0x01), "a poll of MON-VER with a wrong check");
}

// Nothing but MON-VER's second poll is answered once.
void answered_once(T& trial) {
  if (!trial.send(kVersion, {})) {
    return;
  }
  int answers = 0;
  for (const UbxHeard& heard : trial.listen(trial.claims().patience)) {
    if (heard.kind == UbxHeard::Kind::frame && heard.id == kVersion) {
      trial.show(heard);
      ++answers;
    }
  }
  trial.expect(answers == 1, "MON-VER once", std::to_string(answers) + " times");
}

/// Frames of class CFG and acknowledgements until MON-VER is answered.
std::optional<std::vector<UbxHeard>> dialogue(T& trial, const UbxBytes& bytes,
                                              const std::string& words) {
  if (!trial.send(bytes, words)) {
    return std::nullopt;
  }
  auto before = trial.until_version();
  if (before) {
    std::erase_if(*before, [](const UbxHeard& heard) {
      return heard.id.message_class != 0x05 && heard.id.message_class != 0x06;
    });
    for (const UbxHeard& heard : *before) {
      trial.show(heard);
    }
  }
  return before;
}

std::string told(const std::vector<UbxHeard>& all) {
  std::string text;
  for (const UbxHeard& heard : all) {
    const std::string words = ubx_words(heard.id, heard.payload());
    text += (text.empty() ? "" : ", ") + words.substr(0, words.find(':'));
  }
  return text.empty() ? "nothing" : text;
}

void poll_of_setting(T& trial) {
  if (const auto all = dialogue(trial, T::framed(kRate, {}), "poll of CFG-RATE")) {
    trial.expect(told(*all) == "CFG-RATE, ACK-ACK of CFG-RATE",
                 "CFG-RATE, ACK-ACK of CFG-RATE, and nothing else", told(*all));
  }
}

void several_settings(T& trial) {
  UbxBytes bytes;
  for (int i = 0; i < 3; ++i) {
    bytes = bytes + T::framed(kRate, {}) + T::framed(kUnknownSetting, {});
  }
  if (const auto all =
          dialogue(trial, bytes, "three polls of CFG-RATE, each with an unknown one")) {
    std::string wanted;
    for (int i = 0; i < 3; ++i) {
      wanted += std::string(i > 0 ? ", " : "") +
                "CFG-RATE, ACK-ACK of CFG-RATE, ACK-NAK of class 06, id FE";
    }
    trial.expect(told(*all) == wanted, wanted, told(*all));
  }
}

void not_acknowledged(T& trial) {
  const auto all = dialogue(trial, T::framed({0x0A, 0x09}, {}), "poll of MON-HW");
  if (all) {
    trial.expect(all->empty(), "no acknowledgement", told(*all));
  }
}

void unknown_setting(T& trial, const UbxBytes& payload) {
  const auto all =
      dialogue(trial, T::framed(kUnknownSetting, payload), "an unknown message of class CFG");
  if (all) {
    trial.expect(told(*all) == "ACK-NAK of class 06, id FE", "ACK-NAK of class 06, id FE alone",
                 told(*all));
  }
}

void answers_in_time(T& trial) {
  constexpr int kPolls = 100;
  std::vector<std::chrono::nanoseconds> times;
  for (int i = 0; i < kPolls; ++i) {
    if (!trial.poll("MON-VER")) {
      return;
    }
    times.push_back(trial.took());
  }
  std::ranges::sort(times);
  const auto in_ms = [](std::chrono::nanoseconds time) {
    return std::to_string(std::chrono::duration_cast<milliseconds>(time).count()) + " ms";
  };
  const auto late = times[times.size() * 99 / 100];
  trial.expect(late <= trial.claims().answer_within,
               "99 of 100 answers within " + in_ms(trial.claims().answer_within), in_ms(late));
}

struct FramingRow {
  const char* section;
  const char* title;
  Strength strength;
  void (*run)(T&);
  bool rate = false;  ///< Needs CFG-RATE.
};

const std::array kFramingRows{
    FramingRow{"32.2", "A poll of MON-VER is answered once", kMust, answered_once},
    FramingRow{"32.2", "A frame is taken in two pieces", kMust, [](T& t) { in_pieces(t, 6); }},
    FramingRow{"32.2", "A frame is taken byte by byte", kMust, [](T& t) { in_pieces(t, 1); }},
    FramingRow{"32.2", "A frame behind zeros is taken", kMust,
               [](T& t) { answered(t, UbxBytes(20, 0), "twenty zeros"); }},
    FramingRow{"32.2", "A frame behind a first synchronization character is taken", kMust,
               [](T& t) { answered(t, {ubx::kSync1}, "B5 alone"); }},
    FramingRow{"32.2", "A frame behind half a sentence is taken", kMust,
               [](T& t) {
                 answered(t, {'$', 'G', 'P', 'G', 'G', 'A', ',', '\r', '\n'}, "half a sentence");
               }},
    FramingRow{"32.2", "Without the second synchronization character there is no frame", kMust,
               [](T& t) { t.ignores(spoiled(1, 0x01), "B5 63 in place of B5 62"); }},
    FramingRow{"32.4", "A frame with a wrong CK_A is not answered", kMust,
               [](T& t) { wrong_check(t, ubx::kHeaderBytes); }},
    FramingRow{"32.4", "A frame with a wrong CK_B is not answered", kMust,
               [](T& t) { wrong_check(t, ubx::kHeaderBytes + 1); }},
    FramingRow{
        "32.4", "The check covers the class", kMust,
        [](T& t) { t.ignores(spoiled(2, 0x0B), "NAV-TIMEGPS' class with MON-VER's check"); }},
    FramingRow{"32.4", "The check covers the length", kMust,
               [](T& t) {
                 UbxBytes frame = T::framed(kVersion, {});
                 frame[4] = 1;
                 frame.insert(frame.begin() + ubx::kHeaderBytes, 0);
                 t.ignores(frame, "a length of 1 with the check of 0");
               }},
    FramingRow{"32.4", "A setting with a wrong check is neither acknowledged nor refused", kMust,
               [](T& t) {
                 UbxBytes frame = T::framed(kUnknownSetting, {0});
                 frame.back() = static_cast<std::uint8_t>(frame.back() ^ 0x80U);
                 t.ignores(frame, "a setting with a wrong check");
               }},
    FramingRow{"32.5.1", "A poll of a setting is answered by it and one acknowledgement", kMust,
               poll_of_setting, true},
    FramingRow{"32.5.1", "Settings polled at once are answered in their order", kMust,
               several_settings, true},
    FramingRow{"32.5.1", "A poll of a setting that there is not is refused once", kMust,
               [](T& t) { unknown_setting(t, {}); }},
    FramingRow{"32.5.1", "A setting that there is not is refused once", kMust,
               [](T& t) { unknown_setting(t, UbxBytes(8, 0)); }},
    FramingRow{"32.5.1", "Polls of class MON are not acknowledged", kMust, not_acknowledged},
    FramingRow{"32.5.2", "A poll of a class that there is not is not answered", kMust,
               [](T& t) {
                 t.ignores(T::framed({0x7D, 0x01}, {}), "a poll of class 7D");
               }},
    FramingRow{"32.5.2", "99 of 100 answers come within what is claimed", kMust, answers_in_time},
};

}  // namespace

std::vector<UbxCase> ubx_framing_cases(UbxCitations& citations) {
  std::vector<UbxCase> all;
  for (const FramingRow& row : kFramingRows) {
    UbxCase& made = all.emplace_back();
    made.identity = citations.m8.next(row.section, row.title, row.strength);
    if (row.rate) {
      made.needs = {"CFG-RATE"};
    }
    made.run = row.run;
  }
  return all;
}

}  // namespace rigwire::conform
