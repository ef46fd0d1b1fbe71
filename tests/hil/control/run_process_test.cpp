// `rigwire run` as a process, and those who read what it says: they stall, close, go away, or look
// on through a narrow window.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pty.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "child_process.h"
#include "drivers/descriptor.h"
#include "file_text.h"
#include "screen.h"

namespace rigwire {
namespace {

using namespace std::chrono_literals;
using drivers::Descriptor;
using test::ChildProcess;
using test::eventually;
using test::text_of;
using testing::HasSubstr;
using testing::Not;

namespace fs = std::filesystem;

class RunProcess : public testing::Test {
 protected:
  RunProcess() {
    std::string pattern = "/tmp/rigwire-test-XXXXXX";
    if (::mkdtemp(pattern.data()) == nullptr) {
      throw std::runtime_error("no folder");
    }
    folder_ = pattern;
    std::ofstream(file("rig.yaml")) << "name: small\n"
                                       "machine: {type: excavator}\n"
                                       "devices:\n"
                                       "  gnss:\n"
                                       "    type: ublox-neo-7p\n"
                                       "    path: " +
                                           file("gnss").string() +
                                           "\n"
                                           "    faults: [{type: jamming, at: 0 s, for: 1000 s}]\n"
                                           "status: {period: 50 ms}\n";
  }
  ~RunProcess() override { fs::remove_all(folder_); }

