#pragma once
// JSON's text, which this module reads and writes here alone: nlohmann's reader and writer take long to
// compile.

#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

namespace tafoni::io::impl {

/// Discarded (`is_discarded()`) when the text is no JSON.
nlohmann::json read_json(std::string_view text);
/// In one line; what is not UTF-8 becomes U+FFFD.
std::string json_text(const nlohmann::json& json);

}  // namespace tafoni::io::impl
