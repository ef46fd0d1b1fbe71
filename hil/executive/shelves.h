// Typed channels between truth and stations: a shelf for each station and type. Samples go to the
// stations; sample plans and commands go to the truth.
//
// The executive hands shelves over without knowing what lies on them: only the sensor that puts an
// item there and the station that takes it share its type. A type is found by comparing a station's
// few shelves (two or three), so code that uses a shelf looks it up once per slice or step, never
// for each item on it.
#pragma once

#include <cstddef>
#include <iterator>
#include <memory>
#include <typeinfo>
#include <utility>
#include <vector>

namespace rigwire::hil {

/// Position of a station in the executive; addresses samples, plans and commands.
using StationIndex = std::size_t;

/// Shelves are made at the first call of of() and kept with their memory, emptied, from slice to
/// slice: once every shelf has been as full as it gets, nothing is allocated any more.
class Shelves {
 public:
  Shelves() = default;
  Shelves(Shelves&&) noexcept = default;
  Shelves& operator=(Shelves&&) noexcept = default;

  /// The shelf of that station and type. The reference holds as long as this object, also after a
  /// move of it.
  template <class T>
  std::vector<T>& of(StationIndex station) {
    if (auto* items = known<T>(station)) {
      return *items;
    }
    if (station >= by_station_.size()) {
      by_station_.resize(station + 1);
    }
    auto made = std::make_unique<ShelfOf<T>>();
    std::vector<T>& items = made->items;
    by_station_[station].push_back(std::move(made));
    return items;
  }

  /// Returns the shelf for reading; nullptr when nothing has ever been put there.
  template <class T>
  [[nodiscard]] const std::vector<T>* find(StationIndex station) const {
    return known<T>(station);
  }

  /// Returns the maximum index of a station that has a shelf, plus one; 0 without.
  [[nodiscard]] std::size_t stations() const { return by_station_.size(); }

  /// Empties every shelf.
  void clear();
  /// Number of items on all shelves.
  [[nodiscard]] std::size_t size() const;
  [[nodiscard]] bool empty() const { return size() == 0; }

  /// Appends everything to the same shelves of `other`, which must be another object, and empties
  /// these.
  void move_to(Shelves& other);

 private:
  class Shelf {
   public:
    explicit Shelf(const std::type_info& of) : type(of) {}
    virtual ~Shelf() = default;
    Shelf(const Shelf&) = delete;
    Shelf& operator=(const Shelf&) = delete;

    virtual void clear() = 0;
    [[nodiscard]] virtual std::size_t size() const = 0;
    virtual void move_to(StationIndex station, Shelves& other) = 0;

    const std::type_info& type;
  };

  template <class T>
  class ShelfOf final : public Shelf {
   public:
    ShelfOf() : Shelf(typeid(T)) {}
    void clear() override { items.clear(); }
    [[nodiscard]] std::size_t size() const override { return items.size(); }
    void move_to(StationIndex station, Shelves& other) override {
      if (!items.empty()) {
        std::vector<T>& to = other.of<T>(station);
        to.insert(to.end(), std::make_move_iterator(items.begin()),
                  std::make_move_iterator(items.end()));
        items.clear();
      }
    }

    std::vector<T> items;
  };

  template <class T>
  [[nodiscard]] std::vector<T>* known(StationIndex station) const {
    if (station < by_station_.size()) {
      for (const std::unique_ptr<Shelf>& shelf : by_station_[station]) {
        if (shelf->type == typeid(T)) {
          return &static_cast<ShelfOf<T>&>(*shelf).items;
        }
      }
    }
    return nullptr;
  }

  std::vector<std::vector<std::unique_ptr<Shelf>>> by_station_;
};

}  // namespace rigwire::hil
