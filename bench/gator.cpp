#include "bench/gator.h"

#include <algorithm>
#include <stdexcept>
#include <vector>

#include "hil/command_line/config_files.h"
#include "hil/configuration/document.h"
#include "hil/configuration/reader.h"
#include "hil/world/machine_types.h"

namespace rigwire::bench {
namespace {

Gator read_gator() {
  const std::vector<hil::ConfigFile> files = hil::config_files("machines");
  const auto file = std::ranges::find(files, "gator_855d", &hil::ConfigFile::name);
  hil::Problems problems;
  hil::Origins origins;
  hil::MachineConfiguration machine;
  hil::read(
      hil::load_document(file == files.end() ? "machines/gator_855d.yaml" : file->path, problems),
      machine, problems, origins);
  problems.throw_if_any();
  const auto* gator = fields::as<hil::WheeledMachine>(machine.model);
  if (gator == nullptr) {
    throw std::runtime_error(file->path + ": found another type, allowed wheeled");
  }
  return {gator->wheeled, gator->driveline};
}

}  // namespace

const Gator& gator_855d() {
  static const Gator gator = read_gator();
  return gator;
}

}  // namespace rigwire::bench
