#include "conform/reports.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "protocols/markup.h"
#include "protocols/pcapng/link_packet.h"
#include "protocols/plain_text.h"

namespace rigwire::conform {

using protocols::escape_markup;
using protocols::printable;

namespace {

constexpr std::array kVerdicts{Verdict::fail,    Verdict::error,         Verdict::not_reached,
                               Verdict::lenient, Verdict::pass,          Verdict::informational,
                               Verdict::skipped, Verdict::not_applicable};

template <class Word, std::size_t n>
Word of_word(const std::string& text, const std::array<Word, n>& all) {
  const auto* const found =
      std::ranges::find_if(all, [&](Word each) { return word(each) == text; });
  if (found == all.end()) {
    throw std::runtime_error("\"" + text + "\" is no verdict, strength or danger");
  }
  return *found;
}

std::string milliseconds_text(std::chrono::nanoseconds time) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.3f", static_cast<double>(time.count()) * 1e-6);
  return text.data();
}

std::string_view word(Step::Kind kind) {
  constexpr std::array<std::string_view, 3> kWords{"sent", "received", "note"};
  return kWords[static_cast<std::size_t>(kind)];
}

std::string chapter(const std::string& id) {
  return id.substr(0, id.rfind('/'));
}

/// A paragraph: what was expected and seen, and the exchange, a line each.
std::string story(const CaseResult& result) {
  std::string text;
  if (!result.expected.empty()) {
    text += "expected: " + result.expected + "\n";
  }
  if (!result.got.empty()) {
    text += (result.expected.empty() ? "" : "got: ") + result.got + "\n";
  }
  for (const Step& step : result.steps) {
    text += milliseconds_text(step.at) + " ms " + std::string(word(step.kind)) + ": " + step.words;
    if (!step.bytes.empty()) {
      text += "\n    " + hex_text(step.bytes);
    }
    text += "\n";
  }
  return text;
}

nlohmann::json to_json(const CaseResult& result) {
  nlohmann::json steps = nlohmann::json::array();
  for (const Step& step : result.steps) {
    steps.push_back({{"kind", word(step.kind)},
                     {"ms", static_cast<double>(step.at.count()) * 1e-6},
                     {"words", printable(step.words, "\n\t")},
                     {"bytes", hex_text(step.bytes, step.bytes.size())}});
  }
  const CaseIdentity& identity = result.identity;
  return {{"id", identity.id},
          {"title", identity.title},
          {"source", identity.source},
          {"strength", word(identity.strength)},
          {"danger", word(identity.danger)},
          {"verdict", word(result.verdict)},
          {"expected", printable(result.expected, "\n\t")},
          {"got", printable(result.got, "\n\t")},
          {"steps", steps}};
}

std::vector<std::uint8_t> bytes_of(const std::string& hex) {
  std::vector<std::uint8_t> bytes;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 3) {
    bytes.push_back(static_cast<std::uint8_t>(std::stoul(hex.substr(i, 2), nullptr, 16)));
  }
  return bytes;
}

CaseResult case_of(const nlohmann::json& json) {
  CaseResult result;
  const auto text = [&](const char* key) { return json.at(key).get<std::string>(); };
  result.identity = {
      text("id"), text("title"), text("source"),
      of_word(text("strength"), std::array{Strength::must, Strength::should, Strength::observed}),
      of_word(text("danger"), std::array{Danger::none, Danger::writes, Danger::moves})};
  result.verdict = of_word(text("verdict"), kVerdicts);
  result.expected = text("expected");
  result.got = text("got");
  for (const nlohmann::json& step : json.at("steps")) {
    const auto kind = step.at("kind").get<std::string>();
    result.steps.push_back(
        {kind == "sent"       ? Step::Kind::sent
         : kind == "received" ? Step::Kind::received
                              : Step::Kind::note,
         std::chrono::nanoseconds(std::llround(1e6 * step.at("ms").get<double>())),
         bytes_of(step.at("bytes").get<std::string>()), step.at("words").get<std::string>()});
  }
  return result;
}

