// Joining shapes at bonds. A label is searched for over the parts of the base and the bonds of the added
// shape, on a compiled field of the base that tells which bonds are still free; the operation then changes
// one part or all.

#include "tafoni/grammar/assembly.h"

#include <algorithm>
#include <numeric>

#include "tafoni/core/error.h"
#include "tafoni/field/compiled.h"

namespace tafoni::grammar {
namespace {

constexpr double near_enough = 1e-3;  // metres between a bond and the surface it lies on
constexpr double space_before = 0.05, body_behind = 0.005;  // metres in which there is space, and something
constexpr int look_steps = 48;                              // in which a bond looks through the whole base
constexpr int settle_steps = 64;    // in which a bond looks for the surface that has moved
constexpr int halvings = 40;        // until the surface is found to the last bit that matters
constexpr double straight = 0.999;  // cosine from which a bond counts as looking straight along
constexpr double opposite = 1e-9;   // how little two opposite directions differ

/// Whether a bond lies on the surface, with free space before it and something behind.
bool is_free(const field::CompiledField& base, const Bond& bond) {
  return std::abs(base.value(bond.point)) < static_cast<float>(near_enough) &&
         (bond.direction == Vec3d{} || (base.value(bond.point + bond.direction * space_before) < 0 &&
                                        base.value(bond.point - bond.direction * body_behind) > 0));
}

/// Whether a bond looks along L_B, within 45 degrees.
bool looks_along(const Bond& bond, Vec3d direction) {
  constexpr double cos45 = 0.7071067811865475;
  return bond.direction == Vec3d{} || direction == Vec3d{} || dot(bond.direction, direction) >= cos45;
}

/// Whether nothing lies before a bond, however far.
bool looks_out(const field::CompiledField& field, const Bond& bond, double size) {
  for (int i = 1; i <= look_steps && bond.direction != Vec3d{}; ++i)
    if (field.value(bond.point + bond.direction * (size * i / look_steps)) > 0) return false;
  return true;
}

/// Moves bonds along their directions to the nearest place of the surface, and drops those that find none.
void settle(std::vector<Bond>& bonds, const field::CompiledField& base, double reach) {
  const auto search = [&](const Bond& bond) -> std::optional<Bond> {
    if (bond.direction == Vec3d{}) return is_free(base, bond) ? std::optional(bond) : std::nullopt;
    const auto at = [&](double t) { return base.value(bond.point + bond.direction * t); };
    for (int i = 0; i < 2 * settle_steps; ++i) {
      // Inside at lo, outside at hi: 0, then out and in by turns.
      double lo = reach / settle_steps * (i % 2 ? -(i / 2) - 1 : i / 2), hi = lo + reach / settle_steps;
      if (at(lo) < 0 || at(hi) >= 0) continue;
      for (int halving = 0; halving < halvings; ++halving) (at((lo + hi) / 2) >= 0 ? lo : hi) = (lo + hi) / 2;
      return Bond{bond.point + bond.direction * hi, bond.direction};
    }
    return std::nullopt;
  };
  std::vector<Bond> kept;
  for (const Bond& bond : bonds) {
    const auto found = search(bond);
    if (found && std::none_of(kept.begin(), kept.end(), [&](const Bond& other) {
          return length(other.point - found->point) < near_enough;
        }))
      kept.push_back(*found);
  }
  bonds = std::move(kept);
}

std::vector<std::size_t> shuffle(std::size_t n, Random& random) {
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), std::size_t{0});
  for (std::size_t i = n; i > 1; --i) std::swap(order[i - 1], order[random.below(i)]);
  return order;
}

/// The order of bonds with those that `score` most first; in any order where they score alike.
template <class Score>
std::vector<std::size_t> rank(const std::vector<Bond>& bonds, Random& random, const Score& score) {
  std::vector<std::size_t> order = shuffle(bonds.size(), random);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return score(bonds[a]) > score(bonds[b]); });
  return order;
}

