#pragma once
// Names of files are bytes, of any encoding or none; texts that are stored must be UTF-8.

#include <string>
#include <string_view>

namespace tafoni {

/// `bytes` as UTF-8: a byte that is no part of UTF-8 becomes \xE9 and the like, and so does a backslash that
/// would read as the beginning of one.
std::string to_utf8(std::string_view bytes);

/// Where a text first is not UTF-8; npos where all of it is.
std::size_t first_not_utf8(std::string_view text);

/// What to_utf8() was given.
std::string from_utf8(std::string_view text);

}  // namespace tafoni