  [[nodiscard]] fs::path file(const std::string& name) const { return folder_ / name; }
  [[nodiscard]] std::vector<std::string> command(const std::vector<std::string>& more) const {
    std::vector<std::string> words{RIGWIRE_BINARY_DIR "/rigwire", "run", file("rig.yaml").string()};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  [[nodiscard]] bool line_is_there() const { return fs::is_symlink(file("gnss")); }
  /// A report that is whole, and no link or temporary file left.
  void expect_clean_end_with_report() const {
    EXPECT_FALSE(line_is_there());
    const auto report = nlohmann::json::parse(text_of(file("report.json")), nullptr, false);
    EXPECT_FALSE(report.is_discarded());
    for (const auto& entry : fs::directory_iterator(folder_)) {
      EXPECT_THAT(entry.path().string(), Not(HasSubstr(".tmp")));
    }
  }
  [[nodiscard]] std::string report() const { return file("report.json").string(); }

 private:
  fs::path folder_;
};

struct Pipe {
  Pipe() {
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) {
      throw std::runtime_error("no pipe");
    }
    reader.emplace(ends[0]);
    writer.emplace(ends[1]);
  }
  /// Fills the pipe until it takes no more.
  void fill() const {
    ::fcntl(writer->get(), F_SETFL, O_NONBLOCK);
    const std::array<char, 4096> junk{};
    while (::write(writer->get(), junk.data(), junk.size()) > 0) {
    }
    ::fcntl(writer->get(), F_SETFL, 0);
  }
  std::optional<Descriptor> reader;
  std::optional<Descriptor> writer;
};

TEST_F(RunProcess, a_reader_that_stalls_does_not_keep_a_signal_from_ending_the_run) {
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
    const Pipe pipe;
    pipe.fill();
    ChildProcess rig(command({"--report", report(), "--status", "plain"}), file("err"),
                     pipe.writer->get());
    ASSERT_TRUE(eventually([&] { return line_is_there(); })) << rig.output();
    rig.signal(number);
    EXPECT_EQ(rig.wait(20s), 128 + number) << rig.output();
    expect_clean_end_with_report();
  }
}

TEST_F(RunProcess, a_reader_that_stalls_does_not_keep_a_run_from_its_end) {
  const Pipe pipe;
  pipe.fill();
  ChildProcess rig(command({"--report", report(), "--duration", "1s", "--status", "live"}),
                   file("err"), pipe.writer->get());
  EXPECT_EQ(rig.wait(40s), 0) << rig.output();
  EXPECT_THAT(rig.output(), HasSubstr("the summary is left out"));
  expect_clean_end_with_report();
  EXPECT_EQ(::fcntl(pipe.writer->get(), F_GETFL) & O_NONBLOCK, 0) << "others share the pipe";
}

TEST_F(RunProcess, a_reader_of_standard_error_that_stalls_holds_nothing_up) {
  const Pipe pipe;
  pipe.fill();
  const std::string shell = "exec \"$@\" 2>&1 >/dev/null";
  std::vector<std::string> words{"/bin/sh", "-c", shell, "sh"};
  for (const std::string& word : command({"--report", report()})) {
    words.push_back(word);
  }
  ChildProcess rig(words, file("err"), pipe.writer->get());
  ASSERT_TRUE(eventually([&] { return line_is_there(); }));
  rig.signal(SIGINT);
  EXPECT_EQ(rig.wait(20s), 130);
  expect_clean_end_with_report();
}

TEST_F(RunProcess, a_reader_that_closes_ends_the_run_cleanly) {
  Pipe pipe;
  ChildProcess rig(command({"--report", report()}), file("err"), pipe.writer->get());
  pipe.writer.reset();
  char byte = 0;
  ASSERT_EQ(::read(pipe.reader->get(), &byte, 1), 1);
  pipe.reader.reset();  // `| head -1`
  EXPECT_EQ(rig.wait(20s), 128 + SIGPIPE) << rig.output();
  expect_clean_end_with_report();
}

TEST_F(RunProcess, a_full_disk_under_standard_output_is_said_and_the_run_goes_on) {
  const Descriptor full(::open("/dev/full", O_WRONLY | O_CLOEXEC));
  ChildProcess rig(command({"--report", report(), "--duration", "2s"}), file("err"), full.get());
  EXPECT_EQ(rig.wait(40s), 1) << rig.output();
  EXPECT_THAT(rig.output(), HasSubstr("standard output is not complete: No space left on device"));
  expect_clean_end_with_report();
  EXPECT_GE(nlohmann::json::parse(text_of(report()))["sim_s"], 2.0);
}

TEST_F(RunProcess, a_full_disk_under_the_truth_is_said_and_the_run_goes_on) {
  for (const char* option : {"--truth", "--lidar-truth"}) {
    ChildProcess rig(
        command({"--report", report(), "--duration", "2s", "--clock", "free", option, "/dev/full"}),
        file("err"));
    EXPECT_EQ(rig.wait(40s), 1) << rig.output();
    EXPECT_THAT(rig.output(), HasSubstr("/dev/full is not complete: No space left on device"));
    expect_clean_end_with_report();
    EXPECT_GE(nlohmann::json::parse(text_of(report()))["sim_s"], 2.0);
  }
}

TEST_F(RunProcess, a_report_that_cannot_be_written_is_said_before_a_wire_is_opened) {
  ChildProcess rig(command({"--report", "/nonexistent/report.json"}), file("err"));
  EXPECT_EQ(rig.wait(20s), 3);
  EXPECT_THAT(rig.output(), HasSubstr("/nonexistent/report.json"));
  EXPECT_THAT(rig.output(), Not(HasSubstr("seed"))) << "it ran";
}

TEST_F(RunProcess, a_report_on_a_full_device_ends_with_its_name_and_the_device_stays) {
  ChildProcess rig(command({"--report", "/dev/full", "--duration", "200ms"}), file("err"));
  EXPECT_EQ(rig.wait(20s), 1);
  EXPECT_THAT(rig.output(), HasSubstr("the report /dev/full is not written: No space left"));
  EXPECT_TRUE(fs::is_character_file("/dev/full"));
}

TEST_F(RunProcess, a_dash_puts_the_report_alone_on_standard_output) {
  const Descriptor out(::open(file("out").c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600));
  ChildProcess rig(command({"--report", "-", "--duration", "200ms"}), file("err"), out.get());
  EXPECT_EQ(rig.wait(20s), 0) << rig.output();
  EXPECT_EQ(nlohmann::json::parse(text_of(file("out")))["rig"], "small");
}

TEST_F(RunProcess, the_file_that_standard_output_goes_to_may_be_the_reports_too) {
  const Descriptor out(::open(file("out").c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600));
  ChildProcess rig(command({"--report", "/dev/stdout", "--duration", "200ms"}), file("err"),
                   out.get());
  EXPECT_EQ(rig.wait(20s), 0) << rig.output();
  const std::string text = text_of(file("out"));
  EXPECT_THAT(text, testing::StartsWith("small: seed 1"));
  EXPECT_THAT(text, HasSubstr("\"config_hash\""));
  EXPECT_THAT(text, HasSubstr("client asked last"));
}

TEST_F(RunProcess, a_run_ends_with_a_summary_and_the_report_has_the_same_figures) {
  ChildProcess rig(command({"--report", report(), "--duration", "3s", "--clock", "free"}),
                   file("out"));
  EXPECT_EQ(rig.wait(40s), 0) << rig.output();
  const std::string text = rig.output();
  EXPECT_THAT(text, HasSubstr("ran 3.000 s in "));
  EXPECT_THAT(text,
              HasSubstr("fault acted: gnss jamming, 0.000 .. 3.000 s, to the end of the run"));
  const auto json = nlohmann::json::parse(text_of(report()));
  EXPECT_EQ(json["faults"][0]["where"], "gnss");
  EXPECT_THAT(text, testing::ContainsRegex(
                        "gnss +" + std::to_string(json["devices"]["gnss"]["frames"].get<int>()) +
                        " +" + std::to_string(json["devices"]["gnss"]["bytes"].get<int>()) + " "));
}

/// A terminal whose user looks on.
class Terminal {
 public:
  Terminal(unsigned short columns, unsigned short rows) : screen_(columns, rows) {
    const winsize window{rows, columns, 0, 0};
    int master = -1;
    int slave = -1;
    if (::openpty(&master, &slave, nullptr, nullptr, &window) != 0) {
      throw std::runtime_error("no terminal");
    }
    master_.emplace(master);
    slave_.emplace(slave);
    thread_ = std::thread([this] {
      std::array<char, 4096> buffer{};
      for (ssize_t count = 0; (count = ::read(master_->get(), buffer.data(), buffer.size())) > 0;) {
        const std::scoped_lock lock(mutex_);
        screen_.feed({buffer.data(), static_cast<std::size_t>(count)});
      }
    });
  }
  /// When no program has it any more.
  ~Terminal() {
    slave_.reset();
    thread_.join();
  }
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  [[nodiscard]] int program_end() const { return slave_->get(); }
  [[nodiscard]] fs::path name() const { return ::ttyname(slave_->get()); }
  void resize(unsigned short columns, unsigned short rows) {
    const std::scoped_lock lock(mutex_);
    screen_ = test::Screen(columns, rows);
    const winsize window{rows, columns, 0, 0};
    ::ioctl(master_->get(), TIOCSWINSZ, &window);
  }
  [[nodiscard]] std::vector<std::string> lines() const {
    const std::scoped_lock lock(mutex_);
    return screen_.lines();
  }
  [[nodiscard]] std::size_t wraps() const {
    const std::scoped_lock lock(mutex_);
    return screen_.wraps();
  }

