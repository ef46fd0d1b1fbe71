#include "hil/campaign/collect.h"

#include <fmt/format.h>
#include <sqlite3.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>

#include "drivers/endpoints.h"
#include "fields/units.h"
#include "hil/campaign/csv_table.h"
#include "hil/configuration/outside_file.h"
#include "hil/configuration/plain_text.h"
#include "hil/record/output_file.h"

namespace rigwire::hil {

namespace fs = std::filesystem;
using PlainJson = nlohmann::json;

namespace {

template <class Number>
Number whole(const CsvTable& table, const std::string& text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) {
    throw std::invalid_argument(
        fmt::format("{}: found \"{}\", allowed a whole number", table.name, text));
  }
  return number;
}

std::string text_of(const PlainJson& value) {
  return value.is_string() ? value.get<std::string>() : std::string();
}

std::optional<double> number_of(const PlainJson& value) {
  return value.is_number() ? std::optional(value.get<double>()) : std::nullopt;
}

/// Throws PlainJson::exception and std::invalid_argument.
void fill(CampaignRow& row, const PlainJson& result) {
  const std::string outcome = result.at("outcome");
  const auto known = std::ranges::find(kOutcomes, outcome);
  if (known > kOutcomes.begin() + 2) {
    throw std::invalid_argument("unknown outcome");
  }
  if (result.contains("criteria")) {
    for (const auto& [name, verdict] : result["criteria"].items()) {
      row.verdicts[name] = {verdict.at("passed"), number_of(verdict.at("at_s")),
                            text_of(verdict.at("text")), text_of(verdict.at("detail"))};
    }
  }
  row.what = text_of(result.at("what"));
  row.sim_s = result.contains("sim_s") ? number_of(result["sim_s"]) : std::nullopt;
  if (result.contains("first_failure") && result["first_failure"].is_string()) {
    row.first_failure = result["first_failure"].get<std::string>();
    static_cast<void>(row.verdicts.at(*row.first_failure));
  }
  const bool all_passed =
      std::ranges::all_of(row.verdicts, [](const auto& verdict) { return verdict.second.passed; });
  if (result.contains("index") && result["index"] != row.index) {
    throw std::invalid_argument("it is of another run");
  }
  if ((outcome == "passed" && !all_passed) || (outcome == "failed" && all_passed)) {
    throw std::invalid_argument("its outcome contradicts its criteria");
  }
  if (result.contains("track")) {
    row.track = result["track"].get<std::vector<std::array<double, 3>>>();
  }
  row.outcome = static_cast<Outcome>(known - kOutcomes.begin());
}

void make_unreadable(CampaignRow& row, const std::string& why) {
  row.first_failure.reset();
  row.outcome = Outcome::crashed;
  row.what = "its result.json cannot be read" + why;
}

void look_at(CampaignRow& row, const fs::path& folder) {
  std::error_code error;
  if (!fs::exists(folder, error)) {
    return;
  }
  row.outcome = Outcome::unfinished;
  try {
    const PlainJson result =
        PlainJson::parse(read_outside_file(folder / "result.json", kResultFile));
    fill(row, result);
    if (row.outcome != Outcome::crashed && !is_done(folder)) {
      row.outcome = Outcome::unfinished;
    }
  } catch (const FileRefused& refused) {
    if (!refused.missing()) {
      make_unreadable(row, ": " + refused.rest());
    }
  } catch (const PlainJson::exception&) {
    make_unreadable(row, "");
  } catch (const std::exception& wrong) {
    make_unreadable(row, std::string(": ") + wrong.what());
  }
}

/// A database that is written once.
class Database {
 public:
  explicit Database(const fs::path& file) : file_(file) {
    if (::sqlite3_open(file.c_str(), &handle_) != SQLITE_OK) {
      const std::string why = ::sqlite3_errmsg(handle_);
      ::sqlite3_close(handle_);
      throw drivers::EndpointError(file.string() + ": " + why);
    }
  }
  ~Database() { ::sqlite3_close(handle_); }
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  void execute(const std::string& statement) {
    check(::sqlite3_exec(handle_, statement.c_str(), nullptr, nullptr, nullptr));
  }
  void check(int result) {
    if (result != SQLITE_OK && result != SQLITE_DONE && result != SQLITE_ROW) {
      throw drivers::EndpointError(file_.string() + ": " + ::sqlite3_errmsg(handle_));
    }
  }
  [[nodiscard]] ::sqlite3* handle() const { return handle_; }

