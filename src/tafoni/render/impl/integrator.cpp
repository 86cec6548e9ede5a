// The light along one ray: sun, sky and lamp on what it meets, one bounce of them, the sea's surface with
// what it mirrors and what lies below, and the backdrop with the mesh's shadow.

#include "tafoni/render/impl/integrator.h"

#include "tafoni/math/noise.h"

namespace tafoni::render::impl {
namespace {

// Water, chosen by eye.
constexpr float wave_steepness = 0.03f;  // a light breeze
constexpr float wave_pixels = 12;  // waves of this many pixels look like water at any scale and never alias
constexpr float deep_mirror = 0.15f;  // share of the sky that the sea around passes on to rock
// Times as much water seems to lie over the floor beyond the edge of the data, by the distance d from a line
// a little inside of it, in sizes of the mesh: 1 + a d + b d^2. A few sizes out no floor is seen.
constexpr float edge_inside = 0.06f, deepen_linear = 25, deepen_square = 150;

// Roughness finer than the mesh.
constexpr float coarsest = 2.5f;  // wavelengths in spacings: just below what vertices hold
constexpr float octave_step = 0.47f, octave_share = 0.87f;
constexpr int octaves = 12;                            // down to what a pixel shows
constexpr float tint = 0.18f, tilt_strength = 0.055f;  // seen, but changes no outline

// The lamp of cave pictures.
constexpr Vec3f lamp_light{2.15f, 1.9f, 1.6f};     // warm
constexpr Vec3f cave_fill{0.075f, 0.08f, 0.092f};  // a faint cool light, so that no wall is black
constexpr float fill_reach = 0.4f;  // of the lamp's reach: half of the fill is there at this distance
constexpr float lamp_floor = 0.3f, lamp_power = 1.6f;  // gentler than the inverse square, see lamp_on()

// The mesh's shadow on the backdrop.
constexpr float shadow_strength = 0.85f;
constexpr float shadow_full = 1.0f, shadow_ends = 2.2f;  // half sizes of the mesh from its middle

/// The slope of small waves: noise of the two wavelengths, powers of two, that are nearest to `wavelength`.
Vec3f wave_normal(Vec3f p, float wavelength) {
  const float level = std::log2(wavelength), whole = std::floor(level), part = level - whole;
  constexpr float step = 0.15f;  // wavelengths
  Vec3f slope;
  for (const float k : {0.0f, 1.0f}) {
    const double scale = std::exp2(-(whole + k));
    const double x = p.x * scale, y = p.y * scale;
    const auto height = [](double u, double v) { return simplex({u, v * 1.6, 0.5}, 99); };
    const float here = height(x, y), share = k > 0 ? part : 1 - part;
    slope +=
        Vec3f{here - height(x + step, y), here - height(x, y + step), 0} * (share * wave_steepness / step);
  }
  return normalized(Vec3f{slope.x, slope.y, 1});
}

/// Roughness finer than the mesh can hold, down to what a pixel shows: it tints and tilts by a little. It
/// gives bare walls a scale however near they are, and changes no outline.
void roughen(Surface& s, float spacing, float pixel) {
  const auto smoothly = [](Vec3f p, double scale) {
    return simplex({p.x * scale, p.y * scale, p.z * scale * 1.8}, 7);
  };
  // Half creased, since rock weathers along cracks; all of it would be a net.
  const auto noise = [&](Vec3f p, double scale) {
    const float n = smoothly(p, scale), off = 2 * n - 1;
    return 0.5f * (n + std::sqrt(off * off + 0.01f));
  };
  float wavelength = coarsest * spacing, share = 1;
  // Some places are rougher than others.
  const float rough = 0.4f + 1.2f * smoothly(s.position, 0.11 / wavelength);
  for (int octave = 0; octave < octaves; ++octave, wavelength *= octave_step, share *= octave_share) {
    const float shown = share * rough * smoothstep(2.0f, 5.0f, wavelength / pixel);
    if (shown <= 0) return;
    const double scale = 1 / wavelength;
    const float here = noise(s.position, scale), step = 0.1f * wavelength;
    s.albedo = s.albedo * (1 + tint * shown * (here - 0.45f));
    const float tilt = tilt_strength * shown / 0.1f;
    const Vec3f slope{noise(s.position + Vec3f{step, 0, 0}, scale) - here,
                      noise(s.position + Vec3f{0, step, 0}, scale) - here,
                      noise(s.position + Vec3f{0, 0, step}, scale) - here};
    s.normal = normalized(s.normal - slope * tilt);
  }
}

}  // namespace

Vec3f Integrator::under_sea(Vec3f light, Vec3f position) const {
  return light_.sea && position.z < *light_.sea ? times(light, Light::through_water(*light_.sea - position.z))
                                                : light;
}

Vec3f Integrator::beyond(Vec3f direction) const {
  if (light_.lamp && direction.z < 0) return {};
  if (!light_.sea || direction.z >= 0) return light_.sky(direction);
  return mix(Light::water * 2.0f, light_.sky({direction.x, direction.y, -direction.z}), deep_mirror);
}

Vec3f Integrator::sun_on(const Surface& s, Point2 random) const {
  const Vec3f d = cone_direction(light_.to_sun, light_.sun_radius, random);
  const float facing = dot(s.normal, d);
  if (facing <= 0 || d.z <= 0) return {};
  if (world_.tracer().blocked(s.start, d)) return {};
  return under_sea(Light::sun * facing, s.position);
}

Vec3f Integrator::lamp_on(const Surface& s, Point2 random) const {
  const Lamp& lamp = *light_.lamp;
  const float around = 6.2831853f * random.v, out = lamp.radius * std::sqrt(random.u);
  const Vec3f to = lamp.position + Vec3f{out * std::cos(around), out * std::sin(around), 0} - s.position;
  const float distance = length(to);
  const Vec3f d = to * (1 / std::max(distance, 1e-6f));
  const float facing = dot(s.normal, d);
  if (facing <= 0) return {};
  if (world_.tracer().blocked(s.start, d, distance * 0.999f)) return {};
  // Gentler than the inverse square, or near walls would burn out before far ones are seen.
  const float near = distance / lamp.reach;
  return lamp_light * (facing / (lamp_floor + std::pow(near, lamp_power)));
}

Vec3f Integrator::bounce(const Hit& hit, Vec3f from, Vec3f direction, const Sampler& sampler) const {
  const Surface s = world_.surface(hit, from, direction, colors_);
  // In a cave the lamp is what walls pass on; daylight that comes round two corners is left out.
  if (light_.lamp) return times(s.albedo, lamp_on(s, sampler.get(Stream::bounce_lamp)));
  Vec3f light = sun_on(s, sampler.get(Stream::bounce_sun));
  const Vec3f up = cosine_direction(s.normal, sampler.get(Stream::bounce_sky));
  if (!world_.tracer().blocked(s.start, up)) light += under_sea(beyond(up), s.position);
  return times(s.albedo, light);
}

Vec3f Integrator::sky_on(const Surface& s, const Sampler& sampler) const {
  const Vec3f d = cosine_direction(s.normal, sampler.get(Stream::sky));
  const Hit hit = world_.tracer().closest(s.start, d);
  if (!hit) return under_sea(beyond(d), s.position);
  Vec3f light = bounce(hit, s.start, d, sampler);
  // A faint fill that open space has more of than crevices, so that no wall of a cave is black.
  if (light_.lamp) light += cave_fill * (hit.t / (hit.t + fill_reach * light_.lamp->reach));
  return light;
}

Integrator::Lit Integrator::light_on(const Surface& s, const Sampler& sampler) const {
  Lit lit;
  lit.direct = sun_on(s, sampler.get(Stream::sun));
  if (light_.lamp) lit.direct += lamp_on(s, sampler.get(Stream::lamp));
  lit.indirect = sky_on(s, sampler);
  return lit;
}

Sample Integrator::solid(Vec3f from, Vec3f direction, const Hit& hit, float footprint,
                         const Sampler& sampler) const {
  Surface s = world_.surface(hit, from, direction, colors_);
  roughen(s, world_.spacing(), footprint * hit.t);
  const Lit light = light_on(s, sampler);
  return {times(s.albedo, light.direct + light.indirect), light.indirect, s.albedo, s.normal, hit.t};
}

float Integrator::deepening(Vec3f p) const {
  if (!light_.sea_floor) return 1;
  const Box3f& box = world_.box();
  const float size = length(box.size());
  const float x = std::max(box.lo.x - p.x, p.x - box.hi.x), y = std::max(box.lo.y - p.y, p.y - box.hi.y);
  const float outside = x > 0 && y > 0 ? std::sqrt(x * x + y * y) : std::max(x, y);
  const float beyond = std::max(0.0f, outside + edge_inside * size) / size;
  return 1 + deepen_linear * beyond + deepen_square * beyond * beyond;
}

Sample Integrator::floor_beyond(Vec3f from, Vec3f direction, const Sampler& sampler) const {
  const float drop = from.z - *light_.sea_floor;
  Sample sample;
  sample.t = drop / std::max(-direction.z, 0.05f);
  Surface s;
  s.position = s.start = from + direction * sample.t;
  sample.t *= deepening(s.position);
  s.normal = s.face = {0, 0, 1};
  s.albedo = light_.floor_albedo;
  sample.sky_light = light_.sky({0, 0, 1}) * 0.8f;
  sample.sky_weight = s.albedo;
  sample.normal = s.normal;
  sample.color =
      times(s.albedo, sun_on(s, sampler.get(Stream::sun)) + under_sea(sample.sky_light, s.position));
  return sample;
}

Sample Integrator::backdrop(Vec3f from, Vec3f direction, const Sampler& sampler) const {
  const Vec3f open = light_.backdrop(direction);
  const Box3f& box = world_.box();
  const float drop = from.z - box.lo.z;
  if (light_.lamp || light_.sea || direction.z >= 0 || drop <= 0) return {open, {}, {}, {}, far_away};
  Surface s;
  s.position = s.start = from + direction * (drop / -direction.z);
  s.normal = s.face = {0, 0, 1};
  const Vec3f aside = s.position - box.center();
  const float size = 0.5f * length(box.size());
  const float kept = 1 - smoothstep(shadow_full, shadow_ends, length(Vec3f{aside.x, aside.y, 0}) / size);
  if (kept <= 0) return {open, {}, {}, {}, far_away};
  // By brightness alone: the sky would make the shadow on a white floor blue.
  const Vec3f share = open * (shadow_strength * kept / luminance(light_.open_ground));
  const Lit light = light_on(s, sampler);
  const float lost = luminance(light_.open_ground) - luminance(light.direct + light.indirect);
  const Vec3f grey = Vec3f{1, 1, 1} * luminance(light.indirect);
  const Sample sample{open - share * lost, grey, share, s.normal, drop / -direction.z};
  return sample;
}

Sample Integrator::water(Vec3f from, Vec3f direction, float t_sea, const Hit& hit, float footprint,
                         const Sampler& sampler) const {
  const Vec3f p = from + direction * t_sea;
  const float slant = std::max(-direction.z, 0.02f);
  const Vec3f n = wave_normal(p, wave_pixels * footprint * t_sea / std::sqrt(slant));
  const float facing = std::clamp(-dot(n, direction), 0.02f, 1.0f);
  const float mirror = 0.02f + 0.98f * std::pow(1 - facing, 5.0f);
  Vec3f r = direction + n * (2 * facing);
  r.z = std::max(r.z, 0.01f);
  r = normalized(r);

  const Vec3f start = p + Vec3f{0, 0, 1} * world_.offset();
  const Hit mirrored = world_.tracer().closest(start, r);
  Vec3f reflection = light_.sky(r);
  if (mirrored) {
    const Surface s = world_.surface(mirrored, start, r, colors_);
    const Vec3f ambient = mix(Light::ground, Light::zenith, 0.5f + 0.5f * s.normal.z) * 0.5f;
    reflection = times(s.albedo, sun_on(s, sampler.get(Stream::mirror)) + ambient);
  }
  // The ray goes on straight, not refracted, so that what stands in the water keeps its shape.
  Sample below{};
  Vec3f clear{};
  const Vec3f below_position = from + direction * hit.t;
  if (hit && !(light_.sea_floor && world_.is_border(below_position, hit.face))) {
    below = solid(from, direction, hit, footprint, sampler);
    clear = Light::through_water((hit.t - t_sea) * deepening(below_position));
  } else if (light_.sea_floor) {
    below = floor_beyond(p, direction, sampler);
    clear = Light::through_water(below.t);
    below.t = t_sea + below.t;
  }
  const float shine = light_.lamp ? 0.05f : 0.35f + 0.65f * std::max(0.0f, light_.to_sun.z);
  const Vec3f scattered = Light::water * (2.2f * shine);
  const Vec3f body = times(below.color, clear) + times(scattered, Vec3f{1, 1, 1} - clear);
  Sample result = below;
  result.color = reflection * mirror + body * (1 - mirror);
  result.sky_weight = times(below.sky_weight, clear) * (1 - mirror);
  if (result.t == far_away) result.t = t_sea;
  return result;
}

Sample Integrator::eye_ray(Vec3f from, Vec3f direction, float footprint, const Sampler& sampler) const {
  const Hit hit = world_.tracer().closest(from, direction);
  const float t_sea =
      light_.sea && from.z > *light_.sea && direction.z < 0 ? (*light_.sea - from.z) / direction.z : far_away;
  Sample sample;
  if (t_sea < hit.t)
    sample = water(from, direction, t_sea, hit, footprint, sampler);
  else if (hit)
    sample = solid(from, direction, hit, footprint, sampler);
  else
    return backdrop(from, direction, sampler);
  const float t = std::min(t_sea, hit.t);
  const float clear = std::exp(-light_.haze_per_metre * std::max(0.0f, t - light_.haze_begin));
  sample.color = light_.hazy(sample.color, t);
  sample.sky_weight = sample.sky_weight * clear;
  return sample;
}

}  // namespace tafoni::render::impl
