#pragma once
// Productions [Zawadzki §2.4, §2.5]: shapes joined at bonds, one after the other.

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "tafoni/core/random.h"
#include "tafoni/grammar/form.h"

namespace tafoni::grammar {

/// What a production adds: a solid, or a whole assembly stored for use as a shape (the base shape of one
/// grammar is a shape of another). The empty shape has no form and no bonds.
struct Shape {
  FormPtr form;
  Box3d bounds;
  std::vector<Bond> bonds;
  std::uint64_t elements = 0;  ///< solids that went into it
};
Shape shape_of(SolidPtr solid);

/// Two bonds glue when their points meet and their directions are opposite, or one has none (definition 5).
bool glue(const Bond& a, const Bond& b, double tolerance = 1e-6);

/// How one shape is added to the base.
struct Production {
  Operation operation = Operation::sum;
  Vec3d direction;     ///< of the base's bond (L_B), within 45 degrees; zero: any
  double alpha = 0.5;  ///< of a morph (M_P)
  /// Afterwards the added shape is pushed in by this share of its extent; 0: touching, as in [Zawadzki].
  double sink = 0;
  bool turn = true;    ///< the added shape may be turned so that a bond of its own looks the other way
  bool level = false;  ///< instead of `sink`: until its middle is level with that of the part
  /// A morph or an intersection acts on the whole base, as [Zawadzki] has it, not on one part of it. All
  /// of it is one part then, the first.
  bool whole = false;
  int part = -1;  ///< the part whose bonds are tried first; -1: the last
};

/// One part of the base: what a sum added, and all that was done to it since.
struct Part {
  FormPtr form;
  Box3d bounds;
  std::vector<Bond> bonds;  ///< free ones; some may be buried under other parts
  int parent = -1;          ///< the part it was joined to
  Bond door;                ///< the parent's bond, used up by that
  Box3d core;               ///< of the shape as it was added, for its middle
};

/// The base shape. It begins empty; each production replaces it.
class Assembly {
 public:
  using Accept = std::function<bool(const Box3d& added)>;

  /// Adds a shape where it lies, without a label: what an empty base begins with. No production.
  void begin(const Shape& shape, const Pose& pose = {});
  /// Adds a shape by a label between a free bond of the base and one of the shape, drawn from `random`. What
  /// a difference takes away leaves its own bonds on the walls of the hollow, the other way round.
  /// False, and nothing changed, where no label can be made, `accept` (may be null) refuses every place, or
  /// nothing would be left to go on from.
  bool produce(const Shape& added, const Production& how, Random& random, const Accept& accept = nullptr);

  /// Whether a free bond looks along the direction (of a Production).
  bool open_towards(Vec3d direction) const;

  const std::vector<Part>& parts() const { return parts_; }
  bool empty() const { return parts_.empty(); }
  FormPtr form() const;
  Box3d bounds() const;
  /// The whole as a shape, with the bonds that are still free and have nothing of it before them.
  Shape shape() const;
  /// Bonds used by labels so far, by pairs, as they met before anything was pushed in.
  const std::vector<std::pair<Bond, Bond>>& labels() const { return labels_; }
  /// Solids that were added, each once however many parts it takes something from.
  std::uint64_t elements() const { return elements_; }
  int classic() const { return classic_; }
  int morphic() const { return morphic_; }

 private:
  struct Label {
    int part = 0;
    std::size_t bond = 0, added = 0;
    Pose touching, final;  ///< of the added shape, before and after it is pushed in
  };
  std::optional<Label> find_label(const Shape& added, const Production& how, Random& random,
                                  const Accept& accept) const;
  bool apply(const Shape& added, const Production& how, const Label& label);
  bool carve(const Shape& added, const Label& label);

  std::vector<Part> parts_;
  std::vector<std::pair<Bond, Bond>> labels_;
  std::uint64_t elements_ = 0;
  int classic_ = 0, morphic_ = 0;
};

}  // namespace tafoni::grammar
