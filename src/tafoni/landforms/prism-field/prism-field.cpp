// The ground as layers of columns: a box of rock, or the terrain as it stands, is dug and built by spheres at
// random places and by tools from a table. A box joins the terrain; dug terrain takes its place.

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/core.h>

#include "tafoni/core/error.h"
#include "tafoni/core/random.h"
#include "tafoni/geology/geology.h"
#include "tafoni/landforms/landform.h"
#include "tafoni/landforms/prism-field/hill_tunnel.h"
#include "tafoni/landforms/prism-field/tool_rows.h"
#include "tafoni/landforms/rock/replacement.h"
#include "tafoni/landforms/site/ground.h"
#include "tafoni/landforms/site/region.h"
#include "tafoni/math/whole.h"
#include "tafoni/volume/prism_convert.h"

namespace tafoni::landforms::landform_prism_field {
namespace {

using impl::Ground;
using impl::ToolUse;
using volume::Edit;
using volume::PrismFields;
using volume::Tool;

enum class Stream : std::uint64_t { spheres = 0x9715 };

// Chosen by eye.
constexpr double least_sphere = 0.03, most_sphere = 0.09;  // of the shortest side
constexpr double open_ends = 2;                            // radii that a tunnel is bored beyond its mouths
constexpr double bedding_most = 0.75;      // of the terrain's amplitude: beyond it walls would break open
constexpr double depth_in_amplitudes = 2;  // of dug terrain below the deepest tool
constexpr int most_tries = 1000;           // at a place near the sphere before
// Beyond these, minutes and gigabytes.
constexpr double most_columns = 0x1p25, most_samples = 0x1p33;
// Columns stand between the planes of the scene's lattice, for most voxels: an upright face in a plane of
// samples would end in steps of whole voxels.
constexpr double off_lattice = 0.375;

struct Params : impl::TunnelSettings {
  Params() = default;  // g++ 12 warns of vectors in aggregates with bases
  std::string source = "terrain";
  double spacing = 0;
  std::vector<double> at;
  std::vector<double> size = {100, 100, 40};
  bool alone = false;
  std::int64_t count = 60;
  std::vector<double> radius = {0, 0};
  double step = 0;
  double bedding = 0;
  double rounding = 0.7;
  Rows tools;
};

const ParamTable<Params>& table() {
  static const ParamTable<Params> params = [] {
    const Values box = {{"source", std::string("box")}};
    ParamTable<Params> t;
    t.choice("source", &Params::source, {"terrain", "box"},
             "What is dug: the terrain with the layers below, or a box of rock")
        .real("spacing", &Params::spacing, "m", 0, 1000,
              "Distance between columns, 0 for the terrain's pixel; matter and air thinner than that may be "
              "lost")
        .numbers(
            "at", &Params::at, "m", 0, -1e9, 1e9,
            "Middle of a box's underside, x, y and z; if not given it stands on the middle of the terrain")
        .only("where source is box", box)
        .numbers("size", &Params::size, "m", 3, 0.1, 1e5, "Sides of a box along x, y and z")
        .only("where source is box", box)
        .boolean("alone", &Params::alone, "Whether a box stands in place of the terrain")
        .only("where source is box", box)
        .integer("count", &Params::count, "", 0, 100000,
                 "Spheres taken out at random places, before the tools")
        .numbers("radius", &Params::radius, "m", 2, 0, 10000,
                 "Least and greatest radius of the spheres, 0 for 3 and 9 % of the shorter side")
        .real("step", &Params::step, "m", 0, 1e5,
              "Most that a sphere lies from the one before, 0 for anywhere in the rock; small steps dig one "
              "winding hollow")
        .real("tunnel", &Params::tunnel, "m", 0, 1000,
              "Radius of a level tunnel bored through the terrain's slimmest hill, 0 for none")
        .only("where source is terrain and a hill has room for it")
        .real("cover", &Params::cover, "m", 0, 10000,
              "How deep below the hill's top the tunnel runs, 0 for a quarter of the relief")
        .only("where tunnel is above 0", {{"tunnel", 3.0}})
        .real("bedding", &Params::bedding, "m", 0, 100,
              "How far soft rock recedes from the surface, 0 for not at all; at most three quarters of the "
              "terrain's "
              "amplitude")
        .real("rounding", &Params::rounding, "", 0, 2,
              "Share of the spacing over which the teeth and stairs are taken off that columns end in; 0 "
              "leaves them")
        .rows("tool", &Params::tools, impl::tool_columns(),
              "Tools applied one after another, after the spheres");
    return t;
  }();
  return params;
}

double volume_of(const PrismFields& fields) {
  const volume::ColumnFrame& frame = fields.frame();
  volume::ColumnBlock row;
  double sum = 0;
  for (int j = 0; j < frame.ny; ++j) {
    fields.read({0, j, frame.nx - 1, j}, row);
    for (int i = 0; i < frame.nx; ++i)
      for (const volume::Matter& m : row.at(i, j)) sum += m.top - m.bottom;
  }
  return sum * frame.dx * frame.dy;
}

class Digging {
 public:
  Digging(const Ground& ground, const Params& p, Progress& progress)
      : ground_(ground),
        site_(ground.site()),
        p_(p),
        progress_(progress),
        random_(site_.seed, Stream::spheres) {
    spacing_ = p.spacing > 0 ? p.spacing : ground.pixel();
    grain_ = std::max(spacing_, ground.pixel());
    tools_ = impl::tools_of(p.tools, site_.origin, "prism-field");
  }

