// kill_at N PATH COMMAND…: runs a command and kills it, with all of its threads, before the N-th system call
// counted from the first that names PATH; so that a test can look at what is left at every one of them.
// Prints "killed NAME" or "ended STATUS" on its last line of standard error, NAME being the number of the
// call.
//
// Counted are all calls of all threads, in the order in which they come; with --changes those alone that can
// change a file or take a lock, between which a kill leaves the same.

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <string>

#include <fcntl.h>
#include <signal.h>
#include <sys/ptrace.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <sys/wait.h>
#include <unistd.h>

namespace {

constexpr long changes[] = {
    SYS_open,      SYS_openat,   SYS_creat, SYS_write,  SYS_pwrite64,  SYS_writev,    SYS_pwritev,
    SYS_rename,    SYS_renameat, SYS_link,  SYS_linkat, SYS_renameat2, SYS_unlink,    SYS_unlinkat,
    SYS_mkdir,     SYS_mkdirat,  SYS_rmdir, SYS_fsync,  SYS_fdatasync, SYS_ftruncate, SYS_truncate,
    SYS_fallocate, SYS_fchmod,   SYS_flock, SYS_fcntl,  SYS_close,     SYS_symlink,   SYS_exit_group,
};
/// Those with a path, and which argument it is.
struct Named {
  long call;
  int argument;
};
constexpr Named named[] = {{SYS_open, 0},  {SYS_openat, 1}, {SYS_stat, 0},     {SYS_newfstatat, 1},
                           {SYS_lstat, 0}, {SYS_access, 0}, {SYS_readlink, 0}, {SYS_statx, 1}};

std::string text_at(pid_t thread, unsigned long long address) {
  char text[4097] = {};
  // Not across the end of a page, behind which there may be nothing.
  const std::size_t most = 4096 - address % 4096;
  iovec local{text, most}, remote{reinterpret_cast<void*>(address), most};
  if (::process_vm_readv(thread, &local, 1, &remote, 1, 0) <= 0) return {};
  return text;
}

bool names(pid_t thread, const __ptrace_syscall_info& call, const std::string& path) {
  const auto found = std::find_if(std::begin(named), std::end(named),
                                  [&](const Named& n) { return n.call == static_cast<long>(call.entry.nr); });
  return found != std::end(named) && text_at(thread, call.entry.args[found->argument]) == path;
}

int fail(const char* what) {
  std::perror(what);
  return 125;
}

}  // namespace

int main(int argc, char** argv) {
  int at = 1;
  const bool only_changes = argc > at && std::string(argv[at]) == "--changes";
  if (only_changes) ++at;
  if (argc < at + 3) return fail("kill_at [--changes] N PATH COMMAND");
  const long wanted = std::atol(argv[at]);
  const std::string path = argv[at + 1];
  const pid_t child = ::fork();
  if (child == 0) {
    ::ptrace(PTRACE_TRACEME, 0, nullptr, nullptr);
    ::raise(SIGSTOP);
    ::execvp(argv[at + 2], argv + at + 2);
    ::_exit(127);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  if (::ptrace(PTRACE_SETOPTIONS, child, nullptr,
               PTRACE_O_TRACESYSGOOD | PTRACE_O_TRACECLONE | PTRACE_O_EXITKILL | PTRACE_O_TRACEEXEC) != 0)
    return fail("ptrace");
  ::ptrace(PTRACE_SYSCALL, child, nullptr, nullptr);
  bool begun = false;
  long count = 0, killed_at = -1;
  for (;;) {
    const pid_t thread = ::waitpid(-1, &status, __WALL);
    if (thread < 0) return fail("waitpid");
    if (WIFEXITED(status) || WIFSIGNALED(status)) {
      if (thread == child) break;
      continue;
    }
    int signal = WSTOPSIG(status);
    if (signal == (SIGTRAP | 0x80)) {
      signal = 0;
      __ptrace_syscall_info call{};
      ::ptrace(PTRACE_GET_SYSCALL_INFO, thread, sizeof call, &call);
      if (call.op == PTRACE_SYSCALL_INFO_ENTRY && killed_at < 0) {
        const long number = static_cast<long>(call.entry.nr);
        begun = begun || names(thread, call, path);
        const bool counts = begun && (!only_changes || std::find(std::begin(changes), std::end(changes),
                                                                 number) != std::end(changes));
        if (counts && ++count == wanted) {
          killed_at = number;
          ::kill(child, SIGKILL);
        }
      }
    } else if (signal == SIGTRAP || signal == SIGSTOP) {
      signal = 0;  // of a new thread, or of exec
    }
    ::ptrace(PTRACE_SYSCALL, thread, nullptr, signal);
  }
  if (killed_at >= 0)
    std::fprintf(stderr, "killed %ld\n", killed_at);
  else
    std::fprintf(stderr, "ended %d %ld\n", WIFEXITED(status) ? WEXITSTATUS(status) : -1, count);
  return 0;
}
