#include "tafoni/io/impl/json_text.h"

#include <nlohmann/json.hpp>

namespace tafoni::io::impl {

nlohmann::json read_json(std::string_view text) {
  return nlohmann::json::parse(text, nullptr, false);
}

std::string json_text(const nlohmann::json& json) {
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace tafoni::io::impl
