#include "conform/conformance_case.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "conform/endpoint.h"
#include "conform/reports.h"
#include "conform/trial.h"
#include "protocols/pcapng/pcapng.h"

namespace rigwire::conform {
namespace {

TEST(ConformanceCase, IsWantedByItsIdentityOrItsBeginAtASlash) {
  EXPECT_TRUE(is_wanted("modbus/6.3/1", {}));
  EXPECT_TRUE(is_wanted("modbus/6.3/1", {"modbus"}));
  EXPECT_TRUE(is_wanted("modbus/6.3/1", {"x", "modbus/6.3"}));
  EXPECT_TRUE(is_wanted("modbus/6.3/1", {"modbus/6.3/"}));
  EXPECT_FALSE(is_wanted("modbus/6.3/10", {"modbus/6.3/1"}));
  EXPECT_FALSE(is_wanted("modbus/6.12/1", {"modbus/6.1"}));
}

TEST(ConformanceCase, EndpointsAreReadOrNone) {
  const auto text = [](const std::string& written) {
    const auto endpoint = parse_endpoint(written, {502, 9600});
    return endpoint ? endpoint->text() : "";
  };
  EXPECT_EQ(text("tcp:127.0.0.1"), "tcp:127.0.0.1:502");
  EXPECT_EQ(text("tcp:127.0.0.1:1502"), "tcp:127.0.0.1:1502");
  EXPECT_EQ(text("tcp:[::1]:1502"), "tcp:[::1]:1502");
  EXPECT_EQ(text("tcp:[::1]"), "tcp:[::1]:502");
  EXPECT_EQ(text("serial:/dev/ttyS0"), "serial:/dev/ttyS0@9600");
  EXPECT_EQ(text("serial:/dev/ttyS0@115200"), "serial:/dev/ttyS0@115200");
  EXPECT_EQ(text("can:can0"), "can:can0");
  EXPECT_EQ(text("slcan:/dev/ttyACM0@250000"), "slcan:/dev/ttyACM0@250000");
  EXPECT_EQ(text("slcan:/dev/ttyACM0"), "slcan:/dev/ttyACM0@9600");
  EXPECT_EQ(text("udp:2368"), "udp:2368");
  EXPECT_EQ(text("udp:"), "udp:502");
  EXPECT_EQ(text("udp:127.0.0.1:2368"), "udp:127.0.0.1:2368");
  for (const char* wrong : {"", "tcp", "tcp:", "can:", "slcan:@250000", "usb:1", "udp:70000",
                            "tcp:1.2.3.4:", "tcp:1.2.3.4:0", "tcp:1.2.3.4:70000", "tcp:[::1",
                            "serial:", "serial:@9600", "serial:/dev/x@", "serial:/dev/x@fast"}) {
    const std::string found = text(wrong);
    EXPECT_TRUE(found.empty() || found == "tcp:1.2.3.4:502") << wrong << ": " << found;
  }
}

CaseIdentity identity(Strength strength) {
  return {"suite/1/1", "A title with <marks> & \"quotes\"", "A document, 1", strength,
          Danger::none};
}

TEST(Trial, TheFirstThatDoesNotHoldDecidesAsStrongAsTheCaseIs) {
  for (const auto& [strength, verdict] :
       {std::pair{Strength::must, Verdict::fail}, std::pair{Strength::should, Verdict::lenient},
        std::pair{Strength::observed, Verdict::informational}}) {
    Trial trial(identity(strength));
    EXPECT_TRUE(trial.expect(true, "one", "two"));
    EXPECT_FALSE(trial.expect(false, "three", "four"));
    EXPECT_FALSE(trial.expect(false, "five", "six"));
    const CaseResult result = trial.result();
    EXPECT_EQ(result.verdict, verdict);
    EXPECT_EQ(result.expected, "three");
    EXPECT_EQ(result.got, "four");
  }
  Trial framed(identity(Strength::observed));
  framed.demand(false, "a frame", "none");
  EXPECT_EQ(framed.result().verdict, Verdict::fail);
}

SuiteResult some_result() {
  Trial trial(identity(Strength::must));
  trial.sent(std::array<std::uint8_t, 3>{0x00, 0x7F, 0xFF}, "a request");
  trial.received(std::array<std::uint8_t, 1>{0x42}, "an answer");
  trial.note("and a word");
  trial.expect(false, "a < b", "a & b");
  SuiteResult result{"suite", "tcp:127.0.0.1:1", "0123", {trial.result()}};
  result.cases.push_back({identity(Strength::should), Verdict::skipped, "", "not asked for", {}});
  result.cases.back().identity.id = "suite/2/1";
  return result;
}

TEST(Reports, JsonReadsBackAsItWas) {
  const SuiteResult result = some_result();
  const nlohmann::json json = to_json(result);
  EXPECT_EQ(to_json(from_json(nlohmann::json::parse(json.dump()))), json);
  EXPECT_EQ(json.at("counts").at("fail"), 1);
  EXPECT_THROW(static_cast<void>(from_json(nlohmann::json::object())), std::runtime_error);
  nlohmann::json strange = json;
  strange["cases"][0]["verdict"] = "splendid";
  EXPECT_THROW(static_cast<void>(from_json(strange)), std::runtime_error);
}

TEST(Reports, MarkupIsEscaped) {
  const std::array<SuiteResult, 2> results{some_result(), some_result()};
  for (const std::string& text : {junit_text(results[0]), html_text(results)}) {
    EXPECT_EQ(text.find("<marks>"), std::string::npos);
    EXPECT_EQ(text.find("a < b"), std::string::npos);
    EXPECT_NE(text.find("a &lt; b"), std::string::npos);
  }
}

TEST(Reports, ThePageLeadsToWhatFails) {
  const std::array<SuiteResult, 1> results{some_result()};
  const std::string page = html_text(results);
  std::size_t failures = 0;
  for (const CaseResult& each : results[0].cases) {
    const std::string& id = each.identity.id;
    const bool leads = page.find("<a href=\"#" + id + "\">") != std::string::npos;
    EXPECT_EQ(leads, each.verdict == Verdict::fail || each.verdict == Verdict::error) << id;
    EXPECT_NE(page.find("<tr id=\"" + id + "\""), std::string::npos) << id;
    failures += leads ? 1 : 0;
  }
  EXPECT_EQ(failures, 1U);
}

TEST(Reports, ACaptureHasEveryByteThatWentOver) {
  namespace pcapng = protocols::pcapng;
  using Kind = Endpoint::Kind;
  // A TCP connection has the three packets of its handshake, too.
  for (const auto& [kind, expected] : {std::pair{Kind::tcp, 3U + 2U}, std::pair{Kind::serial, 2U},
                                       std::pair{Kind::slcan, 2U}, std::pair{Kind::udp, 2U}}) {
    const auto file = capture_of(some_result().cases[0], {kind, "", 1502});
    pcapng::Reader reader;
    std::size_t packets = 0;
    for (std::span<const std::uint8_t> rest(file); !rest.empty();) {
      const auto block = reader.next(rest);
      ASSERT_TRUE(block.ok());
      packets += std::holds_alternative<pcapng::Packet>(*block) ? 1 : 0;
      rest = rest.subspan(block.consumed());
    }
    EXPECT_EQ(packets, expected);
  }
}

}  // namespace
}  // namespace rigwire::conform
