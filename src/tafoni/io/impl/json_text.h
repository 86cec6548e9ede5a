#pragma once
// JSON's text, read and written here alone, so that nlohmann's reader and writer are compiled once.

#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

namespace tafoni::io::impl {

/// Discarded (`is_discarded()`) when the text is no JSON.
nlohmann::json read_json(std::string_view text);
/// In one line; what is not UTF-8 becomes U+FFFD.
std::string json_text(const nlohmann::json& json);

}  // namespace tafoni::io::impl