  Result run() {
    const bool box = p_.source == "box";
    room_ = ground_.box();
    if (box) {
      const Vec3d half{0.5 * p_.size[0], 0.5 * p_.size[1], 0};
      room_ = {foot() - half, foot() + half};
      room_.hi.z += p_.size[2];
      if (!ground_.usable(room_.center())) return nothing();
    }
    return box ? dig_box() : dig_terrain();
  }

 private:
  Result nothing() const {
    progress_.warn("prism-field makes nothing: its box stands where the layer may not act; give another at");
    Result result;
    result.facts.count("tools", 0).about("Tools that met matter and changed it").count("primitives", 0);
    return result;
  }

  Vec3d foot() const {
    if (p_.at.size() == 3) return Vec3d{p_.at[0], p_.at[1], p_.at[2]} - site_.origin;
    if (!p_.at.empty())
      fail(ErrorKind::usage, "prism-field: at has {} numbers; give x, y and z", p_.at.size());
    Vec3d middle = ground_.box().center();
    middle.z = ground_.height(middle.x, middle.y);
    return middle;
  }

  /// Where a sphere may lie: in the room and, of a terrain, no higher than the ground.
  Vec3d somewhere() {
    const double x = random_.uniform(room_.lo.x, room_.hi.x), y = random_.uniform(room_.lo.y, room_.hi.y);
    const double top = p_.source == "box" ? room_.hi.z : std::min(room_.hi.z, ground_.height(x, y));
    return {x, y, random_.uniform(room_.lo.z, std::max(room_.lo.z, top))};
  }

  /// [Boggus fig. 7]: "a destructive sphere was randomly and discontinuously moved about".
  void dig(PrismFields& fields) {
    const Vec3d sides = room_.size();
    const double shorter = std::min({sides.x, sides.y, sides.z});
    const double least = p_.radius[0] > 0 ? p_.radius[0] : least_sphere * shorter;
    const double most = std::max(least, p_.radius[1] > 0 ? p_.radius[1] : most_sphere * shorter);
    progress_.begin("digging", p_.count + tools_.size(), "tools");
    Vec3d last = somewhere();
    for (std::int64_t n = 0; n < p_.count; ++n) {
      Vec3d next = somewhere();
      for (int tries = 0; p_.step > 0 && n > 0 && tries < most_tries && length(next - last) > p_.step;
           ++tries) {
        const Vec3d way{random_.uniform(-1, 1), random_.uniform(-1, 1), random_.uniform(-1, 1)};
        const Vec3d near = last + way * p_.step;
        if (room_.contains(near)) next = near;
      }
      last = next;
      if (ground_.usable(next)) apply(fields, Tool::sphere(next, random_.uniform(least, most)), Edit::remove);
      progress_.advance();
    }
    for (const ToolUse& use : tools_) {
      if (!apply(fields, use.tool, use.mode)) idle_.push_back(&use - tools_.data());
      progress_.advance();
    }
    progress_.end();
  }

