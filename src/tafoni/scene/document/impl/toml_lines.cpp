// A scanner over lines: it knows headers, keys, comments, strings and brackets, and no more of TOML. Texts
// are cut into blocks before headers, and a key's value is replaced in its place.
#include "tafoni/scene/document/impl/toml_lines.h"

#include <algorithm>

namespace tafoni::scene::impl {
namespace {

bool blank(char c) {
  return c == ' ' || c == '\t' || c == '\r';
}

std::string bare(std::string_view name) {
  std::string out;
  for (char c : name)
    if (!blank(c) && c != '"' && c != '\'' && c != '[' && c != ']') out += c;
  return out;
}

/// The end of the string that begins at `at`; the end of the line or text where it is not closed.
std::size_t end_of_string(std::string_view text, std::size_t at) {
  const char quote = text[at];
  const std::string_view triple = text.substr(at, 3);
  const bool multi = triple == std::string(3, quote);
  at += multi ? 3 : 1;
  while (at < text.size()) {
    if (quote == '"' && text[at] == '\\') {
      at += 2;
      continue;
    }
    if (multi ? text.substr(at, 3) == triple : text[at] == quote) {
      at += multi ? 3 : 1;
      // A multi-line string may end in up to two quotes of its own.
      for (int extra = 0; multi && extra < 2 && at < text.size() && text[at] == quote; ++extra) ++at;
      return at;
    }
    if (!multi && text[at] == '\n') return at;
    ++at;
  }
  return text.size();
}

/// Walks over a value from `at` to its end: past strings, nested brackets and the lines within them.
std::size_t end_of_value(std::string_view text, std::size_t at) {
  int depth = 0;
  std::size_t last = at;
  while (at < text.size()) {
    const char c = text[at];
    if (c == '\n' && depth == 0) break;
    if (c == '#') {
      if (depth == 0) break;
      at = std::min(text.find('\n', at), text.size());
      continue;
    }
    if (c == '"' || c == '\'') {
      last = at = end_of_string(text, at);
      continue;
    }
    if (c == '[' || c == '{') ++depth;
    if (c == ']' || c == '}') --depth;
    ++at;
    if (!blank(c) && c != '\n') last = at;
  }
  return last;
}

}  // namespace

std::vector<Statement> statements(std::string_view text) {
  std::vector<Statement> out;
  int line = 1;
  for (std::size_t at = 0; at < text.size();) {
    Statement s;
    s.begin = at;
    s.line = line;
    while (at < text.size() && blank(text[at])) ++at;
    const std::size_t eol = std::min(text.find('\n', at), text.size());
    std::size_t stop = eol;
    if (at < text.size() && text[at] == '[') {
      s.kind = Statement::header;
      s.name = bare(text.substr(at, std::min(text.find('#', at), eol) - at));
    } else if (at < eol && text[at] != '#') {
      s.kind = Statement::key;
      const std::size_t equals = std::min(text.find('=', at), eol);
      s.name = bare(text.substr(at, equals - at));
      s.value_begin = std::min(equals + 1, eol);
      while (s.value_begin < eol && blank(text[s.value_begin])) ++s.value_begin;
      s.value_end = end_of_value(text, s.value_begin);
      stop = std::min(text.find('\n', s.value_end), text.size());
    }
    s.end = std::min(stop + 1, text.size());
    line += static_cast<int>(std::count(text.begin() + s.begin, text.begin() + s.end, '\n'));
    at = s.end;
    out.push_back(std::move(s));
  }
  return out;
}

namespace {

/// Cuts a text that begins on line `first_line` before each header with `dots` dots in its name.
std::vector<Block> cut(std::string_view text, int first_line, std::ptrdiff_t dots) {
  std::vector<Block> out(1);
  const auto all = statements(text);
  const auto blank_line = [&](const Statement& s) {
    return std::all_of(text.begin() + s.begin, text.begin() + s.end,
                       [](char c) { return blank(c) || c == '\n'; });
  };
  std::size_t begin = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::string& name = all[i].name;
    if (all[i].kind != Statement::header || std::count(name.begin(), name.end(), '.') != dots) continue;
    std::size_t first = i;
    while (first > 0 && all[first - 1].kind == Statement::comment && !blank_line(all[first - 1])) --first;
    out.back().text = text.substr(begin, all[first].begin - begin);
    begin = all[first].begin;
    out.push_back({name, first_line + all[i].line - 1, {}});
  }
  out.back().text = text.substr(begin);
  return out;
}

}  // namespace

std::vector<Block> blocks(std::string_view text) {
  return cut(text, 1, 0);
}

std::vector<Block> parts(const Block& block) {
  const auto all = statements(block.text);
  const auto header =
      std::find_if(all.begin(), all.end(), [](const Statement& s) { return s.kind == Statement::header; });
  const int first_line = header == all.end() ? 1 : block.line - header->line + 1;
  auto out = cut(block.text, first_line, std::count(block.name.begin(), block.name.end(), '.') + 1);
  out.front().name = block.name;
  out.front().line = block.line;
  return out;
}

void edit(Block& block, std::string_view key, const std::string& value) {
  std::size_t after = 0;
  for (const Statement& s : statements(block.text)) {
    if (s.kind != Statement::comment) after = s.end;
    if (s.kind != Statement::key || s.name != key) continue;
    if (value.empty())
      block.text.erase(s.begin, s.end - s.begin);
    else
      block.text.replace(s.value_begin, s.value_end - s.value_begin, value);
    return;
  }
  if (value.empty()) return;
  const bool open_line = after > 0 && block.text[after - 1] != '\n';
  std::string added(open_line ? "\n" : "");
  added.append(key).append(" = ").append(value).append("\n");
  block.text.insert(after, added);
}

}  // namespace tafoni::scene::impl
