#include "hil/control/shown_recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

#include "drivers/listener.h"
#include "fields/visitor.h"
#include "hil/control/rerun.h"
#include "hil/control/showing.h"
#include "hil/record/run_log.h"

namespace rigwire::hil {

int show_recording(const std::filesystem::path& folder, RunOptions options, SimTime from) {
  options.dashboard = true;
  if (options.control_token.empty()) {
    options.control_token = fresh_token();
  }
  Rerun rerun(folder);
  if (from > rerun.end()) {
    throw std::invalid_argument(
        fmt::format("--from: found {}, allowed up to the recording's end at {}",
                    fields::print_duration((from - kStart).count()),
                    fields::print_duration((rerun.end() - kStart).count())));
  }
  {
    RunLog log(options.log_level);
    for (const std::string& remark : rerun.remarks()) {
      log.warning(remark);
    }
  }
  // The port stays this program's while a run ends to begin again further back.
  const auto kept = std::make_shared<drivers::KeptListener>();
  options.page.kept = kept;
  if (options.control && options.control->path.empty()) {
    options.control->kept = kept;
  }
  Showing showing(rerun);
  options.shown = &showing;
  Showing::Course course{.from = from, .factor = options.clock.factor};
  while (true) {
    showing.begin(course);
    options.clock = {course.factor == 1.0 ? ClockMode::Kind::real : ClockMode::Kind::scaled,
                     course.factor};
    const int code = run(rerun.configuration(), options);
    if (!showing.again() || code != static_cast<int>(ExitCode::done)) {
      return code;
    }
    course = *showing.again();
    // Viewers will look for the page at this address again.
    const auto here = parse_control_endpoint(showing.address());
    options.page = here.value_or(options.page);
    options.page.kept = kept;
    if (options.control && options.control->path.empty()) {
      options.control = options.page;
    }
    // The starting program and the log have been notified once.
    options.ready_descriptor.reset();
    options.log_level = std::max(options.log_level, LogLevel::warning);
  }
}

}  // namespace rigwire::hil