  /// The tunnel comes before the tools that are given.
  void bore_tunnel() {
    mouths_ = impl::find_hill_tunnel(ground_, p_, grain_, progress_);
    if (mouths_.empty()) return;
    const Vec3d on = normalized(mouths_[0] - mouths_[1]) * (open_ends * p_.tunnel);
    tools_.insert(tools_.begin(), {Tool::capsule(mouths_[0] + on, mouths_[1] - on, p_.tunnel), Edit::remove});
  }

  bool apply(PrismFields& fields, const Tool& tool, Edit mode) {
    const bool changed = !fields.apply(tool, mode).empty();
    changed_ += changed;
    return changed;
  }

  void check_size(const Box3d& over) const {
    const Vec3d size = over.size() * (1 / spacing_);
    const double columns = size.x * size.y, samples = columns * size.z;
    if (columns <= most_columns && (p_.source == "box" || samples <= most_samples)) return;
    fail(ErrorKind::usage,
         "{:.0f} x {:.0f} x {:.0f} m about what is dug and built are too much at a spacing of {:g} m; give a "
         "larger spacing or smaller tools",
         over.size().x, over.size().y, over.size().z, spacing_);
  }

  void warn_of_idle() const {
    const std::ptrdiff_t given = std::ssize(tools_) - std::ssize(p_.tools);  // the first of those that are
    for (const std::ptrdiff_t n : idle_)
      if (n >= given)
        progress_.warn(
            fmt::format("prism-field: tool, row {} changes nothing: {}", n - given + 1,
                        tools_[n].mode == Edit::remove
                            ? "there is no matter where it digs, or the layer does not reach there"
                            : "there is matter already where it builds, or the layer does not reach there"));
    if (changed_ == 0 && p_.count > 0 && p_.tools.empty())
      progress_.warn("prism-field digs nothing: no sphere met matter; give larger ones or another region");
  }

  Result tell(const PrismFields& fields, double before) const {
    warn_of_idle();
    Result result;
    result.facts.count("tools", changed_)
        .about("Tools that met matter and changed it")
        .count("columns", std::int64_t{fields.frame().nx} * fields.frame().ny)
        .about("Columns of the prism-fields")
        .count("layers", fields.layers())
        .about("Most layers of ground over one another")
        .volume("volume_removed", before - volume_of(fields))
        .about("Volume of the ground that tools removed, less what they added")
        .places("mouths", mouths_)
        .about("x, y and z of the places where tunnels come to light")
        .count("bytes", fields.bytes())
        .about("Memory of the prism-fields")
        .count("primitives", 0);
    return result;
  }

  Result dig_box() {
    // What the tools add may reach out.
    Box3d over = room_;
    for (const ToolUse& use : tools_)
      if (use.mode == Edit::add) over.expand(use.tool.bounds());
    check_size(over);
    const auto down = [&](double v) {
      return (std::floor(v / spacing_ - off_lattice) + off_lattice) * spacing_;
    };
    const volume::ColumnFrame frame{{down(over.lo.x), down(over.lo.y), 0},
                                    spacing_,
                                    spacing_,
                                    ceil_to((over.hi.x - down(over.lo.x)) / spacing_) + 1,
                                    ceil_to((over.hi.y - down(over.lo.y)) / spacing_) + 1};
    PrismFields fields(frame);
    const Vec3d half = room_.size() * 0.5;
    fields.apply(Tool::box(room_.center(), half + Vec3d{1e-6, 1e-6, 0}), Edit::add);
    const double before = volume_of(fields);
    dig(fields);
    Result result = tell(fields, before);
    const auto leaf = wear(nullptr)(
        field::function(volume::as_function(fields, {.reach = site_.amplitude, .rounding = p_.rounding})));
    const Box3d reached = over.grown(2 * spacing_ + site_.amplitude);
    result.reshaped = p_.alone ? Box3d::everything() : reached;
    result.lowest = reached.lo.z;
    result.reshape = [leaf, alone = p_.alone](field::NodePtr tree) {
      return alone ? leaf : field::unite({std::move(tree), leaf});
    };
    return result;
  }

