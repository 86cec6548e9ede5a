// What readers share: a file mapped into memory, steps through text with the line for messages, welding
// of vertices, and the last check of a mesh that was read.

#include "tafoni/io/impl/reading.h"

#include <algorithm>
#include <bit>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <cmath>

#include <sys/mman.h>

#include "tafoni/core/input_file.h"
#include "tafoni/core/random.h"

namespace tafoni::io::impl {

MappedFile::MappedFile(const std::filesystem::path& path) {
  const InputFile file(path);
  size_ = file.size();
  if (size_ == 0) fail(ErrorKind::input, "{}: the file is empty; write it again.", path.string());
  data_ = ::mmap(nullptr, size_, PROT_READ, MAP_PRIVATE, file.descriptor(), 0);
  if (data_ != MAP_FAILED) return;
  data_ = nullptr;
  fail(ErrorKind::input, "{}: cannot be read ({}).", path.string(), std::strerror(errno));
}

MappedFile::~MappedFile() {
  if (data_) ::munmap(data_, size_);
}

std::string_view TextCursor::rest_of_line() {
  const std::size_t end = std::min(text_.find('\n', at_), text_.size());
  std::string_view rest = text_.substr(at_, end - at_);
  at_ = std::min(end + 1, text_.size());
  ++line_;
  if (!rest.empty() && rest.back() == '\r') rest.remove_suffix(1);
  return rest;
}

std::string_view TextCursor::token(char comment) {
  while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t' || text_[at_] == '\r')) ++at_;
  if (at_ >= text_.size() || text_[at_] == '\n' || text_[at_] == comment) return {};
  const std::size_t begin = at_;
  while (at_ < text_.size() && !(text_[at_] == ' ' || text_[at_] == '\t' || text_[at_] == '\r' ||
                                 text_[at_] == '\n' || text_[at_] == comment))
    ++at_;
  return text_.substr(begin, at_ - begin);
}

std::string_view TextCursor::token_anywhere(char comment) {
  while (!at_end()) {
    const std::string_view word = token(comment);
    if (!word.empty()) return word;
    rest_of_line();
  }
  return {};
}

void TextCursor::fail_here(std::string_view what) const {
  fail(ErrorKind::input, "{}, line {}: {}; the file is damaged or not of this format.", file_, line_, what);
}

double TextCursor::number(std::string_view token) const {
  double value = 0;
  if (token.starts_with('+')) token.remove_prefix(1);
  const auto [end, error] = std::from_chars(token.data(), token.data() + token.size(), value);
  // from_chars calls both 1e-999 and 1e999 out of range; the first is as good as zero.
  if (error == std::errc::result_out_of_range && end == token.data() + token.size() &&
      token.find_first_of("eE") != token.npos && token.find("-", token.find_first_of("eE")) != token.npos)
    return 0;
  if (token.empty() || error != std::errc() || end != token.data() + token.size() || !std::isfinite(value))
    fail_here(token.empty() ? "a number is missing"
                            : fmt::format("'{}' is not a number", token.substr(0, 40)));
  return value;
}

std::int64_t TextCursor::integer(std::string_view token) const {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(token.data(), token.data() + token.size(), value);
  if (token.empty() || error != std::errc() || end != token.data() + token.size())
    fail_here(token.empty() ? "a whole number is missing"
                            : fmt::format("'{}' is not a whole number", token.substr(0, 40)));
  return value;
}

std::string lower_case(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(), [](unsigned char c) { return std::tolower(c); });
  return out;
}

bool is_no_number(std::string_view word) {
  if (word.starts_with('-') || word.starts_with('+')) word.remove_prefix(1);
  const std::string low = lower_case(word);
  return low == "nan" || low == "inf" || low == "infinity" || low.starts_with("nan(") ||
         low.starts_with("1.#");
}

Welder::Welder(std::vector<Vec3f>& positions, std::size_t expected) : positions_(positions) {
  seen_.reserve(expected);
}

std::size_t Welder::Hash::operator()(const std::array<std::uint32_t, 3>& k) const {
  return hash_combine((std::uint64_t{k[0]} << 32) | k[1], k[2]);
}

std::uint32_t Welder::add(Vec3f p) {
  const auto bits = [](float v) { return std::bit_cast<std::uint32_t>(v + 0.0f); };
  const auto next = static_cast<std::uint32_t>(positions_.size());
  const auto [entry, fresh] = seen_.try_emplace({bits(p.x), bits(p.y), bits(p.z)}, next);
  if (fresh) positions_.push_back(p);
  return entry->second;
}

namespace {

bool finite(Vec3f p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

/// A normal as short as this has no direction that means anything.
constexpr double shortest = 1e-6;
/// A square of a length that is off by no more is a unit's that a writer has rounded.
constexpr double unit_to = 1e-5;

/// False when some normal has no direction.
bool normalize(std::vector<Vec3f>& normals) {
  for (Vec3f& n : normals) {
    const double length2 = dot(to_double(n), to_double(n));
    if (!(length2 > shortest * shortest) || !std::isfinite(length2)) return false;
    // What is a unit already stays as it is, so that reading and writing again changes nothing.
    if (std::abs(length2 - 1) > unit_to) n = to_float(to_double(n) * (1 / std::sqrt(length2)));
  }
  return true;
}

}  // namespace

void check_read(mesh::Mesh& mesh, std::string_view file) {
  const std::size_t vertices = mesh.positions.size();
  if (vertices > 0xffffffffull)
    fail(ErrorKind::input, "{}: has more than 2^32 vertices; split it into tiles.", file);
  if (mesh.triangles.empty())
    fail(ErrorKind::input, "{}: holds {} vertices and no triangles; export it as a mesh with faces.", file,
         vertices);
  for (std::size_t i = 0; i < vertices; ++i)
    if (!finite(mesh.positions[i]))
      fail(ErrorKind::input, "{}: the position of vertex {} is not finite; the file is damaged.", file, i);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    for (const std::uint32_t v : mesh.triangles[i])
      if (v >= vertices)
        fail(ErrorKind::input, "{}: triangle {} names vertex {}, but there are {}; the file is damaged.",
             file, i, v, vertices);
  if (mesh.normals.size() != vertices || !normalize(mesh.normals)) mesh.normals.clear();
  if (mesh.colors.size() != vertices) mesh.colors.clear();
  if (mesh.texture.size() != mesh.triangles.size()) mesh.texture.clear();
}

}  // namespace tafoni::io::impl
