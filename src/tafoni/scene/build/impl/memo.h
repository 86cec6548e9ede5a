#pragma once
// A call that is remembered by what it was given. The key of a result is the digest of the very values that
// the function gets, and the function, a plain one, can capture nothing else: so what is made and what it is
// kept under cannot depend on different things.

#include <bit>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "tafoni/math/vec.h"
#include "tafoni/scene/build/impl/digest.h"
#include "tafoni/scene/build/impl/recent.h"

namespace tafoni::scene::impl {

/// A value with the digest of all that it was made from, which stands for it in further keys.
template <class T>
struct Keyed {
  T value = {};
  Digest key = {};
};

/// A file where it lies and what it held when this was made.
struct File {
  std::filesystem::path path;
  Digest content;
};

// What can be a part of a key. A struct is one where parts(s) gives its members as a tuple: written as
// `const auto& [a, b] = s; return std::tie(a, b);`, it stops compiling when a member is added and forgotten.
inline void add_part(Digest& to, double v) {
  to.add(v);
}
inline void add_part(Digest& to, std::uint64_t v) {
  to.add(v);
}
inline void add_part(Digest& to, bool v) {
  to.add(std::uint64_t{v});
}
inline void add_part(Digest& to, const std::string& text) {
  to.add(std::string_view(text));
}
inline void add_part(Digest& to, Vec3d v) {
  to.add(v.x).add(v.y).add(v.z);
}
inline void add_part(Digest& to, const File& file) {
  to.add(std::string_view(file.path.native())).add(file.content);
}
template <class T>
void add_part(Digest& to, const Keyed<T>& value) {
  to.add(value.key);
}
template <class T>
void add_part(Digest& to, const std::optional<T>& value);
template <class T>
void add_part(Digest& to, const std::vector<T>& list);
template <class T>
void add_part(Digest& to, const std::map<std::string, T>& named);
template <class T>
auto add_part(Digest& to, const T& whole) -> decltype(parts(whole), void()) {
  std::apply([&](const auto&... part) { (add_part(to, part), ...); }, parts(whole));
}
template <class T>
void add_part(Digest& to, const std::optional<T>& value) {
  to.add(std::uint64_t{value.has_value()});
  if (value) add_part(to, *value);
}
template <class T>
void add_part(Digest& to, const std::vector<T>& list) {
  to.add(static_cast<std::uint64_t>(list.size()));
  for (const T& item : list) add_part(to, item);
}
template <class T>
void add_part(Digest& to, const std::map<std::string, T>& named) {
  to.add(static_cast<std::uint64_t>(named.size()));
  for (const auto& [name, item] : named) {
    add_part(to, name);
    add_part(to, item);
  }
}

template <class... Parts>
Digest digest_of(const Parts&... parts) {
  Digest out;
  (add_part(out, parts), ...);
  return out;
}

/// What `make` gives, with its key; nothing is kept.
template <class T, class... Parts>
Keyed<T> make_keyed(T (*make)(const Parts&...), const std::type_identity_t<Parts>&... parts) {
  return {make(parts...), digest_of(parts...)};
}

/// Keeps the last `limit` results of one function. Its last argument, an Aid, helps it and may change no
/// result: a Progress, or what keeps the files that were read.
template <class T, class Aid, class... Parts>
class Memo {
 public:
  using Make = T (*)(const Parts&... parts, Aid& aid);
  Memo(std::size_t limit, Make make) : kept_(limit), make_(make) {}

  Keyed<T> operator()(const Parts&... parts, Aid& aid) {
    const Digest key = digest_of(parts...);
    return {kept_.get(key,
                      [&] {
                        T made = make_(parts..., aid);
                        ++made_;
                        return made;
                      }),
            key};
  }
  /// How often the function was called.
  std::uint64_t made() const { return made_; }

 private:
  Recent<Digest, T> kept_;
  Make make_;
  std::uint64_t made_ = 0;
};

}  // namespace tafoni::scene::impl
