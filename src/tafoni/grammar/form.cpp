// Forms become trees: each leaf gets the pose that all forms about it add up to.

#include "tafoni/grammar/form.h"

#include "tafoni/core/error.h"
#include "tafoni/grammar/leaf.h"

namespace tafoni::grammar {
namespace {

constexpr float far_outside = -1e6f;  // metres: the distance of a form that is nothing

field::NodePtr tree_of(const Form& form, const Pose& outer) {
  const Pose pose = outer.placed(form.pose);
  if (form.solid) return leaf(form.solid, pose);
  std::vector<field::NodePtr> of;
  for (const FormPtr& child : form.of) of.push_back(tree_of(*child, pose));
  switch (form.operation) {
    case Operation::sum:
      return field::unite(std::move(of));
    case Operation::difference:
      return field::combine("difference", std::move(of));
    case Operation::intersection:
      return field::intersect(std::move(of));
    case Operation::morph:
      break;
  }
  return field::morph(of[0], of[1], form.alpha);
}

}  // namespace

Operation operation_of(std::string_view name) {
  if (name == "sum") return Operation::sum;
  if (name == "difference") return Operation::difference;
  if (name == "intersection") return Operation::intersection;
  if (name == "morph") return Operation::morph;
  fail(ErrorKind::usage, "there is no operation \"{}\"; write sum, difference, intersection or morph", name);
}

FormPtr placed(FormPtr form, const Pose& pose) {
  if (!form) return form;
  auto out = std::make_shared<Form>(*form);
  out->pose = pose.placed(form->pose);
  return out;
}

FormPtr combined(Operation operation, FormPtr a, FormPtr b, double alpha) {
  auto out = std::make_shared<Form>();
  out->operation = operation;
  out->of = {std::move(a), std::move(b)};
  out->alpha = alpha;
  return out;
}

FormPtr sum(std::vector<FormPtr> forms) {
  if (forms.empty()) return nullptr;
  if (forms.size() == 1) return forms.front();
  auto out = std::make_shared<Form>();
  out->of = std::move(forms);
  return out;
}

field::NodePtr tree(const FormPtr& form) {
  return form ? tree_of(*form, {}) : field::constant(far_outside);
}

}  // namespace tafoni::grammar
