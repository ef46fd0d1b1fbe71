#include "bench/machine_precision_json.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "bench/table.h"

namespace rigwire::bench {
namespace {

nlohmann::json row_json(const MachinePrecisionRow& row) {
  nlohmann::json json{{"method", row.method}, {"step_s", row.step_s}};
  if (!row.refusal.empty()) {
    json["refusal"] = row.refusal;
    return json;
  }
  json["diverged"] = row.diverged;
  json["final_error_m"] = number_or_null(row.final_error_m);
  json["greatest_error_m"] = number_or_null(row.greatest_error_m);
  json["us_per_step"] = row.microseconds_per_step;
  return json;
}

}  // namespace

nlohmann::json precision_json(const MachineCase& of, const MachinePrecision& found) {
  nlohmann::json json{{"machine", of.machine},
                      {"level", of.level},
                      {"scene", of.scene},
                      {"stiffness_factor", of.stiffness_factor},
                      {"span_s", to_seconds(of.span)},
                      {"gap_m", number_or_null(found.reference_gap_m)},
                      {"order", nlohmann::json::object()},
                      {"rows", nlohmann::json::array()}};
  for (const StepMethod& method : kMachineMethods) {
    json["order"][method.name] =
        number_or_null(measured_order(found, method.name).value_or(std::nan("")));
  }
  for (const MachinePrecisionRow& row : found.rows) {
    json["rows"].push_back(row_json(row));
  }
  return json;
}

}  // namespace rigwire::bench