 private:
  fs::path file_;
  ::sqlite3* handle_ = nullptr;
};

/// One INSERT, filled again for each row, column by column.
class Insertion {
 public:
  Insertion(Database& database, const std::string& statement) : database_(database) {
    database_.check(
        ::sqlite3_prepare_v2(database.handle(), statement.c_str(), -1, &statement_, nullptr));
  }
  ~Insertion() { ::sqlite3_finalize(statement_); }
  Insertion(const Insertion&) = delete;
  Insertion& operator=(const Insertion&) = delete;

  Insertion& put(std::int64_t value) {
    database_.check(::sqlite3_bind_int64(statement_, ++column_, value));
    return *this;
  }
  Insertion& put(double value) {
    database_.check(::sqlite3_bind_double(statement_, ++column_, value));
    return *this;
  }
  Insertion& put(std::string_view text) {
    // Copied: the text need not outlive the row.
    database_.check(::sqlite3_bind_text64(statement_, ++column_, text.data(), text.size(),
                                          SQLITE_TRANSIENT, SQLITE_UTF8));
    return *this;
  }
  template <class Value>
  Insertion& put(const std::optional<Value>& value) {
    if (value) {
      return put(*value);
    }
    ++column_;  // NULL
    return *this;
  }
  void row() {
    database_.check(::sqlite3_step(statement_));
    database_.check(::sqlite3_reset(statement_));
    database_.check(::sqlite3_clear_bindings(statement_));
    column_ = 0;
  }

 private:
  Database& database_;
  ::sqlite3_stmt* statement_ = nullptr;
  int column_ = 0;
};

std::string question_marks(std::size_t count) {
  std::string marks = "(?";
  for (std::size_t i = 1; i < count; ++i) {
    marks += ",?";
  }
  return marks + ")";
}

void fill_database(Database& database, const CampaignTable& table) {
  std::string columns;
  for (const std::string& name : table.plan.parameters) {
    columns += ", \"" + name + "\"";  // letters, digits, _ and - alone
  }
  database.execute("PRAGMA journal_mode=OFF; PRAGMA synchronous=OFF; BEGIN");
  database.execute(
      "CREATE TABLE runs (run INTEGER PRIMARY KEY, seed INTEGER, outcome TEXT, what TEXT, "
      "first_failure TEXT, sim_s REAL" +
      columns +
      "); CREATE TABLE criteria (run INTEGER, name TEXT, passed INTEGER, at_s REAL, text TEXT, "
      "detail TEXT, PRIMARY KEY (run, name)) WITHOUT ROWID; "
      "CREATE TABLE parameters (name TEXT PRIMARY KEY, unit TEXT)");
  Insertion runs(database,
                 "INSERT INTO runs VALUES " + question_marks(6 + table.plan.parameters.size()));
  Insertion criteria(database, "INSERT INTO criteria VALUES " + question_marks(6));
  std::vector<std::optional<std::string>> units(table.plan.parameters.size());
  for (const CampaignRow& row : table.rows) {
    const auto run = static_cast<std::int64_t>(row.index);
    runs.put(run)
        .put(static_cast<std::int64_t>(row.seed))
        .put(kOutcomes[static_cast<std::size_t>(row.outcome)])
        .put(row.what)
        .put(row.first_failure)
        .put(row.sim_s);
    for (std::size_t i = 0; i < row.values.size(); ++i) {
      if (const auto number = numeric(row.values[i])) {
        runs.put(number->number);
        units[i] = number->unit;
      } else {
        runs.put(row.values[i].empty() ? std::nullopt : std::optional(row.values[i]));
      }
    }
    runs.row();
    for (const auto& [name, verdict] : row.verdicts) {
      criteria.put(run).put(name).put(std::int64_t{verdict.passed}).put(verdict.at_s);
      criteria.put(verdict.text).put(verdict.detail).row();
    }
  }
  Insertion parameters(database, "INSERT INTO parameters VALUES (?,?)");
  for (std::size_t i = 0; i < units.size(); ++i) {
    parameters.put(table.plan.parameters[i]).put(units[i]).row();
  }
  database.execute("COMMIT");
}

std::string csv_of(const CampaignTable& table) {
  std::vector<std::string> line{"index", "seed", "outcome", "what", "first_failure", "sim_s"};
  line.insert(line.end(), table.plan.parameters.begin(), table.plan.parameters.end());
  for (const std::string& name : table.plan.criteria) {
    line.push_back(name + " passed");
    line.push_back(name + " at_s");
  }
  std::string text = csv_line(line);
  const auto number = [](const std::optional<double>& value) {
    return value ? fmt::format("{}", *value) : std::string();
  };
  for (const CampaignRow& row : table.rows) {
    line = {std::to_string(row.index),
            std::to_string(row.seed),
            std::string(kOutcomes[static_cast<std::size_t>(row.outcome)]),
            row.what,
            row.first_failure.value_or(""),
            number(row.sim_s)};
    line.insert(line.end(), row.values.begin(), row.values.end());
    for (const std::string& name : table.plan.criteria) {
      const auto verdict = row.verdicts.find(name);
      const bool known = verdict != row.verdicts.end();
      line.emplace_back(!known ? "" : verdict->second.passed ? "1" : "0");
      line.push_back(known ? number(verdict->second.at_s) : "");
    }
    text += csv_line(line);
  }
  return text;
}

}  // namespace

