#include "tafoni/render/impl/integrator.h"

#include "tafoni/math/noise.h"

namespace tafoni::render::impl {
namespace {

/// The slope of small waves: noise of the two wavelengths, powers of two, that are nearest to `wavelength`.
Vec3f wave_normal(Vec3f p, float wavelength) {
  const float level = std::log2(wavelength), whole = std::floor(level), part = level - whole;
  constexpr float step = 0.15f, steepness = 0.03f;
  Vec3f slope;
  for (const float k : {0.0f, 1.0f}) {
    const double scale = std::exp2(-(whole + k));
    const double x = p.x * scale, y = p.y * scale;
    const auto height = [](double u, double v) { return simplex({u, v * 1.6, 0.5}, 99); };
    const float here = height(x, y), share = k > 0 ? part : 1 - part;
    slope += Vec3f{here - height(x + step, y), here - height(x, y + step), 0} * (share * steepness / step);
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
  float wavelength = 2.5f * spacing, share = 1;
  // Some places are rougher than others.
  const float rough = 0.4f + 1.2f * smoothly(s.position, 0.11 / wavelength);
  for (int octave = 0; octave < 12; ++octave, wavelength *= 0.47f, share *= 0.87f) {
    const float shown = share * rough * smooth(2.0f, 5.0f, wavelength / pixel);
    if (shown <= 0) return;
    const double scale = 1 / wavelength;
    const float here = noise(s.position, scale), step = 0.1f * wavelength;
    s.albedo = s.albedo * (1 + 0.18f * shown * (here - 0.45f));
    const float tilt = 0.055f * shown / 0.1f;
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
  return mix(Light::water * 2.0f, light_.sky({direction.x, direction.y, -direction.z}), 0.15f);
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
  return Vec3f{2.15f, 1.9f, 1.6f} * (facing / (0.3f + std::pow(near, 1.6f)));
}

Vec3f Integrator::bounced(const Hit& hit, Vec3f from, Vec3f direction, const Sampler& sampler) const {
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
  Vec3f light = bounced(hit, s.start, d, sampler);
  // A faint fill that open space has more of than crevices, so that no wall of a cave is black.
  if (light_.lamp) light += Vec3f{0.075f, 0.08f, 0.092f} * (hit.t / (hit.t + 0.4f * light_.lamp->reach));
  return light;
}

Integrator::Lit Integrator::lit(const Surface& s, const Sampler& sampler) const {
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
  const Lit light = lit(s, sampler);
  return {times(s.albedo, light.direct + light.indirect), light.indirect, s.albedo, s.normal, hit.t};
}

float Integrator::deepening(Vec3f p) const {
  if (!light_.sea_floor) return 1;
  const Box3f& box = world_.box();
  const float size = length(box.size());
  const float x = std::max(box.lo.x - p.x, p.x - box.hi.x), y = std::max(box.lo.y - p.y, p.y - box.hi.y);
  const float outside = x > 0 && y > 0 ? std::sqrt(x * x + y * y) : std::max(x, y);
  const float beyond = std::max(0.0f, outside + 0.06f * size) / size;
  return 1 + 25 * beyond + 150 * beyond * beyond;
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
  const float kept = 1 - smooth(1.0f, 2.2f, length(Vec3f{aside.x, aside.y, 0}) / size);
  if (kept <= 0) return {open, {}, {}, {}, far_away};
  // By brightness alone: the sky would make the shadow on a white floor blue.
  constexpr float strength = 0.85f;
  const Vec3f share = open * (strength * kept / luminance(light_.open_ground));
  const Lit light = lit(s, sampler);
  const float lost = luminance(light_.open_ground) - luminance(light.direct + light.indirect);
  const Vec3f grey = Vec3f{1, 1, 1} * luminance(light.indirect);
  const Sample sample{open - share * lost, grey, share, s.normal, drop / -direction.z};
  return sample;
}

Sample Integrator::water(Vec3f from, Vec3f direction, float t_sea, const Hit& hit, float footprint,
                         const Sampler& sampler) const {
  const Vec3f p = from + direction * t_sea;
  const float slant = std::max(-direction.z, 0.02f);
  // Waves a dozen pixels long look like water at any scale and never alias.
  const Vec3f n = wave_normal(p, 12 * footprint * t_sea / std::sqrt(slant));
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