constexpr std::string_view kStyle = R"(<style>
:root { color-scheme: light dark; --line: #8884; }
body { font: 15px/1.45 system-ui, sans-serif; margin: 2em auto; max-width: 90em; padding: 0 1em; }
table { border-collapse: collapse; width: 100%; }
th, td { text-align: left; vertical-align: top; padding: .35em .6em; border-bottom: 1px solid var(--line); }
th { position: sticky; top: 0; background: Canvas; }
td.chapter { font-weight: 600; padding-top: 1.4em; }
td.id { white-space: nowrap; font-family: ui-monospace, monospace; font-size: 13px; }
tr { scroll-margin-top: 6em; }
.title { min-width: 18em; }
.source { opacity: .7; font-size: 13px; }
summary { cursor: pointer; }
pre { white-space: pre-wrap; overflow-wrap: anywhere; font-size: 12.5px; margin: .4em 0; }
.v { font-weight: 600; }
.pass .v { color: #1a7f37; } .fail .v, .error .v { color: #d1242f; }
.lenient .v { color: #9a6700; } .differs { background: #d1242f14; }
.skipped, .not { opacity: .55; }
@media (prefers-color-scheme: dark) {
  .pass .v { color: #3fb950; } .fail .v, .error .v { color: #f85149; } .lenient .v { color: #d29922; }
}
</style>)";

std::string cell(const CaseResult* result) {
  if (result == nullptr) {
    return "<td></td>";
  }
  const std::string verdict(word(result->verdict));
  const std::string kind = verdict.substr(0, verdict.find(' '));
  const bool told = result->verdict == Verdict::fail || result->verdict == Verdict::lenient ||
                    result->verdict == Verdict::error || result->verdict == Verdict::not_reached;
  const std::string brief = told && !result->expected.empty()
                                ? "expected " + result->expected + "; got " + result->got
                                : result->got;
  std::string text = "<td class=\"" + kind + "\"><details><summary><span class=\"v\">" + verdict +
                     "</span>" + (brief.empty() ? "" : " " + escape_markup(brief)) + "</summary>";
  return text + "<pre>" + escape_markup(story(*result)) + "</pre></details></td>";
}

}  // namespace

std::string summary(const SuiteResult& result) {
  std::string text;
  for (const Verdict verdict : kVerdicts) {
    if (const std::size_t count = result.count(verdict);
        count > 0 || verdict == Verdict::fail || verdict == Verdict::pass) {
      text += (text.empty() ? "" : ", ") + std::to_string(count) + " " + std::string(word(verdict));
    }
  }
  return text;
}

std::string text_line(const CaseResult& result) {
  std::string verdict(word(result.verdict));
  verdict.resize(15, ' ');
  std::string text = verdict + result.identity.id + "  " + result.identity.title + "\n";
  const std::string indent(15, ' ');
  switch (result.verdict) {
    case Verdict::fail:
    case Verdict::lenient:
      text += indent + "expected " + printable(result.expected, "\n\t") + "\n" + indent + "got " +
              printable(result.got, "\n\t") + "\n";
      break;
    case Verdict::error:
    case Verdict::not_reached:
    case Verdict::informational:
      text += indent + printable(result.got, "\n\t") + "\n";
      break;
    case Verdict::pass:
    case Verdict::not_applicable:
    case Verdict::skipped:
      break;
  }
  return text;
}

nlohmann::json to_json(const SuiteResult& result) {
  nlohmann::json cases = nlohmann::json::array();
  for (const CaseResult& each : result.cases) {
    cases.push_back(to_json(each));
  }
  nlohmann::json counts;
  for (const Verdict verdict : kVerdicts) {
    counts[std::string(word(verdict))] = result.count(verdict);
  }
  return {{"suite", result.suite},
          {"endpoint", result.endpoint},
          {"profile_hash", result.profile_hash},
          {"counts", counts},
          {"cases", cases}};
}

SuiteResult from_json(const nlohmann::json& json) {
  try {
    SuiteResult result;
    result.suite = json.at("suite").get<std::string>();
    result.endpoint = json.at("endpoint").get<std::string>();
    result.profile_hash = json.at("profile_hash").get<std::string>();
    for (const nlohmann::json& each : json.at("cases")) {
      result.cases.push_back(case_of(each));
    }
    return result;
  } catch (const std::logic_error& wrong) {  // of std::stoul
    throw std::runtime_error(std::string("no hexadecimal bytes: ") + wrong.what());
  } catch (const nlohmann::json::exception& wrong) {
    throw std::runtime_error(wrong.what());
  }
}

// Writes one test suite per chapter. Cases that broke or ran out of time count as errors, skipped
// and not applicable ones as skipped; lenient and informational ones pass with their message in
// system-out.
std::string junit_text(const SuiteResult& result) {
  std::vector<std::string> chapters;
  std::map<std::string, std::vector<const CaseResult*>> in;
  for (const CaseResult& each : result.cases) {
    const std::string of = chapter(each.identity.id);
    if (in[of].empty()) {
      chapters.push_back(of);
    }
    in[of].push_back(&each);
  }
  std::string text = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites name=\"" +
                     escape_markup(result.suite + " " + result.endpoint) + "\">\n";
  for (const std::string& of : chapters) {
    const auto count = [&](Verdict verdict) {
      return std::to_string(std::ranges::count(
          in[of], verdict, [](const CaseResult* each) { return each->verdict; }));
    };
    const auto errors = std::ranges::count_if(in[of], [](const CaseResult* each) {
      return each->verdict == Verdict::error || each->verdict == Verdict::not_reached;
    });
    const auto skipped = std::ranges::count_if(in[of], [](const CaseResult* each) {
      return each->verdict == Verdict::skipped || each->verdict == Verdict::not_applicable;
    });
    text += "  <testsuite name=\"" + escape_markup(of) + "\" tests=\"" +
            std::to_string(in[of].size()) + "\" failures=\"" + count(Verdict::fail) +
            "\" errors=\"" + std::to_string(errors) + "\" skipped=\"" + std::to_string(skipped) +
            "\">\n    <properties><property name=\"endpoint\" value=\"" +
            escape_markup(result.endpoint) + "\"/><property name=\"profile\" value=\"" +
            escape_markup(result.profile_hash) + "\"/></properties>\n";
    for (const CaseResult* each : in[of]) {
      text += "    <testcase classname=\"" + escape_markup(of) + "\" name=\"" +
              escape_markup(each->identity.id + " " + each->identity.title) + "\">";
      const std::string message = escape_markup(
          each->expected.empty() ? each->got : "expected " + each->expected + ", got " + each->got);
      const std::string told = escape_markup(story(*each));
      switch (each->verdict) {
        case Verdict::fail:
          text += "<failure message=\"" + message + "\">" + told + "</failure>";
          break;
        case Verdict::error:
        case Verdict::not_reached:
          text += "<error message=\"" + message + "\">" + told + "</error>";
          break;
        case Verdict::skipped:
        case Verdict::not_applicable:
          text += "<skipped message=\"" + message + "\"/>";
          break;
        case Verdict::lenient:
        case Verdict::informational:
          text +=
              "<system-out>" + std::string(word(each->verdict)) + ": " + message + "</system-out>";
          break;
        case Verdict::pass:
          break;
      }
      text += "</testcase>\n";
    }
    text += "  </testsuite>\n";
  }
  return text + "</testsuites>\n";
}

std::string html_text(std::span<const SuiteResult> results) {
  // Rows in the order of the first that has them.
  std::vector<const CaseResult*> rows;
  std::vector<std::map<std::string, const CaseResult*>> columns(results.size());
  for (std::size_t i = 0; i < results.size(); ++i) {
    for (const CaseResult& each : results[i].cases) {
      const bool known = std::ranges::any_of(
          columns, [&](const auto& column) { return column.contains(each.identity.id); });
      columns[i][each.identity.id] = &each;
      if (!known) {
        rows.push_back(&each);
      }
    }
  }
  std::string text =
      "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width\">\n"
      "<title>Conformance</title>\n";
  text += kStyle;
  text += "\n<h1>Conformance</h1>\n";
  std::string table = "<table>\n<tr><th>Case</th><th>What is checked</th>";
  for (const SuiteResult& result : results) {
    table += "<th>" + escape_markup(result.suite + " " + result.endpoint) +
             "<br><span class=\"source\">" + escape_markup(summary(result)) + "</span></th>";
  }
  table += "</tr>\n";
  std::string failing;
  std::string before;
  for (const CaseResult* row : rows) {
    if (chapter(row->identity.id) != before) {
      before = chapter(row->identity.id);
      table += "<tr><td class=\"chapter\" colspan=\"" + std::to_string(results.size() + 2) + "\">" +
               escape_markup(before) + "</td></tr>\n";
    }
    const CaseResult* first = nullptr;
    bool differs = false;
    bool fails = false;
    std::string cells;
    for (const auto& column : columns) {
      const auto found = column.find(row->identity.id);
      const CaseResult* each = found == column.end() ? nullptr : found->second;
      cells += cell(each);
      differs = differs || (first != nullptr && each != nullptr && first->verdict != each->verdict);
      first = first == nullptr ? each : first;
      fails = fails || (each != nullptr &&
                        (each->verdict == Verdict::fail || each->verdict == Verdict::error ||
                         each->verdict == Verdict::not_reached));
    }
    const std::string id = escape_markup(row->identity.id);
    if (fails) {
      failing += " <a href=\"#" + id + "\">" + id + "</a>";
    }
    table += "<tr id=\"" + id + (differs ? "\" class=\"differs\">" : "\">");
    table += "<td class=\"id\">" + id + "</td><td class=\"title\">" +
             escape_markup(row->identity.title) + "<br><span class=\"source\">" +
             escape_markup(row->identity.source) + ", " +
             std::string(word(row->identity.strength)) + "</span></td>" + cells + "</tr>\n";
  }
  if (!failing.empty()) {
    text += "<p class=\"source\">Fails:" + failing + "</p>\n";
  }
  return text + table + "</table>\n</html>\n";
}

// Writes the steps of a case as packets, with their words as comments. UDP and TCP get IP heads
// with 127.0.0.1, TCP also a handshake, since only the payload was recorded.
std::vector<std::uint8_t> capture_of(const CaseResult& result, const Endpoint& endpoint) {
  namespace pcapng = protocols::pcapng;
  using Kind = Endpoint::Kind;
  std::vector<std::uint8_t> file;
  pcapng::append(
      file, pcapng::Section{"rigwire conform", result.identity.id + ": " + result.identity.title});
  const bool bus = endpoint.kind == Kind::can || endpoint.kind == Kind::slcan;
  const pcapng::LinkType link = endpoint.kind == Kind::serial ? pcapng::LinkType::rtac_serial
                                : bus                         ? pcapng::LinkType::socketcan
                                                              : pcapng::LinkType::ethernet;
  pcapng::append(file, pcapng::Interface{link, "device", ""});
  constexpr std::uint32_t kLoopback = 0x7F00'0001;
  constexpr std::uint16_t kClientPort = 49'152;
  pcapng::TcpConversation tcp({kLoopback, kClientPort}, {kLoopback, endpoint.port});
  using Side = pcapng::TcpConversation::Side;
  std::uint64_t at = 0;
  const auto put = [&](bool sent, std::span<const std::uint8_t> bytes, std::string_view comment) {
    pcapng::Packet packet;
    packet.time_ns = at;
    packet.bytes = bytes;
    packet.direction = sent ? pcapng::Direction::inbound : pcapng::Direction::outbound;
    packet.comment = comment;
    pcapng::append(file, packet);
  };
  if (endpoint.kind == Kind::tcp) {
    tcp.open([&](Side from, std::span<const std::uint8_t> bytes) {
      put(from == Side::client, bytes, "");
    });
  }
  for (const Step& step : result.steps) {
    if (step.kind == Step::Kind::note || step.bytes.empty()) {
      continue;
    }
    at = static_cast<std::uint64_t>(step.at.count());
    const bool sent = step.kind == Step::Kind::sent;
    std::vector<std::uint8_t> packet;
    switch (endpoint.kind) {
      case Kind::serial:
        pcapng::append_serial(packet, at,
                              sent ? pcapng::Direction::inbound : pcapng::Direction::outbound,
                              step.bytes);
        put(sent, packet, step.words);
        break;
      case Kind::can:
      case Kind::slcan:
        put(sent, step.bytes, step.words);
        break;
      case Kind::udp:
        pcapng::append_udp(packet, {kLoopback, kClientPort}, {kLoopback, endpoint.port},
                           step.bytes);
        put(sent, packet, step.words);
        break;
      case Kind::tcp:
        tcp.data(sent ? Side::client : Side::server, step.bytes,
                 [&](Side, std::span<const std::uint8_t> bytes) { put(sent, bytes, step.words); });
        break;
    }
  }
  return file;
}

}  // namespace rigwire::conform
