// Assemblies at random: operations in a drawn order, each with a shape drawn for it, tried again a few times
// where it finds no place.

#include "tafoni/grammar/derive.h"

#include <algorithm>

#include "tafoni/core/error.h"
#include "tafoni/math/draw.h"

namespace tafoni::grammar {
namespace {

enum class DeriveStream : std::uint64_t { productions = 0x5364 };

constexpr int shape_draws = 20;         // shapes drawn for one production before it is dropped
constexpr double least_overlap = 0.25;  // of the solids of one shape, so that it holds together
constexpr double cut_sink = 0.5;        // how far a shape that takes away is pushed in: to its middle

class Generator {
 public:
  explicit Generator(const Settings& settings)
      : settings_(settings),
        direction_(direction_of(settings.direction)),
        random_(settings.seed, DeriveStream::productions) {
    if (settings.solids.empty()) fail(ErrorKind::usage, "a grammar needs the name of one solid at least");
    for (const std::string& name : settings.solids) find_solid(name);
  }

  void run(Assembly& base, const Assembly::Accept& accept, Progress& progress) {
    const std::vector<Operation> order = operations();
    bool first = true;
    progress.begin("productions", order.size(), "productions");
    for (std::size_t k = 0; k < order.size(); ++k) {
      progress.check();
      for (int i = 0; i < shape_draws; ++i) {
        // What finds nothing to take away from adds instead, so that P_C is kept.
        const bool given_up = i >= shape_draws / 2 && order[k] != Operation::morph;
        Production how = production(given_up ? Operation::sum : order[k], base);
        if (first) how.direction = {};
        const Assembly before = base;
        if (!base.produce(shape(), how, random_, accept)) continue;
        if (k + 1 < order.size() && !base.open_towards(direction_)) {
          base = before;
          continue;
        }
        first = false;
        break;
      }
      progress.advance();
    }
    progress.end();
  }

 private:
  /// A sum first; the morphs at random places after it.
  std::vector<Operation> operations() {
    std::vector<Operation> order;
    for (int i = 0; i < settings_.classic; ++i) {
      const double draw = random_.uniform();
      const bool sum = i == 0 || draw >= settings_.differences + settings_.intersections;
      order.push_back(sum                            ? Operation::sum
                      : draw < settings_.differences ? Operation::difference
                                                     : Operation::intersection);
    }
    for (int i = 0; i < settings_.morphic; ++i) {
      const std::size_t at = order.empty() ? 0 : 1 + random_.below(order.size());
      order.insert(order.begin() + at, Operation::morph);
    }
    return order;
  }

  SolidPtr solid(double scale) {
    const std::string& name = settings_.solids[random_.below(settings_.solids.size())];
    const auto half = [&] {
      return scale * settings_.size * random_.uniform(settings_.spread[0], settings_.spread[1]);
    };
    const double x = half(), y = half(), z = half() * settings_.flat;
    const SolidType& type = find_solid(name);
    return type.make(type.fit({x, y, z}));
  }

  /// P_S solids, joined in any direction.
  Shape shape() {
    const std::int64_t count = std::max<std::int64_t>(1, settings_.per_shape);
    if (count == 1) return shape_of(solid(1));
    const double scale = 1 / std::cbrt(static_cast<double>(count));
    Assembly parts;
    for (int i = 0; i < count; ++i) {
      Production how;
      how.sink = std::max(settings_.overlap, least_overlap);
      how.turn = settings_.turn;
      parts.produce(shape_of(solid(scale)), how, random_);
    }
    Shape whole = parts.shape();
    const Vec3d middle = whole.bounds.center();
    const Pose to_middle{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, -middle};
    whole.form = placed(whole.form, to_middle);
    whole.bounds = to_middle.placed(whole.bounds);
    for (Bond& bond : whole.bonds) bond = to_middle.placed(bond);
    return whole;
  }

  Production production(Operation operation, const Assembly& base) {
    Production how;
    how.operation = operation;
    how.direction = direction_;
    how.alpha = settings_.morph;
    how.turn = settings_.turn;
    how.whole = settings_.whole;
    // What lies outside cannot take anything away, and would leave next to nothing in common or in between.
    how.sink = operation == Operation::sum ? settings_.overlap : cut_sink;
    how.level = operation == Operation::morph || operation == Operation::intersection;
    const bool branch = random_.uniform() < settings_.branches;
    const std::uint64_t parts = base.parts().size();
    if (branch && parts > 0 && operation != Operation::intersection) how.part = draw_index(random_, parts);
    return how;
  }

  const Settings& settings_;
  Vec3d direction_;
  Random random_;
};

}  // namespace

std::vector<std::string> direction_names() {
  return {"+X", "-X", "+Y", "-Y", "+Z", "-Z", "random"};
}

Vec3d direction_of(std::string_view text) {
  constexpr Vec3d axes[] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}, {0, 0, 0}};
  const std::vector<std::string> names = direction_names();
  const auto found = std::find(names.begin(), names.end(), text);
  if (found == names.end())
    fail(ErrorKind::usage, "there is no direction \"{}\"; write +X, -X, +Y, -Y, +Z, -Z or random", text);
  return axes[found - names.begin()];
}

void derive_at_random(Assembly& base, const Settings& settings, const Assembly::Accept& accept,
                      Progress& progress) {
  Generator(settings).run(base, accept, progress);
}

}  // namespace tafoni::grammar
