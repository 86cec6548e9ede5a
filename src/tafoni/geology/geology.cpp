#include "tafoni/geology/geology.h"

#include <algorithm>
#include <array>

#include "tafoni/core/parallel.h"

namespace tafoni::geology {
namespace {

constexpr std::size_t block = 512;
constexpr std::int64_t grain = 8192;

double clamped(double rho) {
  return std::clamp(rho, 0.0, 1.0);
}

class Resistance final : public field::Function {
 public:
  explicit Resistance(GeologyPtr geology) : geology_(std::move(geology)) {}
  void values(std::span<const Vec3d> points, std::span<float> out) const override {
    std::array<double, block> rho;
    for (std::size_t i = 0; i < points.size(); i += block) {
      const std::size_t n = std::min(block, points.size() - i);
      geology_->raws(points.subspan(i, n), std::span(rho).first(n));
      for (std::size_t k = 0; k < n; ++k) out[i + k] = static_cast<float>(clamped(rho[k]));
    }
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
  return clamped(raw(p));
}

void Geology::resistances(std::span<const Vec3d> points, std::span<float> out) const {
  const auto work = [&](std::int64_t begin, std::int64_t end) {
    std::array<double, block> rho;
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); i += block) {
      const std::size_t n = std::min(block, static_cast<std::size_t>(end) - i);
      raws(points.subspan(i, n), std::span(rho).first(n));
      for (std::size_t k = 0; k < n; ++k) out[i + k] = static_cast<float>(clamped(rho[k]));
    }
  };
  const auto n = static_cast<std::int64_t>(points.size());
  if (n <= grain)
    work(0, n);
  else
    parallel_blocks(n, grain, work);
}

}  // namespace tafoni::geology
