#pragma once
// The lines of a TOML text, for edits that keep comments and layout. Not a parser: the text has been parsed
// before, and what an edit makes is parsed again.

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace tafoni::scene::impl {

/// One statement: the lines of a comment, a header or a key with its value.
struct Statement {
  enum Kind { comment, header, key } kind = comment;
  std::string name;                            ///< of the header or key, without brackets and quotes
  std::size_t begin = 0, end = 0;              ///< bytes of whole lines
  std::size_t value_begin = 0, value_end = 0;  ///< bytes of a key's value
  int line = 0;                                ///< from 1
};

std::vector<Statement> statements(std::string_view text);

/// A header with all up to the next one that is not nested in it, as [[layer.rule]] is in [[layer]]; comments
/// directly above a header belong to it. The first block has no header and may be empty.
struct Block {
  std::string name;  ///< of the header
  int line = 0;      ///< of the header; 0 for the first block
  std::string text;
};

std::vector<Block> blocks(std::string_view text);

/// What the block says itself, then the blocks nested directly in it with all that is nested in them.
std::vector<Block> parts(const Block& block);

/// Replaces the value of `key`, or adds the key after the block's last one. An empty `value` removes it. The
/// block must have nothing nested in it.
void edit(Block& block, std::string_view key, const std::string& value);

}  // namespace tafoni::scene::impl
