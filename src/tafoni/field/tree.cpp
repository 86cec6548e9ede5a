// Makes the nodes of trees, checks what they are made from, and walks trees without recursion for their
// support and statistics.

#include "tafoni/field/tree.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <unordered_set>

#include "tafoni/core/random.h"
#include "tafoni/field/impl/node.h"

namespace tafoni::field {

Node::Node(Content c) : content(std::move(c)) {
  if (const auto* op = operation()) {
    for (const NodePtr& child : op->children) depth = std::max(depth, child->depth);
  } else if (const auto* own = nested()) {
    const NodePtr child = own->child();
    depth = 1 + std::max(own->depth_below(), child ? child->depth : 0);
  }
}

Node::~Node() {
  auto* own = std::get_if<Operation>(&content);
  if (!own) return;
  std::vector<NodePtr> pending = std::move(own->children);
  while (!pending.empty()) {
    const NodePtr node = std::move(pending.back());
    pending.pop_back();
    if (node.use_count() != 1) continue;
    // The last owner may take the children apart: nobody else can see the node any more.
    if (auto* op = std::get_if<Operation>(&const_cast<Node&>(*node).content)) {
      std::move(op->children.begin(), op->children.end(), std::back_inserter(pending));
      op->children.clear();
    }
  }
}

NodePtr heightfield(std::shared_ptr<const raster::Raster> heights, const HeightfieldSettings& settings) {
  for (float h : heights->values.values())
    if (!std::isfinite(h))
      fail(ErrorKind::internal, "a heightfield must be filled before it becomes a field");
  return std::make_shared<Node>(impl::HeightLeaf{impl::Sampler(std::move(heights), settings.bicubic),
                                                 impl::Sigma(settings), settings.first_order});
}

NodePtr domain(const Domain& domain, const HeightfieldSettings& settings) {
  if (!(domain.box.lo.x < domain.box.hi.x) || !(domain.box.lo.y < domain.box.hi.y))
    fail(ErrorKind::usage, "the domain is empty");
  return std::make_shared<Node>(impl::DomainLeaf{
      domain, domain.inside ? std::make_unique<impl::Sampler>(domain.inside, false) : nullptr,
      impl::Sigma(settings)});
}

NodePtr constant(float value) {
  if (!std::isfinite(value)) fail(ErrorKind::usage, "a constant field must be finite");
  return std::make_shared<Node>(value);
}

struct CloudBuilder::State {
  const PrimitiveType* type;
  float falloff;
  impl::Noise noise;
  std::vector<impl::Cloud::Record> records;
  std::vector<float> pool;
};

CloudBuilder::CloudBuilder(const CloudSettings& settings) : state_(std::make_unique<State>()) {
  state_->type = &find_primitive(settings.kind);
  if (!(settings.falloff > 0) || !std::isfinite(settings.falloff))
    fail(ErrorKind::usage, "a cloud's falloff must be a positive length in metres");
  const MetricNoise& noise = settings.noise;
  if (noise.amplitude < 0 || !(noise.wavelength > 0) || noise.octaves < 1 || noise.octaves > 12)
    fail(ErrorKind::usage, "a cloud's noise wants amplitude >= 0, wavelength > 0 and 1 to 12 octaves");
  state_->falloff = static_cast<float>(settings.falloff);
  state_->noise = {static_cast<float>(noise.amplitude), static_cast<float>(1 / noise.wavelength),
                   noise.octaves, static_cast<std::uint32_t>(mix64(noise.seed))};
}
CloudBuilder::~CloudBuilder() = default;
CloudBuilder::CloudBuilder(CloudBuilder&&) noexcept = default;
CloudBuilder& CloudBuilder::operator=(CloudBuilder&&) noexcept = default;

void CloudBuilder::add(Vec3d anchor, float energy, std::span<const float> shape) {
  State& s = *state_;
  const PrimitiveType& type = *s.type;
  const std::size_t extras = shape.empty() ? 0 : shape.size() - 1;
  const std::size_t group = type.extras;
  const bool fits = type.variable ? extras >= group && extras % group == 0 : extras == group;
  if (shape.empty() || !fits)
    fail(ErrorKind::input, "a {} primitive cannot have {} shape numbers", type.about.name, shape.size());
  bool finite =
      std::isfinite(energy) && std::isfinite(anchor.x) && std::isfinite(anchor.y) && std::isfinite(anchor.z);
  for (float v : shape) finite = finite && std::isfinite(v);
  if (!finite) fail(ErrorKind::input, "a {} primitive has a number that is not finite", type.about.name);
  if (!(shape[0] > 0))
    fail(ErrorKind::input, "a {} primitive has radius {} m; it must be positive", type.about.name, shape[0]);
  // Noise as deep as the rounding would reach into a body, where there is nothing to perturb.
  if ((!type.volumetric || group > 0) && s.noise.amplitude >= shape[0])
    fail(ErrorKind::input, "a {} primitive of radius {} m is thinner than its noise of {} m", type.about.name,
         shape[0], s.noise.amplitude);
  for (std::size_t i = 1; i < shape.size(); ++i) {
    const ParamInfo& info = type.about.params[1 + (i - 1) % group];
    const double value = shape[i];
    if (value < info.min || value > info.max)
      fail(ErrorKind::input, "a {} primitive has {} = {}; it must be {}", type.about.name, info.name,
           shape[i], allowed(info));
  }
  const double far = std::max({std::fabs(anchor.x), std::fabs(anchor.y), std::fabs(anchor.z)});
  if (far + type.extent(shape.subspan(1)) + shape[0] > impl::reach_limit)
    fail(ErrorKind::input, "a {} primitive lies {:.0f} m from the scene's origin; the limit is {:.0f} m",
         type.about.name, far, impl::reach_limit);
  s.records.push_back(
      {{impl::to_fixed(anchor.x).units, impl::to_fixed(anchor.y).units, impl::to_fixed(anchor.z).units},
       shape[0],
       energy,
       static_cast<std::uint32_t>(s.pool.size()),
       static_cast<std::uint32_t>(extras)});
  s.pool.insert(s.pool.end(), shape.begin() + 1, shape.end());
}

std::size_t CloudBuilder::size() const {
  return state_->records.size();
}

NodePtr CloudBuilder::finish() {
  State& s = *state_;
  auto node = std::make_shared<Node>(impl::Cloud(*s.type, s.falloff, s.noise, std::move(s.records), s.pool));
  s.records.clear();
  s.pool.clear();
  return node;
}

void add_point(CloudBuilder& cloud, Vec3d center, double radius, double energy) {
  const float shape[] = {static_cast<float>(radius)};
  cloud.add(center, static_cast<float>(energy), shape);
}

void add_segment(CloudBuilder& cloud, Vec3d from, Vec3d to, double radius, double energy) {
  const Vec3f d = to_float(to - from);
  const float shape[] = {static_cast<float>(radius), d.x, d.y, d.z};
  cloud.add(from, static_cast<float>(energy), shape);
}

void add_curve(CloudBuilder& cloud, std::span<const Vec3d> points, double radius, double energy,
               double tolerance) {
  constexpr double most_chords =
      256;  // between two points, however small the tolerance: beyond it none is seen
  if (points.size() < 2) fail(ErrorKind::input, "a curve wants at least two points");
  if (!(tolerance > 0)) fail(ErrorKind::usage, "a curve's tolerance must be a positive length in metres");
  std::vector<float> shape{static_cast<float>(radius)};
  const auto at = [&](std::ptrdiff_t i) {
    return points[std::clamp<std::ptrdiff_t>(i, 0, std::ssize(points) - 1)];
  };
  for (std::ptrdiff_t i = 0; i + 1 < std::ssize(points); ++i) {
    const Vec3d p0 = at(i - 1), p1 = at(i), p2 = at(i + 1), p3 = at(i + 2);
    const Vec3d a = p1 * 3.0 - p0 - p2 * 3.0 + p3, b = p0 * 2.0 - p1 * 5.0 + p2 * 4.0 - p3, c = p2 - p0;
    // A chord over a parameter step s strays at most s^2 / 8 times the greatest second derivative.
    const double bend = std::max(length(b), length(a * 3.0 + b));
    const double wanted = std::ceil(std::sqrt(bend / (8 * tolerance)));
    const int steps = static_cast<int>(std::clamp(std::isfinite(wanted) ? wanted : 1.0, 1.0, most_chords));
    for (int k = 1; k <= steps; ++k) {
      const double t = 1.0 * k / steps;
      const Vec3d p = k == steps ? p2 : p1 + ((a * t + b) * t + c) * (0.5 * t);
      const Vec3f d = to_float(p - points[0]);
      shape.insert(shape.end(), {d.x, d.y, d.z});
    }
  }
  cloud.add(points[0], static_cast<float>(energy), shape);
}

NodePtr combine(std::string_view op, std::vector<NodePtr> trees) {
  const OperatorType& type = find_operator(op);
  if (!type.combination)
    fail(ErrorKind::usage, "{} does not combine trees by value; it has a function of its own", op);
  std::erase(trees, nullptr);
  if (trees.empty()) fail(ErrorKind::usage, "{} has no operands", op);
  if (trees.size() == 1) return trees.front();
  const float parameter =
      type.about.params.empty() ? 0.f : static_cast<float>(std::get<double>(type.about.params.front().init));
  return std::make_shared<Node>(Node::Operation{&type, std::move(trees), parameter});
}

NodePtr blend(std::vector<NodePtr> trees) {
  return combine("blend", std::move(trees));
}
NodePtr unite(std::vector<NodePtr> trees) {
  return combine("union", std::move(trees));
}
NodePtr intersect(std::vector<NodePtr> trees) {
  return combine("intersection", std::move(trees));
}
NodePtr subtract(NodePtr from, NodePtr what) {
  return combine("difference", {std::move(from), std::move(what)});
}

namespace {

NodePtr combine_two(std::string_view op, NodePtr a, NodePtr b, double parameter) {
  const OperatorType& type = find_operator(op);
  check_value(type.about.params.front(), parameter, op);
  return std::make_shared<Node>(
      Node::Operation{&type, {std::move(a), std::move(b)}, static_cast<float>(parameter)});
}

}  // namespace

NodePtr morph(NodePtr a, NodePtr b, double alpha) {
  if (alpha == 0) return a;
  if (alpha == 1) return b;
  return combine_two("morph", std::move(a), std::move(b), alpha);
}

NodePtr round_edge(NodePtr a, NodePtr b, double width) {
  return combine_two("round", std::move(a), std::move(b), width);
}

namespace {

/// What `node` is 0 outside of, given the same of its children.
Box3d support_of(const Node& node, const std::unordered_map<const Node*, Box3d>& known) {
  if (const auto* cloud = node.cloud()) {
    if (cloud->size() == 0) return {};
    return {to_double(cloud->bounds().lo), to_double(cloud->bounds().hi)};
  }
  if (const auto* value = std::get_if<float>(&node.content))
    return *value == 0 ? Box3d{} : Box3d::everything();
  if (const auto* nested = node.nested()) {
    const NodePtr child = nested->child();
    return nested->support(child ? known.at(child.get()) : Box3d{});
  }
  const auto* op = node.operation();
  if (!op) return Box3d::everything();
  const Interval nothing = op->type->combination->interval({0, 0}, {0, 0}, op->parameter);
  if (nothing.lo != 0 || nothing.hi != 0) return Box3d::everything();
  Box3d box;
  for (const NodePtr& child : op->children) box.expand(known.at(child.get()));
  return box;
}

/// Calls visit(node) once for every node, children before parents, without recursion.
template <class Visit>
void each_node(const Node* root, const Visit& visit) {
  std::unordered_set<const Node*> seen;
  struct Frame {
    const Node* node;
    std::size_t next = 0;
  };
  std::vector<Frame> frames;
  const auto enter = [&](const Node* node) {
    if (node && seen.insert(node).second) frames.push_back({node});
  };
  enter(root);
  while (!frames.empty()) {
    Frame& frame = frames.back();
    const std::size_t next = frame.next++;
    if (const auto* op = frame.node->operation(); op && next < op->children.size()) {
      enter(op->children[next].get());
    } else if (const auto* nested = frame.node->nested(); nested && next == 0) {
      enter(nested->child().get());
    } else {
      visit(*frame.node);
      frames.pop_back();
    }
  }
}

}  // namespace

Box3d support(const NodePtr& tree) {
  std::unordered_map<const Node*, Box3d> known;
  each_node(tree.get(), [&](const Node& node) { known[&node] = support_of(node, known); });
  return tree ? known.at(tree.get()) : Box3d{};
}

TreeStats stats(const NodePtr& root) {
  TreeStats total;
  each_node(root.get(), [&](const Node& node) {
    total.bytes += sizeof(Node);
    if (const auto* cloud = node.cloud()) {
      total.nodes += cloud->size();
      total.primitives += cloud->size();
      total.bytes += cloud->bytes();
    } else if (const auto* nested = node.nested()) {
      total.nodes += nested->count();
      total.bytes += nested->bytes();
    } else {
      ++total.nodes;
    }
    if (const auto* op = node.operation()) total.bytes += op->children.size() * sizeof(NodePtr);
  });
  return total;
}

}  // namespace tafoni::field