/// Half the way through a box along a direction.
double extent(const Box3d& box, Vec3d direction) {
  const Vec3d half = box.size() * 0.5;
  return std::abs(direction.x) * half.x + std::abs(direction.y) * half.y + std::abs(direction.z) * half.z;
}

/// The pose of an added shape once it is pushed in, along the base's direction or else the added bond's own.
Pose push_in(Pose pose, const Shape& added, const Bond& base, const Bond& own, const Part& part,
             const Production& how) {
  const Vec3d out = base.direction == Vec3d{} ? -pose.turned(own.direction) : base.direction;
  const Box3d box = pose.placed(added.bounds);
  const double way =
      how.level ? dot(box.center() - part.core.center(), out) : 2 * how.sink * extent(box, out);
  pose.at -= out * way;
  return pose;
}

}  // namespace

Shape shape_of(SolidPtr solid) {
  Shape shape{nullptr, solid->bounds(), solid->bonds(), 0};
  if (shape.bounds.empty()) return shape;
  shape.elements = 1;
  auto form = std::make_shared<Form>();
  form->solid = std::move(solid);
  shape.form = std::move(form);
  return shape;
}

bool glue(const Bond& a, const Bond& b, double tolerance) {
  if (length(a.point - b.point) > tolerance) return false;
  return a.direction == Vec3d{} || b.direction == Vec3d{} || length(a.direction + b.direction) <= tolerance;
}

void Assembly::begin(const Shape& shape, const Pose& pose) {
  if (!shape.form) return;
  Part part{placed(shape.form, pose), pose.placed(shape.bounds), {}, -1, {}, {}};
  for (const Bond& bond : shape.bonds) part.bonds.push_back(pose.placed(bond));
  part.core = part.bounds;
  parts_.push_back(std::move(part));
  elements_ += shape.elements;
}

FormPtr Assembly::form() const {
  std::vector<FormPtr> forms;
  for (const Part& part : parts_) forms.push_back(part.form);
  return sum(std::move(forms));
}

Box3d Assembly::bounds() const {
  Box3d out;
  for (const Part& part : parts_) out.expand(part.bounds);
  return out;
}

Shape Assembly::shape() const {
  Shape out{form(), bounds(), {}, elements_};
  const field::CompiledField field = field::compile(tree(out.form));
  for (const Part& part : parts_)
    for (const Bond& bond : part.bonds)
      if (is_free(field, bond) && looks_out(field, bond, length(out.bounds.size())))
        out.bonds.push_back(bond);
  return out;
}

bool Assembly::open_towards(Vec3d direction) const {
  const field::CompiledField base = field::compile(tree(form()));
  return std::any_of(parts_.begin(), parts_.end(), [&](const Part& part) {
    return std::any_of(part.bonds.begin(), part.bonds.end(),
                       [&](const Bond& bond) { return looks_along(bond, direction) && is_free(base, bond); });
  });
}

std::optional<Assembly::Label> Assembly::find_label(const Shape& added, const Production& how, Random& random,
                                                    const Accept& accept) const {
  const field::CompiledField base = field::compile(tree(form()));
  // An assembly is glued by its outermost sides.
  const std::vector<std::size_t> by_reach =
      rank(added.bonds, random, [](const Bond& bond) { return dot(bond.point, bond.direction); });
  const int count = static_cast<int>(parts_.size()), first = how.part < 0 ? count - 1 : how.part;
  for (int k = 0; k < count; ++k) {
    // The part asked for, then the others from the last to the first.
    const int index = k == 0 ? first : (count - k <= first ? count - 1 - k : count - k);
    const Part& part = parts_[index];
    // Straight ones before slanting ones, the farthest first.
    const auto forward = [&](const Bond& bond) {
      const bool ahead = dot(bond.direction, how.direction) > straight;
      return std::pair(ahead, dot(bond.point, how.direction));
    };
    for (const std::size_t b : rank(part.bonds, random, forward)) {
      const Bond& bond = part.bonds[b];
      if (!looks_along(bond, how.direction) || !is_free(base, bond)) continue;
      for (const bool turned : {false, true}) {
        if (turned && !how.turn) break;
        for (const std::size_t a : by_reach) {
          const Bond& own = added.bonds[a];
          const bool fits = bond.direction == Vec3d{} || own.direction == Vec3d{} ||
                            length(own.direction + bond.direction) < opposite;
          if (fits == turned) continue;
          Pose pose = turned ? turn(own.direction, -bond.direction) : Pose{};
          pose.at = bond.point - pose.turned(own.point);
          const Pose final = push_in(pose, added, bond, own, part, how);
          if (accept && !accept(final.placed(added.bounds))) continue;
          return Label{index, b, a, pose, final};
        }
      }
    }
  }
  return std::nullopt;
}

