#pragma once
// Everything that is declared somewhere, as one kind of entry: what `tafoni list` and the reference show.

#include <string>
#include <string_view>
#include <vector>

#include "args.h"

#include "tafoni/core/params.h"

namespace tafoni::cli {

struct CatalogueEntry {
  std::string name, doc, source;
  std::string note;  ///< extensions of a format, examples of a command
  std::vector<ParamInfo> params;
  std::vector<Args::Entry> options;  ///< of a command
};

struct Topic {
  std::string name, doc;
  std::vector<CatalogueEntry> entries;
};

/// Commands and their options, scene sections, landforms and whatever else has a registry.
std::vector<Topic> catalogue();

/// "commands, options … or formats".
std::string topic_names();

/// The reference page.
std::string markdown(const std::vector<Topic>& topics);
std::string text(const Topic& topic);
std::string text(const CatalogueEntry& entry);

}  // namespace tafoni::cli