 private:
  mutable std::mutex mutex_;
  test::Screen screen_;
  std::optional<Descriptor> master_;
  std::optional<Descriptor> slave_;
  std::thread thread_;
};

std::size_t count_of(const std::vector<std::string>& lines, const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(lines.begin(), lines.end(),
                    [&](const std::string& line) { return line.find(text) != std::string::npos; }));
}

/// Seconds in the first line that has them; 0 without any.
double seconds_shown(const std::vector<std::string>& lines) {
  for (const std::string& line : lines) {
    if (line.starts_with("t = ")) {
      return std::stod(line.substr(4));
    }
  }
  return 0.0;
}

TEST_F(RunProcess, in_a_window_of_sixty_columns_there_is_one_table_and_no_line_wraps) {
  Terminal terminal(60, 24);
  std::optional<ChildProcess> rig;
  rig.emplace(command({}), file("err"), terminal.program_end());
  // Several pictures: the clock has gone on under the same title.
  ASSERT_TRUE(eventually([&] { return seconds_shown(terminal.lines()) >= 1.0; }, 60s))
      << rig->output();
  const auto lines = terminal.lines();
  EXPECT_EQ(count_of(lines, "real-time factor"), 1U);
  EXPECT_EQ(count_of(lines, "device"), 1U);
  EXPECT_EQ(count_of(lines, "fault: gnss jamming, until 1000.000 s"), 1U);
  EXPECT_EQ(terminal.wraps(), 0U);
  rig->signal(SIGINT);
  EXPECT_EQ(rig->wait(20s), 130) << rig->output();
  EXPECT_TRUE(eventually([&] { return count_of(terminal.lines(), "client asked last") == 1; }));
}

