#pragma once
// What the program knows of a type of layer: a declaration, what of the common settings it takes, and how it
// is made. A kind is one file in layers/, which gives one type of layer or several.

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tafoni/core/registry.h"
#include "tafoni/landforms/landform.h"
#include "tafoni/math/vec.h"
#include "tafoni/scene/document/document.h"

namespace tafoni::scene {

namespace impl {
struct BuiltLayer;
struct LayerParts;
struct LayerSite;
struct Readers;
BuiltLayer build_whole(const LayerSite& site);
bool changed_whole(const BuiltLayer* before, const BuiltLayer* now, std::vector<Box3d>& out);
}  // namespace impl

struct LayerType {
  Declaration about = {};
  /// Which of its own parameters are paths of files that it reads.
  std::vector<std::string> paths = {};
  /// Which of its parameters must be said, and what that is: {"file", "the path of a CSV"}.
  std::vector<std::pair<std::string, std::string>> needs = {};
  /// Which of region, mask, altitude, box and points it cannot have, and the half sentence that says why.
  std::vector<std::string> leaves_out = {};
  std::string because = {};
  /// Strokes of brushes go there, and what they paint are masks for every layer.
  bool takes_strokes = false;

  /// What it does to the tree. It can look at nothing but its parts, and is called again when one differs.
  /// May be null where `build` does not call it.
  landforms::Result (*make)(const impl::LayerParts& parts, impl::Readers& readers) = nullptr;
  /// For a type that keeps more from one build to the next than whole results.
  impl::BuiltLayer (*build)(const impl::LayerSite& site) = &impl::build_whole;
  /// Appends boxes, local metres, outside of which both do the same to a tree, bit for bit; either may be
  /// null. False, and nothing appended, where that cannot be told.
  bool (*changed)(const impl::BuiltLayer* before, const impl::BuiltLayer* now,
                  std::vector<Box3d>& out) = &impl::changed_whole;
};

struct LayerKind {
  std::vector<LayerType> types = {};
  /// The topic of `tafoni list` that shows its types, where they have a registry of their own.
  std::string listed_as = {};
};

/// Every kind, sorted by name; layers/NAME.cpp defines `const LayerKind& declaration()` in its namespace
/// `layer_NAME`.
std::span<const LayerKind* const> all_layers();
/// The types of layers that all kinds have, in one list.
std::span<const LayerType* const> all_layer_types();
/// Throws Error{usage} naming the nearest known one.
const LayerType& find_layer_type(std::string_view name);
/// The type of layer that is made for strokes where there is none yet.
const LayerType& stroke_layer_type();

}  // namespace tafoni::scene
