// The quantities of a machine by name: the one list behind `read`, `wait`, `when` of faults,
// criteria of campaigns, plots of the page and the Python client.
//
// A quantity has the name and the unit of the machine's status table ("boom", deg). Machines that
// can strike obstacles have `contact`, the force of all contacts in kN, besides. docs/control.md
// has the table of all machines.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hil/executive/truth_source.h"
#include "sim/machine.h"

namespace rigwire::hil {

/// Names and units of what read_state() writes, in its order.
[[nodiscard]] std::vector<StateQuantity> state_quantities(const sim::Machine& machine);

/// Writes the present value of each quantity, in the order and the units of state_quantities().
/// `values` has one place for each.
void read_state(const sim::Machine& machine, std::span<double> values);

/// Returns the place of the quantity of that name; nothing when there is none.
[[nodiscard]] std::optional<std::size_t> find_quantity(std::span<const StateQuantity> quantities,
                                                       std::string_view name);

/// Returns "swing (deg), boom (deg), tip height (m)" for messages.
[[nodiscard]] std::string list_quantities(std::span<const StateQuantity> quantities);

/// Returns what a message says to a name that is no quantity: list_quantities() and, where one of
/// them is near, ", did you mean boom?".
[[nodiscard]] std::string allowed_quantities(std::span<const StateQuantity> quantities,
                                             std::string_view name);

}  // namespace rigwire::hil