  /// Where the prism-field takes the place of what was there.
  field::FunctionPtr control_of(const Box3d& box) const {
    Region region = site_.region ? *site_.region : Region();
    region.limit_box(box);
    if (site_.valid) {
      auto data = std::make_shared<raster::Raster>(*site_.heights);
      for (std::size_t n = 0; n < data->values.size(); ++n)
        data->values.values()[n] = site_.valid->values()[n] ? 1.0f : raster::no_data;
      region.limit_mask(std::move(data));
    }
    return as_function(&region, 2 * spacing_);
  }

  Result dig_terrain() {
    if (p_.tunnel > 0) bore_tunnel();
    Box3d over = room_.grown(4 * spacing_);
    for (const ToolUse& use : tools_) {
      over.lo.z = std::min(over.lo.z, use.tool.bounds().lo.z);
      over.hi.z = std::max(over.hi.z, use.tool.bounds().hi.z);
    }
    over.lo.z -= depth_in_amplitudes * site_.amplitude;
    check_size(over);
    PrismFields fields = volume::prism_from(field::compile(site_.terrain), over, spacing_, progress_);
    const double before = volume_of(fields);
    dig(fields);
    Result result = tell(fields, before);
    const auto leaf = volume::as_function(
        fields, {.reach = site_.amplitude, .floor = fields.frame().origin.z + 1e-3, .rounding = p_.rounding});
    // Up and down it goes as far as the region does.
    Box3d within = over.grown(-spacing_);
    within.lo.z = -std::numeric_limits<double>::infinity();
    within.hi.z = std::numeric_limits<double>::infinity();
    const auto control = control_of(within);
    result.reshaped = within;
    result.lowest = over.lo.z;
    if (site_.region) {
      const Box3d limit = site_.region->bounds();
      result.reshaped.lo.z = limit.lo.z, result.reshaped.hi.z = limit.hi.z;
    }
    result.reshape = [leaf, control, wear = wear(control)](field::NodePtr tree) {
      constexpr float any = std::numeric_limits<float>::max();
      return wear(field::function(impl::replace_within(field::as_function(tree, -any, any), leaf, control)));
    };
    return result;
  }

  /// Takes soft beds back, within the region.
  std::function<field::NodePtr(field::NodePtr)> wear(const field::FunctionPtr& where) const {
    const double depth = std::min(p_.bedding, bedding_most * site_.amplitude);
    if (!(depth > 0) || !site_.geology) return [](field::NodePtr tree) { return tree; };
    const auto hardness = geology::as_function(site_.geology);
    return [=](field::NodePtr tree) { return field::erode(std::move(tree), where, hardness, depth); };
  }

  const Ground& ground_;
  const Site& site_;
  const Params& p_;
  Progress& progress_;
  Random random_;
  double spacing_ = 1;
  double grain_ = 1;  ///< of the search for a hill: finer columns must not move the tunnel
  Box3d room_;
  std::vector<ToolUse> tools_;
  std::vector<Vec3d> mouths_;  ///< of the tunnel, on its axis
  std::int64_t changed_ = 0;
  std::vector<std::ptrdiff_t> idle_;  ///< tools that changed nothing
};

Result generate(const Site& site, const Values& values, Progress& progress) {
  Params p;
  assign(table().infos(), &p, values, "prism-field");
  if (p.radius[1] > 0 && p.radius[0] > p.radius[1])
    fail(ErrorKind::usage, "prism-field: radius = [{:g}, {:g}] must not begin with the greater one",
         p.radius[0], p.radius[1]);
  progress.check();
  const Ground ground(site);
  if (ground.box().empty()) {
    Result result;
    result.facts.count("tools", 0).about("Tools that met matter and changed it").count("primitives", 0);
    return result;
  }
  return Digging(ground, p, progress).run();
}

}  // namespace

const LandformType& declaration() {
  static const LandformType type{
      .about = {.name = "prism-field",
                .doc = "Ground as layers of columns, dug and built with spheres, capsules, boxes and hulls",
                .source = "[Boggus §3, figs. 7, 8]",
                .params = table().infos()},
      .generate = &generate,
  };
  return type;
}

}  // namespace tafoni::landforms::landform_prism_field
