// Reads, writes and appends the records of a journal. Checksums tell a damaged record from one that a crash
// left unfinished, which is cut off.

#include "tafoni/runtime/journal.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <fstream>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

#include "tafoni/core/atomic_file.h"
#include "tafoni/core/error.h"
#include "tafoni/core/inner/file_lock.h"
#include "tafoni/core/input_file.h"
#include "tafoni/runtime/impl/bytes.h"

namespace tafoni::runtime {
namespace {

using impl::ByteReader;
using impl::ByteWriter;

constexpr std::uint64_t magic = 0x6c616e6a67696474;  // "tdigjnal"
constexpr std::uint64_t format_version = 1;
constexpr std::size_t header_bytes = 32, head_bytes = 16, tail_bytes = 9;
constexpr std::byte whole{0xa5};  ///< not 0, so that an end of zeros is known as such

std::vector<std::byte> header(Digest base) {
  ByteWriter out;
  out.put(magic);
  out.put(format_version);
  out.put(base);
  out.put(impl::checksum(out.bytes));
  return std::move(out.bytes);
}

std::uint64_t head_checksum(Digest base, std::span<const std::byte> head) {
  return impl::checksum(head.first(8), base);
}

void put_record(ByteWriter& out, Digest base, std::uint32_t number, const Message& message) {
  const std::size_t begin = out.bytes.size();
  out.put_count(message);
  out.put(number);
  const std::uint64_t check = head_checksum(base, std::span(out.bytes).subspan(begin));
  out.put(check);
  out.bytes.insert(out.bytes.end(), message.begin(), message.end());
  out.put(impl::checksum(message, check));
  out.put(whole);
}

/// Reads one record from the front of `left`. False where it is unfinished; throws where it is damaged.
/// `written` bytes of `left` end in one that is not 0.
bool take(std::span<const std::byte> left, std::size_t written, Digest base, std::uint32_t number,
          std::string_view name, Message& message) {
  const auto damaged = [&] {
    fail(ErrorKind::input, "{}: edit {} is damaged; restore the journal from a copy", name, number);
  };
  if (written < head_bytes + tail_bytes) return false;
  ByteReader head(left.first(head_bytes));
  const auto length = head.get<std::uint32_t>(), own = head.get<std::uint32_t>();
  const auto check = head.get<std::uint64_t>();
  if (check != head_checksum(base, left) || own != number) damaged();
  if (written < head_bytes + length + tail_bytes) return false;
  const auto bytes = left.subspan(head_bytes, length);
  ByteReader tail(left.subspan(head_bytes + length, tail_bytes));
  if (tail.get<std::uint64_t>() != impl::checksum(bytes, check) || tail.get<std::byte>() != whole) damaged();
  message.assign(bytes.begin(), bytes.end());
  return true;
}

JournalContents survey(std::span<const std::byte> bytes, std::string_view name) {
  ByteReader in(bytes);
  if (in.get<std::uint64_t>() != magic)
    fail(ErrorKind::input, "{}: is no journal of a terrain's edits; check the path", name);
  const auto version = in.get<std::uint64_t>();
  JournalContents contents;
  contents.base = in.get<Digest>();
  if (in.get<std::uint64_t>() != impl::checksum(bytes.first(std::min(bytes.size(), header_bytes - 8))))
    fail(ErrorKind::input, "{}: its header is damaged; restore the journal from a copy", name);
  if (version != format_version)
    fail(ErrorKind::input, "{}: is a journal of version {}, this program reads {}; use a newer one", name,
         version, format_version);

  std::size_t written = bytes.size();
  while (bytes[written - 1] == std::byte{0} && written > header_bytes) --written;
  std::size_t at = header_bytes;
  Message message;
  std::uint32_t number = 1;
  try {
    while (at < written && take(bytes.subspan(at), written - at, contents.base, number, name, message)) {
      at += head_bytes + message.size() + tail_bytes;
      contents.edits.push_back(std::move(message));
      ++number;
    }
  } catch (const Error& error) {
    contents.damage = error.what();
  }
  contents.bytes = at;
  contents.torn = bytes.size() - at;
  return contents;
}

void put_journal(AtomicFile& out, Digest base, const std::vector<Message>& edits) {
  const auto head = header(base);
  out.write(head.data(), head.size());
  std::uint32_t number = 0;
  for (const Message& message : edits) {
    ByteWriter record;
    put_record(record, base, ++number, message);
    out.write(record.bytes.data(), record.bytes.size());
  }
}

/// Held while the file is replaced. Throws where somebody appends to it.
inner::FileLock lock_journal(const std::filesystem::path& file) {
  if (auto lock = inner::FileLock::take(file, std::chrono::milliseconds(0))) return std::move(*lock);
  fail(ErrorKind::output, "cannot write {}: a program records in it; end that first, or give another name",
       file.string());
}

}  // namespace

JournalContents parse_journal(std::span<const std::byte> bytes, std::string_view name) {
  JournalContents contents = survey(bytes, name);
  if (!contents.damage.empty()) throw Error(ErrorKind::input, contents.damage);
  return contents;
}

JournalContents read_journal(const std::filesystem::path& file) {
  const std::string bytes = InputFile(file).whole();
  return parse_journal(std::as_bytes(std::span(bytes)), file.string());
}

JournalContents survey_journal(const std::filesystem::path& file) {
  const std::string bytes = InputFile(file).whole();
  return survey(std::as_bytes(std::span(bytes)), file.string());
}

bool is_journal(const std::filesystem::path& file) {
  std::error_code code;
  if (!std::filesystem::is_regular_file(file, code)) return false;
  std::uint64_t begin = 0;
  std::ifstream in(file, std::ios::binary);
  in.read(reinterpret_cast<char*>(&begin), sizeof begin);
  return in && begin == magic;
}

void write_journal(const std::filesystem::path& file, Digest base, const std::vector<Message>& edits) {
  const inner::FileLock lock = lock_journal(file);
  AtomicFile out(file);
  put_journal(out, base, edits);
  out.commit();
}

bool make_journal(const std::filesystem::path& file, Digest base, const std::vector<Message>& edits) {
  std::error_code missing;
  const auto has_bytes = [&] { return std::filesystem::file_size(file, missing) > 0 && !missing; };
  if (has_bytes()) return false;
  const inner::FileLock lock = lock_journal(file);
  if (has_bytes()) return false;  // another made it meanwhile
  AtomicFile out(file);
  put_journal(out, base, edits);
  if (missing) return out.commit_new();
  out.commit();
  return true;
}

JournalWriter::JournalWriter(std::filesystem::path file, const JournalContents& contents)
    : file_(std::move(file)),
      base_(contents.base),
      bytes_(contents.bytes),
      count_(static_cast<std::uint32_t>(contents.edits.size())),
      torn_(contents.torn > 0) {
  const auto give_up = [&](const char* what, const char* remedy) {
    if (fd_ >= 0) ::close(fd_);
    fail(ErrorKind::output, "cannot append to {}: {}; {}", file_.string(), what, remedy);
  };
  fd_ = ::open(file_.c_str(), O_RDWR | O_CLOEXEC);
  if (fd_ < 0) give_up(std::strerror(errno), "check the permissions of the file and its folder");
  if (inner::try_lock(fd_) == inner::Locked::no)
    give_up("another program records in it", "end that first, or record in another file");
  const off_t end = ::lseek(fd_, 0, SEEK_END);
  if (end < 0) give_up(std::strerror(errno), "record in a plain file");
  if (static_cast<std::uint64_t>(end) != contents.bytes + contents.torn || !inner::leads_to(file_, fd_))
    give_up("it was changed while it was read", "try again");
}

JournalWriter::JournalWriter(JournalWriter&& other) noexcept
    : file_(std::move(other.file_)),
      fd_(std::exchange(other.fd_, -1)),
      base_(other.base_),
      bytes_(other.bytes_),
      count_(other.count_),
      torn_(other.torn_) {}

JournalWriter::~JournalWriter() {
  if (fd_ >= 0) ::close(fd_);
}

bool JournalWriter::cut() {
  const auto end = static_cast<off_t>(bytes_);
  return ::ftruncate(fd_, end) == 0 && ::lseek(fd_, 0, SEEK_END) == end;
}

void JournalWriter::append(std::span<const Message> messages) {
  if (torn_ && !cut())
    fail(ErrorKind::output,
         "cannot append to {}: an unfinished edit at its end cannot be cut off: {}; the edit was not made",
         file_.string(), std::strerror(errno));
  torn_ = false;
  ByteWriter records;
  std::uint32_t number = count_;
  for (const Message& message : messages) put_record(records, base_, ++number, message);
  std::size_t done = 0;
  while (done < records.bytes.size()) {
    const ssize_t n = ::write(fd_, records.bytes.data() + done, records.bytes.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n >= 0) {
      done += n;
      continue;
    }
    const int error = errno;
    torn_ = !cut();
    fail(ErrorKind::output, "cannot append to {}: {}; the edit was not made", file_.string(),
         std::strerror(error));
  }
  bytes_ += records.bytes.size();
  count_ = number;
}

void JournalWriter::sync() {
  if (::fsync(fd_) != 0 && errno != EINVAL && errno != EROFS)
    fail(ErrorKind::output, "cannot write {}: {}; check the disk", file_.string(), std::strerror(errno));
}

bool JournalWriter::writes_to(const std::filesystem::path& file) const {
  return inner::leads_to(file, fd_);
}

}  // namespace tafoni::runtime
