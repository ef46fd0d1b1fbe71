// A member of one of many types that share an interface, chosen by name from a list of rows: what a
// std::variant is for few types that everybody may know. It copies, so that a structure with such a
// member stays a value.
//
// `Interface` has `std::unique_ptr<Interface> copy() const`, and a visit() function.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string_view>
#include <utility>

#include "fields/visitor.h"

namespace rigwire::fields {

template <class Interface>
struct TypeRow {
  Named named;                            ///< Name of the type in a file, and its text.
  std::unique_ptr<Interface> (*fresh)();  ///< Makes one with the type's defaults.
};

template <class Interface>
class Chosen {
 public:
  using Row = TypeRow<Interface>;

  /// `rows` must outlive it. Precondition: index < rows.size().
  explicit Chosen(std::span<const Row> rows, std::size_t index = 0)
      : rows_(rows), index_(index), content_(rows[index].fresh()) {}
  Chosen(const Chosen& other)
      : rows_(other.rows_), index_(other.index_), content_(other.content_->copy()) {}
  Chosen& operator=(const Chosen& other) {
    if (this != &other) {
      rows_ = other.rows_;
      index_ = other.index_;
      content_ = other.content_->copy();
    }
    return *this;
  }
  Chosen(Chosen&&) noexcept = default;
  Chosen& operator=(Chosen&&) noexcept = default;
  ~Chosen() = default;

  [[nodiscard]] std::span<const Row> rows() const { return rows_; }
  [[nodiscard]] std::size_t index() const { return index_; }
  /// The name of the row that is chosen.
  [[nodiscard]] std::string_view type() const { return rows_[index_].named.name; }
  /// Keeps what is there when it is of that row, else begins with the type's defaults.
  void choose(std::size_t index) {
    if (index != index_) {
      *this = Chosen(rows_, index);
    }
  }

  [[nodiscard]] Interface& operator*() { return *content_; }
  [[nodiscard]] const Interface& operator*() const { return *content_; }
  [[nodiscard]] Interface* operator->() { return content_.get(); }
  [[nodiscard]] const Interface* operator->() const { return content_.get(); }

 private:
  std::span<const Row> rows_;
  std::size_t index_;
  std::unique_ptr<Interface> content_;
};

/// The content, when it is of the class `Type`; else null.
template <class Type, class Interface>
[[nodiscard]] const Type* as(const Chosen<Interface>& chosen) {
  return dynamic_cast<const Type*>(&*chosen);
}

/// Visits the key that chooses the row, with the chosen content's keys beside it.
template <class Interface>
void visit_chosen(Visitor& v, std::string_view key, Chosen<Interface>& chosen,
                  std::string_view text) {
  class Rows final : public Alternatives {
   public:
    explicit Rows(Chosen<Interface>& of) : of_(of) {}
    [[nodiscard]] std::vector<Named> names() const override {
      std::vector<Named> names;
      for (const TypeRow<Interface>& row : of_.rows()) {
        names.push_back(row.named);
      }
      return names;
    }
    [[nodiscard]] std::size_t index() const override { return of_.index(); }
    void choose(std::size_t index) override { of_.choose(index); }
    Part chosen() override { return Part::of(*of_); }

   private:
    Chosen<Interface>& of_;
  };
  Rows rows(chosen);
  v.alternatives(key, rows, text);
}

}  // namespace rigwire::fields
