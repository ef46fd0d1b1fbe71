#include "hil/rig/rig_faults.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "hil/configuration/plain_text.h"
#include "hil/configuration/suggest.h"
#include "hil/world/quantities.h"

namespace rigwire::hil {

void RigFaults::add(const std::string& where, FaultPort& port) {
  ports_.push_back({where, &port});
  for (const auto& [id, window] : port.list()) {
    enter(ports_.size() - 1, id);
  }
}

void RigFaults::enter(std::size_t port, FaultPort::Id id) {
  wait_for(port, id, last_id_ + 1);
  entries_.push_back({++last_id_, port, id});
}

void RigFaults::wait_for(std::size_t port, FaultPort::Id id, Id number) {
  for (const FaultPort::Waiting& waiting : ports_[port].port->waiting()) {
    if (waiting.id == id) {
      waits_.push_back({number, quantity(waiting.condition.quantity), waiting.condition.above,
                        waiting.condition.value, waiting.from});
    }
  }
}

std::size_t RigFaults::quantity(const std::string& name) const {
  const auto found = find_quantity(quantities_, name);
  if (!found) {
    throw NoSuchFault("the machine has no such quantity", "fault.when.quantity", printable(name),
                      allowed_quantities(quantities_, name));
  }
  return *found;
}

void RigFaults::look(SimTime now, SimTime instant, std::span<const double> state) {
  const auto met = [&](const Wait& wait) {
    const double value = state[wait.quantity];
    return wait.from <= instant && (wait.above ? value > wait.value : value < wait.value);
  };
  for (std::size_t i = 0; i < waits_.size();) {
    if (!met(waits_[i])) {
      ++i;
      continue;
    }
    const Id number = waits_[i].number;
    waits_.erase(waits_.begin() + static_cast<std::ptrdiff_t>(i));
    Entry& entry = *std::ranges::lower_bound(entries_, number, {}, &Entry::number);
    if (const auto id = ports_[entry.port].port->meet(entry.id, now, instant)) {
      entry.id = *id;
      const std::vector<Numbered> all = list();
      listener_(std::ranges::lower_bound(all, number, {}, &Numbered::id)->window);
    }
  }
}

/// Removes the entries of faults that the ports have forgotten.
void RigFaults::forget() {
  if (entries_.size() < kKept) {
    return;
  }
  const std::vector<Numbered> known = list();
  std::erase_if(entries_, [&](const Entry& entry) {
    return !std::ranges::binary_search(known, entry.number, {}, &Numbered::id);
  });
}

std::vector<RigFaults::Target> RigFaults::targets() const {
  std::vector<Target> targets;
  for (const Port& port : ports_) {
    if (targets.empty() || targets.back().name != port.where) {
      targets.push_back({port.where, {}});
    }
    std::vector<fields::Named>& kinds = targets.back().kinds;
    const std::vector<fields::Named> more = port.port->kinds();
    kinds.insert(kinds.end(), more.begin(), more.end());
  }
  return targets;
}

std::vector<RigFaults::Numbered> RigFaults::list() const {
  std::vector<std::vector<std::pair<FaultPort::Id, FaultWindow>>> of_port;
  for (const Port& port : ports_) {
    of_port.push_back(port.port->list());
  }
  std::vector<Numbered> all;
  for (const Entry& entry : entries_) {
    const auto& list = of_port[entry.port];
    const auto found =
        std::ranges::lower_bound(list, entry.id, {}, [](const auto& one) { return one.first; });
    if (found != list.end() && found->first == entry.id) {
      all.push_back({entry.number, found->second});
      all.back().window.where = ports_[entry.port].where;
    }
  }
  return all;
}

std::vector<FaultWindow> RigFaults::windows() const {
  std::vector<FaultWindow> all;
  for (const Numbered& fault : list()) {
    all.push_back(fault.window);
  }
  return all;
}

std::optional<RigFaults::Numbered> RigFaults::begin(SimTime now, const std::string& where,
                                                    const std::string& type,
                                                    const FaultPort::Fill& fill) {
  const std::vector<Target> all = targets();
  const auto target = std::ranges::find(all, where, &Target::name);
  if (target == all.end()) {
    std::vector<std::string> names;
    std::ranges::transform(all, std::back_inserter(names), &Target::name);
    throw NoSuchFault("nothing of that name can have faults", "on", printable(where),
                      join_words(names));
  }
  const auto has = [&](const Port& port) {
    return port.where == where &&
           std::ranges::count(port.port->kinds(), type, &fields::Named::name) > 0;
  };
  const auto port = std::ranges::find_if(ports_, has);
  if (port == ports_.end()) {
    std::vector<std::string> names;
    for (const fields::Named& kind : target->kinds) {
      names.emplace_back(kind.name);
    }
    throw NoSuchFault(where + " cannot have such a fault", "fault.type", printable(type),
                      join_words(names));
  }
  const auto stream_of = [&](const std::string& name, Duration at) {
    return fault_stream(seed_, where, name, at);
  };
  const auto id = port->port->begin(now, fill, stream_of);
  if (!id) {
    return std::nullopt;
  }
  forget();
  try {
    enter(static_cast<std::size_t>(port - ports_.begin()), *id);
  } catch (const NoSuchFault&) {
    port->port->end(*id, now);
    throw;
  }
  Numbered begun = list().back();
  listener_(begun.window);
  return begun;
}

RigFaults::Numbered RigFaults::end(SimTime now, Id id) {
  const auto entry = std::ranges::lower_bound(entries_, id, {}, &Entry::number);
  const bool known = entry != entries_.end() && entry->number == id;
  if (!known || !ports_[entry->port].port->end(entry->id, now)) {
    const bool was = known || (id >= 1 && id <= last_id_);
    throw NoSuchFault(was ? "that fault is over" : "there is no fault of that number", "id",
                      std::to_string(id), "a number of fault_list whose fault is not over");
  }
  std::erase_if(waits_, [id](const Wait& wait) { return wait.number == id; });
  const std::vector<Numbered> all = list();
  Numbered ended = *std::ranges::lower_bound(all, id, {}, &Numbered::id);
  listener_(ended.window);
  return ended;
}

}  // namespace rigwire::hil
