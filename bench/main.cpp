// rigwire-bench: cost of Rigwire's models and devices, and their error against more costly ones.
//
// It is built beside `rigwire`, which starts it as `rigwire bench`; the product itself does not
// contain it.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <exception>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bench/host.h"
#include "bench/registry.h"
#include "bench/suites.h"
#include "fields/failure_text.h"
#include "hil/command_line/verbs.h"
#include "hil/configuration/suggest.h"

namespace rigwire::bench {
namespace {

struct Options {
  std::string suite;
  std::string json_file;
  int bridge_runs = 1000;
  bool list = false;
};

int code(hil::ExitCode exit_code) {
  return static_cast<int>(exit_code);
}

std::vector<std::string> suite_names() {
  std::vector<std::string> names;
  for (const BenchSuite& suite : bench_suites()) {
    names.emplace_back(suite.name);
  }
  return names;
}

int list_suites() {
  std::vector<std::vector<std::string>> rows;
  for (const BenchSuite& suite : bench_suites()) {
    rows.push_back({std::string(suite.name), std::string(suite.text)});
  }
  std::cout << hil::table_text(rows);
  return code(hil::ExitCode::done);
}

int refuse_suite(const std::string& suite) {
  const std::vector<std::string> names = suite_names();
  const std::string near = hil::nearest_word(suite, names);
  std::cerr << fmt::format("rigwire-bench: unknown suite, found \"{}\", allowed {}{}\n", suite,
                           hil::join_words(names),
                           near.empty() ? "" : ", did you mean " + near + "?");
  return code(hil::ExitCode::usage);
}

/// One suite, or all of them when none is named.
nlohmann::ordered_json measure(const std::string& suite) {
  const HostFacts host = host_facts();
  nlohmann::ordered_json results{{"host",
                                  {{"kernel", host.kernel},
                                   {"processor", host.processor},
                                   {"cores", host.cores},
                                   {"compiler", host.compiler},
                                   {"flags", host.flags},
                                   {"load_average", load_average()}}}};
  std::cout << fmt::format("{}, {} cores, {}, load average {:.2f}; {} {}\n\n", host.processor,
                           host.cores, host.kernel, load_average()[0], host.compiler, host.flags);
  for (const BenchSuite& known : bench_suites()) {
    if (suite.empty() || suite == known.name) {
      std::cout << "== " << known.name << ": " << known.text << "\n" << std::flush;
      results[std::string(known.name)] = known.function(std::cout);
      std::cout << "\n";
    }
  }
  return results;
}

int run(const Options& options) {
  if (options.list) {
    return list_suites();
  }
  const std::vector<std::string> names = suite_names();
  if (!options.suite.empty() && std::ranges::find(names, options.suite) == names.end()) {
    return refuse_suite(options.suite);
  }
  set_bridge_runs(options.bridge_runs);
  const nlohmann::ordered_json results = measure(options.suite);
  if (!options.json_file.empty()) {
    std::ofstream file(options.json_file);
    file << results.dump(2) << "\n";
    file.flush();
    if (!file) {
      std::cerr << "rigwire-bench: cannot write " << options.json_file << "\n";
      return code(hil::ExitCode::environment);
    }
  }
  return code(hil::ExitCode::done);
}

}  // namespace
}  // namespace rigwire::bench

namespace {

int run(int count, char** arguments) {
  using rigwire::hil::ExitCode;
  CLI::App app("Measures speed and error of Rigwire's models, devices and wires.", "rigwire-bench");
  rigwire::bench::Options options;
  app.add_option("suite", options.suite, "One suite; all without it");
  app.add_option("--json", options.json_file, "Write the figures to a file");
  app.add_option("--bridge-runs", options.bridge_runs, "Runs of 2 s of the suite bridge; 1000")
      ->check(CLI::Range(2, 100'000));
  app.add_flag("--list", options.list, "List the suites");
  try {
    app.parse(count, arguments);
  } catch (const CLI::CallForHelp&) {
    std::cout << app.help();
    return static_cast<int>(ExitCode::done);
  } catch (const CLI::ParseError& error) {
    std::cerr << "rigwire-bench: " << error.what() << "\nTry: rigwire-bench --help\n";
    return static_cast<int>(ExitCode::usage);
  }
  return rigwire::bench::run(options);
}

}  // namespace

int main(int count, char** arguments) {
  try {
    return run(count, arguments);
  } catch (const std::exception& error) {
    std::cerr << "rigwire-bench: " << rigwire::fields::failure_text(error, "the measurements")
              << "\n";
    return static_cast<int>(rigwire::hil::ExitCode::failure);
  }
}
