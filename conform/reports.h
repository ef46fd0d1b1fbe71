// What people and programs read of a suite's result. JSON is the source; the others say the same.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

#include "conform/conformance_case.h"
#include "conform/endpoint.h"

namespace rigwire::conform {

/// "0 failed, 1 lenient, 97 passed, ...".
[[nodiscard]] std::string summary(const SuiteResult& result);

/// A line per case, "pass  modbus/6.3/1  title", and under what did not pass what was expected and
/// seen.
[[nodiscard]] std::string text_line(const CaseResult& result);

[[nodiscard]] nlohmann::json to_json(const SuiteResult& result);
/// Throws std::runtime_error with what is missing.
[[nodiscard]] SuiteResult from_json(const nlohmann::json& json);

/// JUnit XML: a suite per chapter (modbus/6.3), a case per identity.
[[nodiscard]] std::string junit_text(const SuiteResult& result);

/// One page of several endpoints beside each other, a row per case, the exchanges folded away.
[[nodiscard]] std::string html_text(std::span<const SuiteResult> results);

/// Returns a pcapng file of one case: the bytes of a serial line, frames of a bus, datagrams, or a
/// TCP conversation. IP addresses and TCP handshakes are made up.
[[nodiscard]] std::vector<std::uint8_t> capture_of(const CaseResult& result,
                                                   const Endpoint& endpoint);

}  // namespace rigwire::conform
