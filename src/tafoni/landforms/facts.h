#pragma once
// What a layer tells about what it made: typed, so that reports, texts and other rooms need not take names
// apart. Names are written here in small letters with underscores; a unit is no part of them.

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "tafoni/math/vec.h"

namespace tafoni::landforms {

enum class Unit { none, metres, square_metres, cubic_metres };

/// Positions in the scene's local frame; reports show world positions.
struct Places {
  std::vector<Vec3d> local;
  bool operator==(const Places&) const = default;
};

struct Fact {
  using Content = std::variant<bool, std::int64_t, double, std::string, std::vector<double>, Places>;
  std::string name;
  Content content;
  Unit unit = Unit::none;
  std::string about = {};  ///< a phrase that says what is counted or measured
  bool operator==(const Fact&) const = default;
};

/// In the order in which they were told.
class Facts {
 public:
  Facts& count(std::string name, std::int64_t n) { return add(std::move(name), n); }
  Facts& flag(std::string name, bool is) { return add(std::move(name), is); }
  Facts& text(std::string name, std::string words) { return add(std::move(name), std::move(words)); }
  /// Without a unit: a share, a factor.
  Facts& number(std::string name, double v) { return add(std::move(name), v); }
  Facts& numbers(std::string name, std::vector<double> v) { return add(std::move(name), std::move(v)); }
  Facts& length(std::string name, double m) { return add(std::move(name), m, Unit::metres); }
  Facts& lengths(std::string name, std::vector<double> m) {
    return add(std::move(name), std::move(m), Unit::metres);
  }
  Facts& area(std::string name, double m2) { return add(std::move(name), m2, Unit::square_metres); }
  Facts& volume(std::string name, double m3) { return add(std::move(name), m3, Unit::cubic_metres); }
  Facts& places(std::string name, std::vector<Vec3d> local) {
    return add(std::move(name), Places{std::move(local)});
  }

  /// Explains the fact told last, for reports.
  Facts& about(std::string phrase) {
    all_.back().about = std::move(phrase);
    return *this;
  }

  /// Null where nothing of this name was told, or not as a T.
  template <class T>
  const T* find(std::string_view name) const {
    for (const Fact& fact : all_)
      if (fact.name == name) return std::get_if<T>(&fact.content);
    return nullptr;
  }
  auto begin() const { return all_.begin(); }
  auto end() const { return all_.end(); }
  bool empty() const { return all_.empty(); }
  bool operator==(const Facts&) const = default;
  void append(const Facts& more) { all_.insert(all_.end(), more.begin(), more.end()); }

 private:
  Facts& add(std::string name, Fact::Content content, Unit unit = Unit::none) {
    all_.push_back({std::move(name), std::move(content), unit, {}});
    return *this;
  }
  std::vector<Fact> all_;
};

}  // namespace tafoni::landforms
