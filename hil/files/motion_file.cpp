#include "hil/files/motion_file.h"

#include "hil/configuration/outside_file.h"
#include "hil/files/mcap_file.h"
#include "hil/files/motion_contents.h"
#include "hil/files/motion_csv.h"
#include "hil/files/motion_mcap.h"

namespace rigwire::hil {

void visit(fields::Visitor& v, MotionSettings& p) {
  static constexpr fields::DurationRule kSpan{0, 1'000'000'000'000'000};
  v.file("file", p.file, fields::FileKind::motion,
         "Recorded motion (truth.mcap of a recording, MCAP or CSV of poses) that the machine makes "
         "in place of its own; empty = none.");
  v.only_if(!p.file.empty(), "file", "a file: the machine moves itself", [&p](fields::Visitor& w) {
    w.text("frame", p.frame,
           "What the file calls the machine's first link; empty = as the machine does.");
    w.duration("start", p.start, kSpan, "Where the piece begins, from the file's zero.");
    w.duration("offset", p.offset, kSpan, "From the start of the run to the piece's.");
    w.duration(
        "smoothing", p.smoothing, fields::DurationRule{0, 10'000'000'000},
        "Standard deviation of the window that poses without accelerations are averaged over; "
        "0 = as they are.");
  });
}

sim::MachineRecord read_motion(const MotionSettings& settings, sim::Machine& model,
                               const sim::LocalFrame& frame) {
  MotionContents contents(settings, model);
  try {
    if (is_mcap(settings.file)) {
      read_mcap_motion(settings, contents);
    } else {
      read_csv_motion(settings, contents, model, frame);
    }
  } catch (const FileRefused& refused) {
    refuse_motion(settings.file, refused.rest());
  }
  return contents.record();
}

}  // namespace rigwire::hil