std::size_t CampaignTable::count(Outcome outcome) const {
  return static_cast<std::size_t>(std::ranges::count(rows, outcome, &CampaignRow::outcome));
}

CampaignTable read_rows(const fs::path& folder) {
  CampaignTable table{read_plan(folder), {}};
  const CsvTable planned = read_csv(folder / "table.csv");
  std::vector<std::string> columns{"index", "seed"};
  columns.insert(columns.end(), table.plan.parameters.begin(), table.plan.parameters.end());
  if (planned.columns != columns || planned.rows.size() != table.plan.runs) {
    throw std::invalid_argument(planned.name +
                                ": not the table of its plan, allowed the one that "
                                "`rigwire campaign expand -o` wrote");
  }
  std::set<std::size_t> indices;
  for (const std::vector<std::string>& line : planned.rows) {
    CampaignRow row;
    row.index = whole<std::size_t>(planned, line[0]);
    if (!indices.insert(row.index).second) {
      throw std::invalid_argument(fmt::format("{}: index {} occurs in two lines, allowed each once",
                                              planned.name, row.index));
    }
    row.seed = whole<std::uint64_t>(planned, line[1]);
    row.values.assign(line.begin() + 2, line.end());
    look_at(row, run_folder(folder, row.index));
    table.rows.push_back(std::move(row));
  }
  return table;
}

std::optional<NumericValue> numeric(const std::string& value) {
  const auto quantity = fields::split_quantity(value);
  if (!quantity || !std::isfinite(quantity->value)) {
    return std::nullopt;
  }
  return NumericValue{quantity->value, std::string(quantity->unit)};
}

void write_tables(const fs::path& folder, const CampaignTable& table) {
  WholeFile("the table", folder / "results.csv").write(csv_of(table));
  // A name of its own: several collectors may be at the folder at once, and the last one stays.
  const fs::path written = folder / fmt::format("results.sqlite.{}", ::getpid());
  fs::remove(written);
  try {
    Database database(written);
    fill_database(database, table);
  } catch (...) {
    std::error_code ignored;
    fs::remove(written, ignored);
    throw;
  }
  fs::rename(written, folder / "results.sqlite");
}

}  // namespace rigwire::hil