bool Assembly::apply(const Shape& added, const Production& how, const Label& label) {
  auto& bonds = parts_[label.part].bonds;
  const Bond base = bonds[label.bond], own = label.touching.placed(added.bonds[label.added]);
  labels_.emplace_back(base, own);
  bonds.erase(bonds.begin() + label.bond);

  const Pose& pose = label.final;
  const FormPtr form = placed(added.form, pose);
  const Box3d box = pose.placed(added.bounds);
  std::vector<Bond> others;
  for (std::size_t i = 0; i < added.bonds.size(); ++i)
    if (i != label.added) others.push_back(pose.placed(added.bonds[i]));

  if (how.operation == Operation::sum) {
    parts_.push_back({form, box, std::move(others), label.part, base, box});
    return true;
  }
  if (how.operation == Operation::difference) return carve(added, label);
  if (how.whole) {
    Part all{this->form(), bounds(), {}, -1, {}, parts_.front().core};
    for (Part& part : parts_) all.bonds.insert(all.bonds.end(), part.bonds.begin(), part.bonds.end());
    parts_ = {std::move(all)};
  }
  Part& part = parts_[how.whole ? 0 : label.part];
  part.form = combined(how.operation, part.form, form, how.alpha);
  if (how.operation == Operation::morph) part.bounds.expand(box);
  part.bonds.insert(part.bonds.end(), others.begin(), others.end());
  part.bonds.push_back(base);  // the surface has moved away from under the label
  settle(part.bonds, field::compile(tree(part.form)), length(part.bounds.size()));
  std::erase_if(part.bonds, [&](const Bond& bond) {
    return std::any_of(labels_.begin(), labels_.end(),
                       [&](const auto& used) { return length(used.first.point - bond.point) < near_enough; });
  });
  return !part.bonds.empty();
}

bool Assembly::carve(const Shape& added, const Label& label) {
  const FormPtr form = placed(added.form, label.final);
  const Box3d box = label.final.placed(added.bounds);
  // max(a, b) less c is max(a less c, b less c); parts that c does not reach keep their surface.
  for (Part& part : parts_)
    if (part.bounds.overlaps(box)) part.form = combined(Operation::difference, part.form, form);
  Part& part = parts_[label.part];
  for (const Bond& own : added.bonds) {
    const Bond bond = label.final.placed(own);
    part.bonds.push_back({bond.point, -bond.direction});
  }
  return open_towards({});
}

bool Assembly::produce(const Shape& added, const Production& how, Random& random, const Accept& accept) {
  if (!added.form) return false;
  if (parts_.empty()) {
    if (how.operation != Operation::sum || (accept && !accept(added.bounds))) return false;
    begin(added);
    ++classic_;
    return true;
  }
  const auto label = find_label(added, how, random, accept);
  if (!label) return false;
  Assembly before = *this;
  if (!apply(added, how, *label)) {
    *this = std::move(before);
    return false;
  }
  elements_ += added.elements;
  ++(how.operation == Operation::morph ? morphic_ : classic_);
  return true;
}

}  // namespace tafoni::grammar
