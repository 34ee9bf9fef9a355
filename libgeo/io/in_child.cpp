// in_child() of io/in_child.h. The child is made by fork(): glibc keeps malloc() usable in it. It
// sends its result through a pipe, behind one byte that says whether it is a result or a message.
#include "io/in_child.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <fstream>
#include <new>
#include <sstream>

#include "kerf/error.h"

namespace geo {
namespace {

constexpr char result_mark = 'r', message_mark = 'm';
constexpr int exit_done = 0, exit_no_memory = 3;

// Bytes of address space that this process has mapped.
std::size_t mapped() {
  std::ifstream file("/proc/self/statm");
  std::size_t pages = 0;
  file >> pages;
  return pages * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
}

void set_limit(__rlimit_resource what, rlim_t value) {
  rlimit now{};
  if (::getrlimit(what, &now) != 0) return;
  now.rlim_cur = std::min(value, now.rlim_max);
  ::setrlimit(what, &now);
}

// Sets limits, default signals and an empty standard error in the child.
void confine(const ChildLimits& limits, std::size_t base) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  for (const int signal : {SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT, SIGXCPU, SIGPIPE, SIGTERM, SIGINT})
    ::signal(signal, SIG_DFL);
  set_limit(RLIMIT_CORE, 0);
  set_limit(RLIMIT_CPU, limits.seconds);
  set_limit(RLIMIT_AS, base + limits.memory);
  if (const int null = ::open("/dev/null", O_WRONLY | O_CLOEXEC); null >= 0) ::dup2(null, STDERR_FILENO);
}

bool send(int pipe, const char* data, std::size_t size) {
  while (size > 0) {
    const auto n = ::write(pipe, data, size);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return false;
    data += n;
    size -= static_cast<std::size_t>(n);
  }
  return true;
}

// The child's life; returns its exit code.
int live(const std::function<void(std::ostream&)>& work, int pipe) {
  std::string bytes(1, message_mark);
  try {
    std::ostringstream out;
    work(out);
    bytes = result_mark + std::move(out).str();
  } catch (const std::bad_alloc&) {
    return exit_no_memory;
  } catch (const std::exception& error) {
    bytes += error.what();
  }
  return send(pipe, bytes.data(), bytes.size()) ? exit_done : 1;
}

// Reads to the end of the pipe; false after `seconds` by the clock.
bool receive(int pipe, std::string& bytes, unsigned seconds) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(seconds);
  std::array<char, 1 << 16> buffer;
  for (;;) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - std::chrono::steady_clock::now());
    if (left.count() <= 0) return false;
    pollfd ready{pipe, POLLIN, 0};
    const int count = ::poll(&ready, 1, static_cast<int>(left.count()));
    if (count < 0 && errno != EINTR) return true;
    if (count <= 0) continue;
    const auto n = ::read(pipe, buffer.data(), buffer.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return true;
    bytes.append(buffer.data(), static_cast<std::size_t>(n));
  }
}

std::string seconds_text(unsigned seconds) { return "takes longer than " + std::to_string(seconds) + " s"; }

std::string reason(int status, const ChildLimits& limits) {
  if (WIFEXITED(status) && WEXITSTATUS(status) == exit_no_memory)
    return "needs more than " + std::to_string(limits.memory >> 20) + " MB of memory";
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU) return seconds_text(limits.seconds);
  if (WIFSIGNALED(status)) return "crashes (signal " + std::to_string(WTERMSIG(status)) + ")";
  return "ends early";
}

}  // namespace

std::string in_child(const std::function<void(std::ostream&)>& work, const ChildLimits& limits) {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) throw ChildFailure(std::string("cannot start (") + std::strerror(errno) + ")");
  const std::size_t base = mapped();
  const pid_t child = ::fork();
  if (child == 0) {
    ::close(ends[0]);
    confine(limits, base);
    ::_exit(live(work, ends[1]));
  }
  ::close(ends[1]);
  if (child < 0) {
    ::close(ends[0]);
    throw ChildFailure(std::string("cannot start (") + std::strerror(errno) + ")");
  }
  std::string bytes;
  const bool in_time = receive(ends[0], bytes, 3 * limits.seconds);
  ::close(ends[0]);
  if (!in_time) ::kill(child, SIGKILL);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (!in_time) throw ChildFailure(seconds_text(3 * limits.seconds));
  if (!WIFEXITED(status) || WEXITSTATUS(status) != exit_done || bytes.empty())
    throw ChildFailure(reason(status, limits));
  if (bytes[0] == message_mark) throw InputError(bytes.substr(1));
  bytes.erase(0, 1);
  return bytes;
}

}  // namespace geo
