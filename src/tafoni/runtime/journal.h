#pragma once
// The file of a terrain's edits: append-only, checked, bound to the terrain that it belongs to.
//
// scene/journal.h is for an artist: a tree of strokes with undo, in a database, every one on the disk before
// the call returns. A game digs many times a second, has no branches, and sends the same bytes to its peers;
// so this is a plain run of messages (operation.h), cheap to append to and to stream.
//
// A header of 32 bytes (what it is, its version, the base's digest, a checksum), then a record an edit:
// length and number, both 4 bytes, 8 of checksum of these, the message, 8 of checksum of the message, one
// byte 0xa5.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tafoni/runtime/operation.h"

namespace tafoni::runtime {

/// Tells terrains apart: their samples, lattice, place and settings.
using Digest = std::uint64_t;

struct JournalContents {
  Digest base = 0;
  std::vector<Message> edits;
  std::uint64_t bytes = 0;  ///< header and whole edits
  std::uint64_t torn = 0;   ///< bytes after them, of an edit that a crash left unfinished
  std::string damage;       ///< one sentence, of survey_journal() alone; empty for a sound journal
};

/// An unfinished last edit is left out and counted: what a file lacks at its end, or zeros there, where a
/// disk lost what was last written. Anything else that is not as it was written throws Error{input}, which
/// names the edit.
JournalContents parse_journal(std::span<const std::byte> bytes, std::string_view name);
JournalContents read_journal(const std::filesystem::path& file);
/// The same, but gives what stands before the first damage, and the damage. Throws Error{input} for what is
/// no journal, and for a header that is damaged, without which nothing can be believed.
JournalContents survey_journal(const std::filesystem::path& file);
/// Whether a file begins as a journal does.
bool is_journal(const std::filesystem::path& file);

/// Writes a whole journal, or nothing. Throws Error{output}, and for a file that somebody appends to.
void write_journal(const std::filesystem::path& file, Digest base, const std::vector<Message>& edits);
/// Makes a journal that begins with the edits where there is none yet, or a file of no bytes. Gives whether
/// it did.
bool make_journal(const std::filesystem::path& file, Digest base, const std::vector<Message>& edits);

/// Appends to a journal. For one thread at a time. No other program or writer can append to the same file,
/// or write_journal() to it, as long as it lives.
class JournalWriter {
 public:
  /// Goes on after the `contents` that were read from the file; a torn end is cut off by the first append.
  /// Throws Error{output} where another appends to the file, or has since it was read.
  JournalWriter(std::filesystem::path file, const JournalContents& contents);
  ~JournalWriter();
  JournalWriter(JournalWriter&& other) noexcept;
  JournalWriter& operator=(JournalWriter&&) = delete;

  /// One write to the file: edits survive the end of the process, and of the machine once sync() was called.
  /// Throws Error{output}; the file is then as before, or, where not even that can be had, ends in a torn
  /// edit, and nothing is appended until that can be cut off.
  void append(std::span<const Message> messages);
  /// Returns when everything appended is on the disk. Throws Error{output}.
  void sync();
  /// Whether the path is that of the file that it appends to.
  bool writes_to(const std::filesystem::path& file) const;

 private:
  bool cut();  ///< takes off what follows the whole edits

  std::filesystem::path file_;
  int fd_ = -1;
  Digest base_ = 0;
  std::uint64_t bytes_ = 0;
  std::uint32_t count_ = 0;
  bool torn_ = false;  ///< bytes of an edit that was not made follow the whole ones
};

}  // namespace tafoni::runtime
