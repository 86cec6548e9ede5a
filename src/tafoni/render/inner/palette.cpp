// The colours of ground: rock by its resistance with beds, stains and rust; plants on treads; sand,
// wetness and weed at the sea. All of it fades where vertices lie too far apart to hold it.

#include "tafoni/render/inner/palette.h"

#include <algorithm>
#include <cmath>

#include "tafoni/math/noise.h"
#include "tafoni/math/smoothstep.h"

namespace tafoni::render {
namespace {

// Linear reflectances, chosen by eye from photographs of limestone and sandstone coasts.
constexpr Vec3f soft_rock{0.36f, 0.235f, 0.125f}, middle_rock{0.305f, 0.235f, 0.165f},
    hard_rock{0.25f, 0.225f, 0.195f};
constexpr Vec3f meadow{0.066f, 0.083f, 0.030f}, dry_grass{0.155f, 0.130f, 0.055f},
    soil{0.155f, 0.105f, 0.062f};
constexpr Vec3f sand{0.37f, 0.295f, 0.20f}, weed{0.045f, 0.05f, 0.03f}, clay{0.23f, 0.16f, 0.10f};
constexpr Vec3f rust_stain{0.40f, 0.21f, 0.10f}, desert_varnish{0.52f, 0.25f, 0.12f};

// How strongly each texture shows, as a share of the rock's brightness.
constexpr float beds_contrast = 0.55f;  // the most: beds are what tells a cliff's size
constexpr float stain_contrast = 0.16f, blotch_contrast = 0.18f;  // only break up what would be one colour
// z of the normal above which a face is a tread, on which beds no longer show.
constexpr float face_from = 0.75f, tread_from = 0.98f;
// Soil lies on slopes that are a little too steep for grass (z of the normal, from bare to covered).
constexpr float soil_from = 0.62f, soil_full = 0.78f, grass_from = 0.72f, grass_full = 0.86f;
// Metres above the sea between which spray keeps plants away; sand, wetness and weed end at these heights.
constexpr float spray_from = 2.0f, spray_ends = 7.0f;
constexpr float beach_full = 2.0f, beach_ends = 4.5f, wet_full = 0.2f, wet_ends = 1.6f, weed_full = -0.6f,
                weed_ends = 0.8f;
constexpr float wet_darkening = 0.45f, weed_cover = 0.45f;
// A texture begins to fade where vertices lie this share of its wavelength apart, and is gone at the second.
constexpr float fade_from = 0.25f, fade_gone = 0.7f;

constexpr std::uint64_t texture_seed = 0x7af0;

/// Each texture's noise has a stream of its own.
enum class PaletteStream : std::uint64_t {
  beds = 1,
  banks,
  stain,
  blotch,
  dry_patches,
  dry_tufts,
  ragged_plants,
  ragged_shore,
  dry_country,
};

Vec3f mix(Vec3f a, Vec3f b, float t) {
  return a + (b - a) * t;
}

/// Noise in [-1, 1] of the given wavelength, fading to 0 where vertices are too far apart to hold it.
float texture(Vec3d p, Vec3d wavelength, float spacing, int octaves, PaletteStream stream) {
  const double shortest = std::min({wavelength.x, wavelength.y, wavelength.z});
  const float kept = 1 - smoothstep(fade_from, fade_gone, spacing / static_cast<float>(shortest));
  if (kept <= 0) return 0;
  return kept * 2 *
         (fbm({p.x / wavelength.x, p.y / wavelength.y, p.z / wavelength.z}, octaves,
              texture_seed + static_cast<std::uint64_t>(stream)) -
          0.5f);
}

Vec3f bare_rock(const GroundLook& s) {
  const float rho = std::clamp(s.resistance, 0.0f, 1.0f);
  Vec3f rock = rho < 0.5f ? mix(soft_rock, middle_rock, rho * 2) : mix(middle_rock, hard_rock, rho * 2 - 1);
  // Bedding: long along the strata, short across them; it shows on faces, not on treads.
  const float face = 1 - smoothstep(face_from, tread_from, std::abs(s.normal.z));
  const float beds = texture(s.position, {90, 90, 3.5}, s.spacing, 2, PaletteStream::beds) * 0.75f +
                     texture(s.position, {260, 260, 14}, s.spacing, 2, PaletteStream::banks) * 0.85f;
  const float stain = texture(s.position, {7, 7, 22}, s.spacing, 3, PaletteStream::stain);
  const float blotch = texture(s.position, {45, 45, 45}, s.spacing, 3, PaletteStream::blotch);
  rock = rock * (1 + beds_contrast * face * beds + stain_contrast * stain + blotch_contrast * blotch);
  // Iron: some beds run to rust.
  const float rust = std::clamp(0.55f * (beds + blotch) * face, 0.0f, 0.5f);
  const float desert = 0.55f * (1 - s.plants) * (1 - 0.4f * rho);
  return mix(mix(rock, desert_varnish, desert), rust_stain, rust * 0.6f);
}

/// Grass on treads above the spray, thinning to soil where it is steeper.
Vec3f grow_plants(const GroundLook& s, Vec3f rock) {
  const float dryness =
      0.42f + 0.5f * texture(s.position, {420, 420, 420}, s.spacing, 3, PaletteStream::dry_country) +
      0.55f * texture(s.position, {70, 70, 70}, s.spacing, 4, PaletteStream::dry_patches) +
      0.3f * texture(s.position, {9, 9, 9}, s.spacing, 2, PaletteStream::dry_tufts);
  const float ragged = 0.16f * texture(s.position, {16, 16, 16}, s.spacing, 3, PaletteStream::ragged_plants);
  const Vec3f grass = mix(meadow, dry_grass, std::clamp(dryness, 0.0f, 1.0f));
  const float above_spray = smoothstep(spray_from, spray_ends, s.height_above_sea + 12 * ragged);
  const float ground = smoothstep(soil_from, soil_full, s.normal.z + ragged) * above_spray;
  const float green = smoothstep(grass_from, grass_full, s.normal.z + ragged) * above_spray;
  return mix(mix(rock, soil, 0.7f * ground * s.plants), grass, green * s.plants);
}

/// Sand on flats at the sea, and a dark wet band.
Vec3f wash_shore(const GroundLook& s, Vec3f color) {
  const float ragged = texture(s.position, {12, 12, 12}, s.spacing, 2, PaletteStream::ragged_shore);
  const float h = s.height_above_sea + ragged;
  const float beach = smoothstep(0.80f, 0.93f, s.normal.z) * (1 - smoothstep(beach_full, beach_ends, h));
  color = mix(color, sand * (1 + 0.1f * ragged), beach);
  const float wet = 1 - smoothstep(wet_full, wet_ends, h);
  color = color * (1 - wet_darkening * wet);
  const float weedy = (1 - smoothstep(weed_full, weed_ends, h)) * (1 - beach);
  return mix(color, weed, weed_cover * weedy);
}

}  // namespace

Vec3f rock_palette(const GroundLook& point) {
  Vec3f color = bare_rock(point);
  if (point.roofed)
    color = mix(color, clay, 0.6f * smoothstep(0.6f, 0.9f, point.normal.z));
  else
    color = grow_plants(point, color);
  color = wash_shore(point, color);
  return {std::clamp(color.x, 0.0f, 1.0f), std::clamp(color.y, 0.0f, 1.0f), std::clamp(color.z, 0.0f, 1.0f)};
}

std::array<std::uint8_t, 4> to_rgba8(Vec3f linear) {
  const auto byte = [](float v) { return static_cast<std::uint8_t>(std::clamp(v, 0.0f, 1.0f) * 255 + 0.5f); };
  return {byte(linear.x), byte(linear.y), byte(linear.z), 255};
}

}  // namespace tafoni::render
