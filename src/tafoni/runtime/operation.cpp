// Edits as bytes: version, kind, numbers, little-endian. What is decoded is checked as what is encoded is,
// and must be the very bytes that its operation gives.

#include "tafoni/runtime/operation.h"

#include <algorithm>
#include <cmath>

#include "tafoni/core/error.h"
#include "tafoni/runtime/impl/bytes.h"

namespace tafoni::runtime {
namespace {

using impl::ByteReader;
using impl::ByteWriter;
using volume::ToolData;

constexpr std::uint8_t message_version = 1;
constexpr std::uint32_t most_numbers = 4096;
/// A hull takes as many steps to make as the square of its corners, and its planes are asked sample by
/// sample.
constexpr std::uint32_t most_corners = 256;
enum class Kind : std::uint8_t { tool, explosion, radial, rewind };

bool finite(Vec3d p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

void check_radial(Vec3d center, double radius) {
  if (!finite(center) || !std::isfinite(radius) || !(radius > 0))
    fail(ErrorKind::usage, "an explosion needs a finite centre and a radius above 0, not {}", radius);
}

void check(const Explosion& e) {
  check_radial(e.center, e.radius);
  if (!std::isfinite(e.energy)) fail(ErrorKind::usage, "the energy of an explosion is not finite");
}

void check(const Radial& r) {
  check_radial(r.center, r.radius);
  if (r.change.size() < 2 || r.change.size() > most_numbers)
    fail(ErrorKind::usage, "a radial edit takes 2 to {} values, not {}", most_numbers, r.change.size());
  for (double v : r.change)
    if (!std::isfinite(v)) fail(ErrorKind::usage, "a value of a radial edit is not finite");
}

void check_corners(std::size_t n) {
  if (n > most_corners)
    fail(ErrorKind::usage, "a hull of {} corners is too large for an edit: give at most {}", n, most_corners);
}

void put(ByteWriter& out, Vec3d p) {
  for (double v : {p.x, p.y, p.z}) out.put(v);
}
Vec3d get_point(ByteReader& in) {
  const double x = in.get<double>(), y = in.get<double>();
  return {x, y, in.get<double>()};
}
/// How many items of a size follow; 0 where they cannot.
std::size_t get_count(ByteReader& in, std::size_t size) {
  const std::size_t n = in.get<std::uint32_t>();
  return n * size <= in.left() ? n : 0;
}
std::vector<double> get_numbers(ByteReader& in) {
  std::vector<double> out(std::min<std::size_t>(get_count(in, sizeof(double)), most_numbers + 1));
  for (double& v : out) v = in.get<double>();
  return out;
}

void put(ByteWriter& out, const ToolUse& use) {
  const ToolData data = use.tool.data();
  check_corners(data.points.size());
  out.put(Kind::tool);
  out.put(static_cast<std::uint8_t>(use.edit));
  out.put(data.kind);
  out.put_count(data.points);
  for (Vec3d p : data.points) put(out, p);
  out.put_count(data.sizes);
  for (double v : data.sizes) out.put(v);
}

void put(ByteWriter& out, const Explosion& e) {
  check(e);
  out.put(Kind::explosion);
  put(out, e.center);
  out.put(e.radius);
  out.put(e.energy);
}

void put(ByteWriter& out, const Radial& r) {
  check(r);
  out.put(Kind::radial);
  put(out, r.center);
  out.put(r.radius);
  out.put_count(r.change);
  for (double v : r.change) out.put(v);
}

void put(ByteWriter& out, const Rewind& r) {
  if (r.version == 0) fail(ErrorKind::usage, "versions begin with 1, so that none rewinds to 0");
  out.put(Kind::rewind);
  out.put(r.version);
}

ToolUse get_tool(ByteReader& in) {
  const auto edit = in.get<std::uint8_t>();
  if (edit > 1) fail(ErrorKind::input, "it neither removes nor adds");
  ToolData data;
  data.kind = in.get<ToolData::Kind>();
  const std::size_t points = get_count(in, sizeof(Vec3d));
  check_corners(points);
  for (std::size_t i = 0; i < points; ++i) data.points.push_back(get_point(in));
  data.sizes = get_numbers(in);
  return {volume::Tool::from(data), static_cast<volume::Edit>(edit)};
}

Operation get(ByteReader& in) {
  if (in.get<std::uint8_t>() != message_version) fail(ErrorKind::input, "it is of another version");
  switch (in.get<Kind>()) {
    case Kind::tool:
      return get_tool(in);
    case Kind::explosion: {
      Explosion e;
      e.center = get_point(in);
      e.radius = in.get<double>();
      e.energy = in.get<double>();
      check(e);
      return e;
    }
    case Kind::radial: {
      Radial r;
      r.center = get_point(in);
      r.radius = in.get<double>();
      r.change = get_numbers(in);
      check(r);
      return r;
    }
    case Kind::rewind: {
      const Rewind r{in.get<std::uint64_t>()};
      if (r.version == 0) fail(ErrorKind::input, "it rewinds to version 0");
      return r;
    }
  }
  fail(ErrorKind::input, "it is of no known kind");
}

/// The tool that its own numbers give again: a hull made from a hull's corners may leave out some that lie in
/// its faces.
volume::Tool lasting(volume::Tool tool) {
  for (ToolData data = tool.data();;) {
    tool = volume::Tool::from(data);
    ToolData again = tool.data();
    if (again == data) return tool;
    data = std::move(again);
  }
}

Message written(const Operation& operation) {
  ByteWriter out;
  out.put(message_version);
  std::visit([&](const auto& o) { put(out, o); }, operation);
  return std::move(out.bytes);
}

}  // namespace

Message encode(const Operation& operation) {
  const auto* use = std::get_if<ToolUse>(&operation);
  if (!use) return written(operation);
  check_corners(use->tool.data().points.size());
  return written(ToolUse{lasting(use->tool), use->edit});
}

Operation decode(std::span<const std::byte> message) {
  try {
    ByteReader in(message);
    Operation operation = get(in);
    if (!in.done()) fail(ErrorKind::input, "its length is wrong");
    if (!std::ranges::equal(written(operation), message))
      fail(ErrorKind::input, "the same edit has a shorter message");
    return operation;
  } catch (const Error& error) {
    fail(ErrorKind::input, "a message of {} bytes is no edit of this program: {}", message.size(),
         error.what());
  }
}

}  // namespace tafoni::runtime
