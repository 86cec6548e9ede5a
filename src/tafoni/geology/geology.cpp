#include "tafoni/geology/geology.h"

#include <algorithm>
#include <array>

#include "tafoni/core/parallel.h"

namespace tafoni::geology {
namespace {

constexpr int block = 512;            // points whose values fit the cache
constexpr std::int64_t grain = 8192;  // points that are worth a thread of their own

double clamp_to_range(double rho) {
  return std::clamp(rho, 0.0, 1.0);
}

/// The clamped resistances of points, block by block.
void write_resistances(const Geology& geology, std::span<const Vec3d> points, std::span<float> out) {
  std::array<double, block> rho;
  for (std::size_t i = 0; i < points.size(); i += block) {
    const std::size_t n = std::min<std::size_t>(block, points.size() - i);
    geology.raws(points.subspan(i, n), std::span(rho).first(n));
    for (std::size_t k = 0; k < n; ++k) out[i + k] = static_cast<float>(clamp_to_range(rho[k]));
  }
}

class Resistance final : public field::Function {
 public:
  explicit Resistance(GeologyPtr geology) : geology_(std::move(geology)) {}
  void values(std::span<const Vec3d> points, std::span<float> out) const override {
    write_resistances(*geology_, points, out);
  }
  Interval range(const Box3d&) const override { return {0, 1}; }

 private:
  GeologyPtr geology_;
};

}  // namespace

field::FunctionPtr as_function(GeologyPtr geology) {
  return geology ? std::make_shared<const Resistance>(std::move(geology)) : nullptr;
}

void Geology::raws(std::span<const Vec3d> points, std::span<double> out) const {
  for (std::size_t i = 0; i < points.size(); ++i) out[i] = raw(points[i]);
}

double Geology::resistance(Vec3d p) const {
  return clamp_to_range(raw(p));
}

void Geology::resistances(std::span<const Vec3d> points, std::span<float> out) const {
  const auto work = [&](std::int64_t begin, std::int64_t end) {
    write_resistances(*this, points.subspan(begin, end - begin), out.subspan(begin, end - begin));
  };
  const std::int64_t n = std::ssize(points);
  if (n <= grain)
    work(0, n);
  else
    parallel_blocks(n, grain, work);
}

}  // namespace tafoni::geology
