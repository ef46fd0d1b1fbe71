#include "conform/suite_options.h"

namespace rigwire::conform {

std::optional<CaseResult> hindrance(const CaseIdentity& identity, const std::string& missing,
                                    const SuiteOptions& options) {
  if (!missing.empty()) {
    return CaseResult{identity, Verdict::not_applicable, "", missing, {}};
  }
  if (identity.danger == Danger::writes && !options.writes) {
    return CaseResult{identity, Verdict::skipped, "", "it writes; asked for by --writes", {}};
  }
  if (identity.danger == Danger::moves && !options.moves) {
    return CaseResult{identity,
                      Verdict::skipped,
                      "",
                      "a machine may move, or the device be lost; asked for by --moves ENDPOINT",
                      {}};
  }
  if (identity.id.find("/robustness/") != std::string::npos && !options.robustness) {
    return CaseResult{
        identity, Verdict::skipped, "", "no conformance; asked for by --robustness", {}};
  }
  return std::nullopt;
}

}  // namespace rigwire::conform
