// An owning pointer that copies what it points to, so that a structure with a member of one of many
// types stays a value.
#pragma once

#include <memory>
#include <utility>

namespace rigwire::fields {

/// `Interface` has `std::unique_ptr<Interface> copy() const`. Never empty but when moved from.
template <class Interface>
class Box {
 public:
  explicit Box(std::unique_ptr<Interface> content) : content_(std::move(content)) {}
  Box(const Box& other) : content_(other.content_->copy()) {}
  Box& operator=(const Box& other) {
    content_ = other.content_->copy();
    return *this;
  }
  Box(Box&&) noexcept = default;
  Box& operator=(Box&&) noexcept = default;
  ~Box() = default;

  [[nodiscard]] Interface& operator*() { return *content_; }
  [[nodiscard]] const Interface& operator*() const { return *content_; }
  [[nodiscard]] Interface* operator->() { return content_.get(); }
  [[nodiscard]] const Interface* operator->() const { return content_.get(); }

 private:
  std::unique_ptr<Interface> content_;
};

}  // namespace rigwire::fields
