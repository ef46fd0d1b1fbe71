// The visitor that fills plain structs from a document and finds everything that is wrong with it.
//
//   Problems problems;
//   Value document = load_document(file, problems);
//   Origins origins;
//   Camera camera;                       // members hold the defaults
//   read(document, camera, problems, origins);
//   problems.throw_if_any();
//
// It never stops at the first finding: a field that cannot be read keeps its default and reading
// goes on. Keys that no visit function asked for are findings too. A struct that can validate()
// itself is asked to after it was read without findings.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "fields/visitor.h"
#include "hil/configuration/document.h"
#include "hil/configuration/problems.h"
#include "sim/samples/calendar.h"

namespace rigwire::hil {

class Reader final : public fields::Visitor {
 public:
  /// The document, problems and origins must outlive the reader.
  Reader(const Value& document, Problems& problems, Origins& origins);

  /// Reads the whole struct from the document's top.
  void read(const fields::Part& part);

  void required(std::string_view key) override;
  void refused(std::string_view key, std::string_view why) override;
  /// Keys without effect are findings, unless what excludes them was written over them.
  void conditional(bool holds, std::string_view choice, std::string_view needs,
                   const fields::Part& keys) override;
  void check(bool holds, std::string_view key, const std::string& what, const std::string& found,
             const std::string& allowed) override;
  /// The range is checked in the member's unit, bounds converted as the value is.
  void number(std::string_view key, double& value, const fields::NumberRule& rule,
              std::string_view text) override;
  void numbers(std::string_view key, std::span<double> values, const fields::NumberRule& rule,
               std::string_view text) override;
  void number_list(std::string_view key, std::vector<double>& values,
                   const fields::NumberRule& rule, std::string_view text) override;
  /// Decimal or 0x hexadecimal.
  void whole(std::string_view key, std::int64_t& value, const fields::IntegerRule& rule,
             bool unsigned_64, std::string_view text) override;
  void boolean(std::string_view key, bool& value, std::string_view text) override;
  void text(std::string_view key, std::string& value, std::string_view text) override;
  void texts(std::string_view key, std::vector<std::string>& values,
             std::string_view text) override;
  void file(std::string_view key, std::string& value, fields::FileKind kind,
            std::string_view text) override;
  /// A bare number is in seconds.
  void duration(std::string_view key, std::chrono::nanoseconds& value,
                const fields::DurationRule& rule, std::string_view text) override;
  void rate(std::string_view key, std::chrono::nanoseconds& period, const fields::NumberRule& rule,
            std::string_view text) override;
  void spelled(std::string_view key, const fields::Spelling& spelling,
               std::string_view text) override;
  /// Names that are quantities ("100 Hz") also match "100Hz" and the bare number.
  void pick(std::string_view key, std::size_t& index, std::span<const fields::Named> names,
            std::string_view text) override;
  void part(std::string_view key, const fields::Part& part, std::string_view text) override;
  /// Replaces the default list when the file has one.
  void elements(std::string_view key, fields::Elements& list, std::string_view text) override;
  void members(std::string_view key, fields::Members& map, std::string_view noun,
               std::string_view text) override;
  void alternatives(std::string_view key, fields::Alternatives& types,
                    std::string_view text) override;

 private:
  struct Frame {
    const Value* map;
    std::string path;
    std::vector<std::string> known;
    bool report_unknown = true;
  };
  /// Condition under which a group of keys has an effect (only_if()).
  struct Condition {
    std::string_view choice;
    std::string_view needs;
  };

  [[nodiscard]] std::string path_of(std::string_view key) const;
  /// `meaning`: what the key means, for the message when a required key is missing.
  const Value* find(std::string_view key, std::string_view meaning = {});
  void refuse_without_effect(std::string_view key, const Value* value);
  const Value* find_scalar(std::string_view key, std::string_view meaning = {});
  const Value* find_map(std::string_view key, std::string_view meaning = {});
  const Value* find_list(std::string_view key, std::string_view meaning = {});
  bool is_scalar(const Value& value, const std::string& path);
  /// Names and texts are shown in tables, messages and reports.
  bool is_one_line(const Value& value, const std::string& path);
  bool read_number(const Value& value, const std::string& path, const fields::NumberRule& rule,
                   double& result);
  bool read_integer(const Value& value, const std::string& path, const fields::IntegerRule& rule,
                    bool unsigned_64, std::int64_t& result);
  /// A whole number written with a unit.
  bool read_counted(const Value& value, const std::string& path, const fields::IntegerRule& rule,
                    std::int64_t& result);
  /// kNoChoice after reporting.
  std::size_t read_choice(const Value& value, const std::string& path,
                          std::span<const fields::Named> names, std::string_view what);
  void push(const Value& map, std::string path);
  void pop();
  void report(const Value& at, const std::string& path, std::string what, std::string found = {},
              std::string allowed = {}, std::string suggestion = {});
  void report_no_map(const Value& at, const std::string& path);
  [[nodiscard]] bool keep_entry(const Value::Entry& entry, const std::string& path,
                                const Value& map, std::string_view noun);
  void read_map(const Value& map, const std::string& path, const fields::Part& part);
  void validate(const Value& map, const std::string& path, const fields::Part& part);

  const Value& document_;
  Problems& problems_;
  Origins& origins_;
  Value nothing_;  ///< An empty map, read in place of a section that was not written.
  std::vector<Frame> frames_;
  std::string required_;
  std::optional<Condition> without_effect_;  ///< While keys are named that have none.
};

/// Reads `value` from the document's top.
template <class Struct>
void read(const Value& document, Struct& value, Problems& problems, Origins& origins) {
  Reader(document, problems, origins).read(fields::Part::of(value));
}

/// "2026-06-01T08:00:00Z". Refers to `time`, which must outlive it.
[[nodiscard]] fields::Spelling utc_spelling(UtcTime& time);

}  // namespace rigwire::hil
