#include "tafoni/render/inner/palette.h"

#include <algorithm>
#include <cmath>

#include "tafoni/math/noise.h"

namespace tafoni::render {
namespace {

// Linear reflectances, chosen by eye from photographs of limestone and sandstone coasts.
constexpr Vec3f soft_rock{0.36f, 0.235f, 0.125f}, middle_rock{0.305f, 0.235f, 0.165f},
    hard_rock{0.25f, 0.225f, 0.195f};
constexpr Vec3f meadow{0.066f, 0.083f, 0.030f}, dry_grass{0.155f, 0.130f, 0.055f},
    soil{0.155f, 0.105f, 0.062f};
constexpr Vec3f sand{0.37f, 0.295f, 0.20f}, weed{0.045f, 0.05f, 0.03f}, clay{0.23f, 0.16f, 0.10f};
constexpr std::uint64_t texture_seed = 0x7af0;

Vec3f mix(Vec3f a, Vec3f b, float t) {
  return a + (b - a) * t;
}

float smooth(float from, float to, float x) {
  const float t = std::clamp((x - from) / (to - from), 0.0f, 1.0f);
  return t * t * (3 - 2 * t);
}

/// Noise in [-1, 1] of the given wavelength, fading to 0 where vertices are too far apart to hold it.
float texture(Vec3d p, Vec3d wavelength, float spacing, int octaves, std::uint64_t seed) {
  const double shortest = std::min({wavelength.x, wavelength.y, wavelength.z});
  const float kept = 1 - smooth(0.25f, 0.7f, spacing / static_cast<float>(shortest));
  if (kept <= 0) return 0;
  return kept * 2 *
         (fbm({p.x / wavelength.x, p.y / wavelength.y, p.z / wavelength.z}, octaves, texture_seed + seed) -
          0.5f);
}

Vec3f bare_rock(const GroundLook& s) {
  const float rho = std::clamp(s.resistance, 0.0f, 1.0f);
  Vec3f rock = rho < 0.5f ? mix(soft_rock, middle_rock, rho * 2) : mix(middle_rock, hard_rock, rho * 2 - 1);
  // Bedding: long along the strata, short across them; it shows on faces, not on treads.
  const float face = 1 - smooth(0.75f, 0.98f, std::abs(s.normal.z));
  const float beds = texture(s.position, {90, 90, 3.5}, s.spacing, 2, 1) * 0.75f +
                     texture(s.position, {260, 260, 14}, s.spacing, 2, 2) * 0.85f;
  const float stain = texture(s.position, {7, 7, 22}, s.spacing, 3, 3);
  const float blotch = texture(s.position, {45, 45, 45}, s.spacing, 3, 4);
  rock = rock * (1 + 0.55f * face * beds + 0.16f * stain + 0.18f * blotch);
  // Iron: some beds run to rust.
  const float rust = std::clamp(0.55f * (beds + blotch) * face, 0.0f, 0.5f);
  const float desert = 0.55f * (1 - s.plants) * (1 - 0.4f * rho);
  return mix(mix(rock, {0.52f, 0.25f, 0.12f}, desert), {0.40f, 0.21f, 0.10f}, rust * 0.6f);
}

/// Grass on treads above the spray, thinning to soil where it is steeper.
Vec3f with_plants(const GroundLook& s, Vec3f rock) {
  const float dryness = 0.42f + 0.5f * texture(s.position, {420, 420, 420}, s.spacing, 3, 9) +
                        0.55f * texture(s.position, {70, 70, 70}, s.spacing, 4, 5) +
                        0.3f * texture(s.position, {9, 9, 9}, s.spacing, 2, 6);
  const float ragged = 0.16f * texture(s.position, {16, 16, 16}, s.spacing, 3, 7);
  const Vec3f grass = mix(meadow, dry_grass, std::clamp(dryness, 0.0f, 1.0f));
  const float above_spray = smooth(2.0f, 7.0f, s.height_above_sea + 12 * ragged);
  const float ground = smooth(0.62f, 0.78f, s.normal.z + ragged) * above_spray;
  const float green = smooth(0.72f, 0.86f, s.normal.z + ragged) * above_spray;
  return mix(mix(rock, soil, 0.7f * ground * s.plants), grass, green * s.plants);
}

/// Sand on flats at the sea, and a dark wet band.
Vec3f with_shore(const GroundLook& s, Vec3f color) {
  const float ragged = texture(s.position, {12, 12, 12}, s.spacing, 2, 8);
  const float h = s.height_above_sea + ragged;
  const float beach = smooth(0.80f, 0.93f, s.normal.z) * (1 - smooth(2.0f, 4.5f, h));
  color = mix(color, sand * (1 + 0.1f * ragged), beach);
  const float wet = 1 - smooth(0.2f, 1.6f, h);
  color = color * (1 - 0.45f * wet);
  const float weedy = (1 - smooth(-0.6f, 0.8f, h)) * (1 - beach);
  return mix(color, weed, 0.45f * weedy);
}

}  // namespace

Vec3f rock_palette(const GroundLook& point) {
  Vec3f color = bare_rock(point);
  if (point.roofed)
    color = mix(color, clay, 0.6f * smooth(0.6f, 0.9f, point.normal.z));
  else
    color = with_plants(point, color);
  color = with_shore(point, color);
  return {std::clamp(color.x, 0.0f, 1.0f), std::clamp(color.y, 0.0f, 1.0f), std::clamp(color.z, 0.0f, 1.0f)};
}

std::array<std::uint8_t, 4> to_rgba8(Vec3f linear) {
  const auto byte = [](float v) { return static_cast<std::uint8_t>(std::clamp(v, 0.0f, 1.0f) * 255 + 0.5f); };
  return {byte(linear.x), byte(linear.y), byte(linear.z), 255};
}

}  // namespace tafoni::render
