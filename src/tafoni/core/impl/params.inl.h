#pragma once
#include <cstring>
#include <utility>

namespace tafoni {

template <class P>
template <class M>
ParamInfo& ParamTable<P>::add(std::string name, M P::*member, std::string doc, ValueKind kind) {
  ParamInfo info;
  info.name = std::move(name);
  info.doc = std::move(doc);
  info.kind = kind;
  static_assert(sizeof(member) <= sizeof(info.member));
  std::memcpy(info.member, &member, sizeof(member));
  info.init = P{}.*member;
  info.store = [](const ParamInfo& self, void* object, const Value& value) {
    M P::*m;
    std::memcpy(&m, self.member, sizeof(m));
    static_cast<P*>(object)->*m = std::get<M>(value);
  };
  info.load = [](const ParamInfo& self, const void* object) {
    M P::*m;
    std::memcpy(&m, self.member, sizeof(m));
    return Value(static_cast<const P*>(object)->*m);
  };
  return infos_.emplace_back(std::move(info));
}

template <class P>
ParamTable<P>& ParamTable<P>::real(std::string name, double P::*member, std::string unit, double min,
                                   double max, std::string doc) {
  auto& info = add(std::move(name), member, std::move(doc), ValueKind::real);
  info.unit = std::move(unit);
  info.min = min;
  info.max = max;
  return *this;
}

template <class P>
ParamTable<P>& ParamTable<P>::integer(std::string name, std::int64_t P::*member, std::string unit,
                                      std::int64_t min, std::int64_t max, std::string doc) {
  auto& info = add(std::move(name), member, std::move(doc), ValueKind::integer);
  info.unit = std::move(unit);
  info.min = static_cast<double>(min);
  info.max = static_cast<double>(max);
  return *this;
}

template <class P>
ParamTable<P>& ParamTable<P>::boolean(std::string name, bool P::*member, std::string doc) {
  add(std::move(name), member, std::move(doc), ValueKind::boolean);
  return *this;
}

template <class P>
ParamTable<P>& ParamTable<P>::text(std::string name, std::string P::*member, std::string doc) {
  add(std::move(name), member, std::move(doc), ValueKind::text);
  return *this;
}

template <class P>
ParamTable<P>& ParamTable<P>::choice(std::string name, std::string P::*member,
                                     std::vector<std::string> choices, std::string doc) {
  add(std::move(name), member, std::move(doc), ValueKind::choice).choices = std::move(choices);
  return *this;
}

template <class P>
ParamTable<P>& ParamTable<P>::numbers(std::string name, std::vector<double> P::*member, std::string unit,
                                      std::size_t count, double min, double max, std::string doc) {
  auto& info = add(std::move(name), member, std::move(doc), ValueKind::numbers);
  info.unit = std::move(unit);
  info.count = count;
  info.min = min;
  info.max = max;
  return *this;
}

template <class P>
ParamTable<P>& ParamTable<P>::rows(std::string name, Rows P::*member, std::vector<ParamInfo> columns,
                                   std::string doc) {
  auto& info = add(std::move(name), member, std::move(doc), ValueKind::rows);
  info.columns = std::move(columns);
  info.init = checked(info, info.init, "default");
  return *this;
}

}  // namespace tafoni
