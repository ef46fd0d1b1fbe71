#include "hil/rig/rig_faults.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "hil/configuration/plain_text.h"
#include "hil/configuration/suggest.h"

namespace rigwire::hil {

void RigFaults::add(const std::string& where, FaultPort& port) {
  for (const auto& [id, window] : port.list()) {
    entries_.push_back({ports_.size(), id});
  }
  ports_.push_back({where, &port});
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
    all.push_back({static_cast<Id>(all.size() + 1), found->second});
    all.back().window.where = ports_[entry.port].where;
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
  const auto id = port->port->begin(now, fill);
  if (!id) {
    return std::nullopt;
  }
  entries_.push_back({static_cast<std::size_t>(port - ports_.begin()), *id});
  Numbered begun = list().back();
  listener_(begun.window);
  return begun;
}

RigFaults::Numbered RigFaults::end(SimTime now, Id id) {
  const bool known = id >= 1 && id <= entries_.size();
  if (!known || !ports_[entries_[id - 1].port].port->end(entries_[id - 1].id, now)) {
    throw NoSuchFault(known ? "that fault is over" : "there is no fault of that number", "id",
                      std::to_string(id), "one of those that fault_list tells, and not over");
  }
  Numbered ended = list()[id - 1];
  listener_(ended.window);
  return ended;
}

}  // namespace rigwire::hil
