#include "sim/samples/fault_book.h"

namespace rigwire {
namespace {

void visit_begin(fields::Visitor& v, FaultPeriod& p) {
  v.required("at");
  v.duration("at", p.at, {0, fields::kYear_ns}, "When it begins, from the start of the run.");
}

}  // namespace

void visit(fields::Visitor& v, FaultPeriod& p) {
  visit_begin(v, p);
  Duration length = p.length.value_or(Duration{fields::kYear_ns});
  v.duration("for", length, {1, fields::kYear_ns}, "How long the fault lasts.");
  p.length = length;
}

void visit_open_ended(fields::Visitor& v, FaultPeriod& p) {
  visit_begin(v, p);
  Duration length = p.length.value_or(Duration{0});
  v.duration("for", length, {0, fields::kYear_ns}, "How long it lasts; 0 = to the end of the run.");
  p.length = length == Duration{0} ? std::nullopt : std::optional(length);
}

}  // namespace rigwire
