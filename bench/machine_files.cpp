#include "bench/machine_files.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "hil/command_line/config_files.h"
#include "hil/configuration/document.h"
#include "hil/configuration/reader.h"
#include "hil/world/machine_types.h"

namespace rigwire::bench {
namespace {

/// The model of the machine in configs/machines/NAME.yaml.
template <class Model>
Model read_model(std::string_view name) {
  const std::vector<hil::ConfigFile> files = hil::config_files("machines");
  const auto file = std::ranges::find(files, name, &hil::ConfigFile::name);
  const std::string path =
      file == files.end() ? "machines/" + std::string(name) + ".yaml" : file->path;
  hil::Problems problems;
  hil::Origins origins;
  hil::MachineConfiguration machine;
  hil::read(hil::load_document(path, problems), machine, problems, origins);
  problems.throw_if_any();
  const auto* model = fields::as<Model>(machine.model);
  if (model == nullptr) {
    throw std::runtime_error(path + ": found a machine of another type");
  }
  return *model;
}

}  // namespace

const Gator& gator_855d() {
  static const Gator gator = [] {
    const auto model = read_model<hil::WheeledMachine>("gator_855d");
    return Gator{model.wheeled, model.driveline};
  }();
  return gator;
}

const sim::ExcavatorParameters& excavator_ref18t() {
  static const sim::ExcavatorParameters parameters =
      read_model<hil::ExcavatorMachine>("excavator_ref18t").excavator;
  return parameters;
}

}  // namespace rigwire::bench
