#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/core.h>

#include "tafoni/core/error.h"
#include "tafoni/core/random.h"
#include "tafoni/geology/geology.h"
#include "tafoni/landforms/landform.h"
#include "tafoni/landforms/prism-field/tool_rows.h"
#include "tafoni/landforms/rock/replaced.h"
#include "tafoni/landforms/site/ground.h"
#include "tafoni/volume/prism_convert.h"

namespace tafoni::landforms {
namespace {

using impl::Ground;
using impl::ToolUse;
using volume::Edit;
using volume::PrismFields;
using volume::Tool;

struct Params {
  std::string source = "terrain";
  double spacing = 0;
  std::vector<double> at;
  std::vector<double> size = {100, 100, 40};
  bool alone = false;
  std::int64_t count = 60;
  std::vector<double> radius = {0, 0};
  double step = 0;
  double tunnel = 0;
  double cover = 0;
  double bedding = 0;
  double rounding = 0.7;
  Rows tools;
};

const ParamTable<Params>& table() {
  static const ParamTable<Params> params = [] {
    ParamTable<Params> t;
    t.choice("source", &Params::source, {"terrain", "box"},
             "what is dug: the terrain with the layers below, or a box of rock")
        .real("spacing", &Params::spacing, "m", 0, 1000,
              "between columns, 0 for the terrain's pixel; matter and air thinner than that may be lost")
        .numbers(
            "at", &Params::at, "m", 0, -1e9, 1e9,
            "of a box: x, y and z of the middle of its underside; if not given it stands on the middle of "
            "the terrain")
        .numbers("size", &Params::size, "m", 3, 0.1, 1e5, "of a box: its sides along x, y and z")
        .boolean("alone", &Params::alone, "whether a box stands in place of the terrain")
        .integer("count", &Params::count, "", 0, 100000,
                 "spheres taken out at random places, before the tools")
        .numbers("radius", &Params::radius, "m", 2, 0, 10000,
                 "least and greatest of the spheres, 0 for 3 and 9 % of the shorter side")
        .real("step", &Params::step, "m", 0, 1e5,
              "most that a sphere lies from the one before; 0 for anywhere in the rock")
        .real("tunnel", &Params::tunnel, "m", 0, 1000,
              "radius of a level tunnel bored through the terrain's slimmest hill, 0 for none")
        .real("cover", &Params::cover, "m", 0, 10000,
              "how deep below the hill's top the tunnel runs, 0 for a quarter of the relief")
        .real("bedding", &Params::bedding, "m", 0, 100,
              "how far soft rock recedes from the surface; at most three quarters of the terrain's amplitude")
        .real("rounding", &Params::rounding, "", 0, 2,
              "share of the spacing over which the teeth and stairs are taken off that columns end in; 0 "
              "leaves them")
        .rows("tool", &Params::tools, impl::tool_columns(),
              "tools applied one after another, after the spheres");
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
      for (const volume::Matter& m : row.at(i, j)) sum += static_cast<double>(m.top - m.bottom);
  }
  return sum * frame.dx * frame.dy;
}

class Digging {
 public:
  Digging(const Ground& ground, const Params& p, Progress& progress)
      : ground_(ground), site_(ground.site()), p_(p), progress_(progress), random_(site_.seed, 0x9715) {
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
    result.report = {{"tools", std::int64_t{0}}, {"primitives", std::int64_t{0}}};
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
    const double least = p_.radius[0] > 0 ? p_.radius[0] : 0.03 * shorter;
    const double most = std::max(least, p_.radius[1] > 0 ? p_.radius[1] : 0.09 * shorter);
    progress_.begin("digging", static_cast<std::uint64_t>(p_.count) + tools_.size(), "tools");
    Vec3d last = somewhere();
    for (std::int64_t n = 0; n < p_.count; ++n) {
      Vec3d next = somewhere();
      for (int tries = 0; p_.step > 0 && n > 0 && tries < 1000 && length(next - last) > p_.step; ++tries) {
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

  /// The shortest level way through a hill that has so much rock over it, with open air before both mouths.
  void find_tunnel() {
    const Box3d& box = ground_.box();
    const auto [low, high] =
        std::minmax_element(site_.heights->values.values().begin(), site_.heights->values.values().end());
    const double cover = p_.cover > 0 ? p_.cover : 0.25 * static_cast<double>(*high - *low);
    const Vec3d extent = box.size();
    const double stride = std::max(2 * grain_, std::min(extent.x, extent.y) / 40);
    const double longest = 0.6 * std::min(extent.x, extent.y), margin = 6 * grain_;
    double least = std::numeric_limits<double>::infinity();
    for (double y = box.lo.y + margin; y < box.hi.y - margin; y += stride)
      for (double x = box.lo.x + margin; x < box.hi.x - margin; x += stride) {
        const double z = ground_.height(x, y) - cover;
        for (int turn = 0; turn < 12; ++turn) {
          const double angle = turn * std::numbers::pi / 12;
          const Vec3d along{std::cos(angle), std::sin(angle), 0};
          const double most = std::min(least, longest);
          const double ahead = way_out({x, y, z}, along, most);
          const double back = way_out({x, y, z}, -along, most - ahead);
          if (!(ahead + back < most) || ahead + back < 6 * p_.tunnel) continue;
          // A mouth high in a cliff is no way in.
          const double cost =
              ahead + back +
              4 * (drop(Vec3d{x, y, z} + along * ahead, along) + drop(Vec3d{x, y, z} - along * back, -along));
          if (!(cost < least)) continue;
          least = cost;
          mouths_ = {Vec3d{x, y, z} + along * ahead, Vec3d{x, y, z} - along * back};
        }
      }
    if (mouths_.empty()) {
      progress_.warn(
          fmt::format("prism-field bores no tunnel: no hill has {:.0f} m of cover over less than {:.0f} m; "
                      "give a smaller cover",
                      cover, longest));
      return;
    }
    const Vec3d on = normalized(mouths_[0] - mouths_[1]) * (2 * p_.tunnel);
    tools_.insert(tools_.begin(), {Tool::capsule(mouths_[0] + on, mouths_[1] - on, p_.tunnel), Edit::remove});
  }

  /// From the floor at a mouth down to the ground before it.
  double drop(Vec3d mouth, Vec3d out) const {
    const Vec3d p = mouth + out * (2 * p_.tunnel);
    return std::max(0.0, mouth.z - p_.tunnel - ground_.height(p.x, p.y));
  }

  /// Metres to where the ground falls below the tunnel's floor; infinite if that is beyond `most`.
  double way_out(Vec3d from, Vec3d along, double most) const {
    const double step = std::max(grain_, 0.25 * p_.tunnel);
    for (double d = step; d < most; d += step) {
      const Vec3d p = from + along * d;
      if (!ground_.usable(p)) break;
      if (ground_.height(p.x, p.y) >= from.z - 0.8 * p_.tunnel) continue;
      if (ground_.usable(p, 4 * grain_)) return d;
      break;
    }
    return std::numeric_limits<double>::infinity();
  }

  bool apply(PrismFields& fields, const Tool& tool, Edit mode) {
    const bool changed = !fields.apply(tool, mode).empty();
    changed_ += changed;
    return changed;
  }

  /// Beyond these, minutes and gigabytes.
  void check_size(const Box3d& over) const {
    constexpr double most = 0x1p25, most_samples = 0x1p33;
    const Vec3d size = over.size() * (1 / spacing_);
    const double columns = size.x * size.y, samples = columns * size.z;
    if (columns <= most && (p_.source == "box" || samples <= most_samples)) return;
    fail(ErrorKind::usage,
         "{:.0f} x {:.0f} x {:.0f} m about what is dug and built are too much at a spacing of {:g} m; give a "
         "larger spacing or smaller tools",
         over.size().x, over.size().y, over.size().z, spacing_);
  }

  void warn_of_idle() const {
    const auto given = static_cast<std::ptrdiff_t>(tools_.size() - p_.tools.size());
    for (const std::ptrdiff_t n : idle_)
      if (n >= given)
        progress_.warn(
            fmt::format("prism-field: tool, row {} changes nothing: {}", n - given + 1,
                        tools_[static_cast<std::size_t>(n)].mode == Edit::remove
                            ? "there is no matter where it digs, or the layer does not reach there"
                            : "there is matter already where it builds, or the layer does not reach there"));
    if (changed_ == 0 && p_.count > 0 && p_.tools.empty())
      progress_.warn("prism-field digs nothing: no sphere met matter; give larger ones or another region");
  }

  std::vector<double> world(const std::vector<Vec3d>& places) const {
    std::vector<double> out;
    for (Vec3d p : places) {
      p += site_.origin;
      out.insert(out.end(), {p.x, p.y, p.z});
    }
    return out;
  }

  Result report(const PrismFields& fields, double before) const {
    warn_of_idle();
    Result result;
    result.report = {{"tools", changed_},
                     {"columns", std::int64_t{fields.frame().nx} * fields.frame().ny},
                     {"layers", static_cast<std::int64_t>(fields.layers())},
                     {"volume_removed_m3", before - volume_of(fields)},
                     {"mouths", world(mouths_)},
                     {"bytes", static_cast<std::int64_t>(fields.bytes())},
                     {"primitives", std::int64_t{0}}};
    return result;
  }

  Result dig_box() {
    // What the tools add may reach out. Columns stand between the planes of the scene's lattice, for most
    // voxels: an upright face in a plane of samples would end in steps of whole voxels.
    Box3d over = room_;
    for (const ToolUse& use : tools_)
      if (use.mode == Edit::add) over.expand(use.tool.bounds());
    check_size(over);
    const auto down = [&](double v) { return (std::floor(v / spacing_ - 0.375) + 0.375) * spacing_; };
    const volume::ColumnFrame frame{
        {down(over.lo.x), down(over.lo.y), 0},
        spacing_,
        spacing_,
        static_cast<int>(std::ceil((over.hi.x - down(over.lo.x)) / spacing_)) + 1,
        static_cast<int>(std::ceil((over.hi.y - down(over.lo.y)) / spacing_)) + 1};
    PrismFields fields(frame);
    const Vec3d half = room_.size() * 0.5;
    fields.apply(Tool::box(room_.center(), half + Vec3d{1e-6, 1e-6, 0}), Edit::add);
    const double before = volume_of(fields);
    dig(fields);
    Result result = report(fields, before);
    const auto leaf = wear(nullptr)(
        field::function(volume::as_function(fields, {.reach = site_.amplitude, .rounding = p_.rounding})));
    result.reshaped = p_.alone ? Box3d::everything() : over.grown(2 * spacing_ + site_.amplitude);
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
    if (p_.tunnel > 0) find_tunnel();
    Box3d over = room_.grown(4 * spacing_);
    for (const ToolUse& use : tools_) {
      over.lo.z = std::min(over.lo.z, use.tool.bounds().lo.z);
      over.hi.z = std::max(over.hi.z, use.tool.bounds().hi.z);
    }
    over.lo.z -= 2 * site_.amplitude;
    check_size(over);
    PrismFields fields = volume::prism_from(field::compile(site_.terrain), over, spacing_, progress_);
    const double before = volume_of(fields);
    dig(fields);
    Result result = report(fields, before);
    const auto leaf = volume::as_function(
        fields, {.reach = site_.amplitude, .floor = fields.frame().origin.z + 1e-3, .rounding = p_.rounding});
    // Up and down it goes as far as the region does.
    Box3d within = over.grown(-spacing_);
    within.lo.z = -std::numeric_limits<double>::infinity();
    within.hi.z = std::numeric_limits<double>::infinity();
    const auto control = control_of(within);
    result.reshaped = within;
    if (site_.region) {
      const Box3d limit = site_.region->bounds();
      result.reshaped.lo.z = limit.lo.z, result.reshaped.hi.z = limit.hi.z;
    }
    result.reshape = [leaf, control, wear = wear(control)](field::NodePtr tree) {
      constexpr float any = std::numeric_limits<float>::max();
      return wear(field::function(impl::replaced(field::as_function(tree, -any, any), leaf, control)));
    };
    return result;
  }

  /// Takes soft beds back, within the region.
  std::function<field::NodePtr(field::NodePtr)> wear(const field::FunctionPtr& where) const {
    const double depth = std::min(p_.bedding, 0.75 * site_.amplitude);
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
    result.report = {{"tools", std::int64_t{0}}, {"primitives", std::int64_t{0}}};
    return result;
  }
  return Digging(ground, p, progress).run();
}

}  // namespace

const LandformType& landform_prism_field() {
  static const LandformType type{
      .about = {.name = "prism-field",
                .doc = "Ground as layers of columns, dug and built with spheres, capsules, boxes and hulls",
                .source = "Boggus and Crawfis [Boggus], section 3 and figures 7 and 8",
                .params = table().infos()},
      .generate = &generate,
  };
  return type;
}

}  // namespace tafoni::landforms
