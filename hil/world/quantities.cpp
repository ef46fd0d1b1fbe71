#include "hil/world/quantities.h"

#include <algorithm>

#include "hil/configuration/suggest.h"

namespace rigwire::hil {

std::vector<StateQuantity> state_quantities(const sim::Machine& machine) {
  std::vector<StateQuantity> quantities;
  for (const sim::StatusQuantity& quantity : machine.status_quantities()) {
    quantities.push_back({std::string(quantity.name), std::string(quantity.unit)});
  }
  if (machine.contact_report() != nullptr) {
    quantities.push_back({"contact", "kN"});
  }
  return quantities;
}

void read_state(const sim::Machine& machine, std::span<double> values) {
  const std::size_t own = machine.status_quantities().size();
  machine.read_status(values.first(own));
  if (const sim::ContactReport* report = machine.contact_report()) {
    values[own] = 1e-3 * report->force_n;
  }
}

std::optional<std::size_t> find_quantity(std::span<const StateQuantity> quantities,
                                         std::string_view name) {
  const auto found = std::ranges::find(quantities, name, &StateQuantity::name);
  return found == quantities.end()
             ? std::nullopt
             : std::optional(static_cast<std::size_t>(found - quantities.begin()));
}

std::string list_quantities(std::span<const StateQuantity> quantities) {
  std::string text;
  for (const StateQuantity& quantity : quantities) {
    text += (text.empty() ? "" : ", ") + quantity.name;
    text += quantity.unit.empty() ? "" : " (" + quantity.unit + ")";
  }
  return text;
}

std::string allowed_quantities(std::span<const StateQuantity> quantities, std::string_view name) {
  std::vector<std::string> names;
  for (const StateQuantity& quantity : quantities) {
    names.push_back(quantity.name);
  }
  const std::string near = nearest_word(name, names);
  return list_quantities(quantities) + (near.empty() ? "" : ", did you mean " + near + "?");
}

}  // namespace rigwire::hil