TEST_F(RunProcess, lines_of_the_log_on_the_terminal_of_the_table_do_not_shift_it) {
  Terminal terminal(100, 30);
  ChildProcess rig(command({}), terminal.name(), terminal.program_end());
  ASSERT_TRUE(eventually([&] { return seconds_shown(terminal.lines()) > 0.0; }, 60s));
  for (std::size_t times = 1; times <= 2; ++times) {
    fs::remove(file("gnss"));  // the link; the run puts it back and says so
    ASSERT_TRUE(eventually([&] { return count_of(terminal.lines(), "warning: ") == times; }));
  }
  const double then = seconds_shown(terminal.lines());
  ASSERT_TRUE(eventually([&] { return seconds_shown(terminal.lines()) > then + 0.5; }));
  const auto lines = terminal.lines();
  EXPECT_EQ(count_of(lines, "real-time factor"), 1U);
  EXPECT_EQ(count_of(lines, "fault: gnss jamming"), 1U);
  EXPECT_EQ(count_of(lines, "warning: "), 2U);
  const auto place = [&](const std::string& text) {
    return std::find_if(lines.begin(), lines.end(),
                        [&](const std::string& line) { return line.find(text) != line.npos; }) -
           lines.begin();
  };
  EXPECT_LT(place("warning: "), place("real-time factor"));
  rig.signal(SIGINT);
  EXPECT_EQ(rig.wait(20s), 130);
  EXPECT_TRUE(eventually([&] { return count_of(terminal.lines(), "client asked last") == 1; }));
  EXPECT_EQ(count_of(terminal.lines(), "s: info: stopping, closing wires"), 1U);
}

TEST_F(RunProcess, the_log_has_simulated_time_and_the_level_that_was_asked_for) {
  for (const bool quiet : {false, true}) {
    // Free: no host is too slow for it, which it would log.
    ChildProcess rig(
        command({"--status", "none", "--clock", "free", "--log-level", quiet ? "warning" : "info"}),
        file("err"));
    ASSERT_TRUE(eventually([&] { return line_is_there(); })) << rig.output();
    std::this_thread::sleep_for(500ms);
    rig.signal(SIGINT);
    EXPECT_EQ(rig.wait(20s), 130) << rig.output();
    if (quiet) {
      EXPECT_EQ(rig.output(), "");
    } else {
      EXPECT_THAT(rig.output(), testing::MatchesRegex(
                                    "rigwire: [0-9]+.[0-9]+ s: info: stopping, closing wires .*"));
    }
  }
}

TEST_F(RunProcess, a_window_that_becomes_smaller_is_followed_at_once) {
  Terminal terminal(100, 24);
  ChildProcess rig(command({"--set", "status.period=3 s"}), file("err"), terminal.program_end());
  ASSERT_TRUE(eventually([&] { return count_of(terminal.lines(), "device") == 1; }));
  terminal.resize(30, 5);
  ASSERT_TRUE(eventually([&] { return count_of(terminal.lines(), "more") == 1; }));
  EXPECT_EQ(terminal.wraps(), 0U);
  rig.signal(SIGINT);
  EXPECT_EQ(rig.wait(20s), 130);
}

}  // namespace
}  // namespace rigwire
