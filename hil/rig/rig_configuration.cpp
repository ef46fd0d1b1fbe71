#include "hil/rig/rig_configuration.h"

#include "hil/configuration/document.h"
#include "hil/configuration/reader.h"

namespace rigwire::hil {

LoadedRig load_rig(const std::string& file, const std::vector<std::string>& sets) {
  Problems problems;
  Value document = load_document(file, problems);
  for (const std::string& set : sets) {
    apply_set(document, set, problems);
  }
  LoadedRig rig;
  // A file that cannot be read at all would only be followed by complaints about missing keys.
  if (problems.empty() || !document.entries.empty()) {
    read(document, rig.configuration, problems, rig.origins);
  }
  check_rig(rig.configuration, rig.origins, problems);
  problems.throw_if_any();
  return rig;
}

std::string config_hash(const RigConfiguration& configuration) {
  return hash_text(outline(configuration));
}

std::string print_rig(const LoadedRig& rig) {
  return print_yaml(outline(rig.configuration), rig.origins);
}

}  // namespace rigwire::hil
