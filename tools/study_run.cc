// SPDX-License-Identifier: Apache-2.0
#include "tools/study_run.h"

#include <fmt/format.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#if defined(__linux__)
#include <sys/prctl.h>
#endif
#if defined(__GLIBC__)
#include <malloc.h>
#endif

#include <cerrno>
#include <csignal>
#include <cstring>
#include <new>
#include <system_error>
#include <type_traits>

namespace sagitta::tools {
namespace {

// What goes through the pipe: one byte that says which, then the bytes of this, for it is the same program that reads them, or the reason.
constexpr char is_row = 'R', is_reason = 'F';
struct Sent {
  study::Row row;
  double start_mib;
};
static_assert(std::is_trivially_copyable_v<Sent>);

std::string message_of(const study::Measured& measured, double start_mib) {
  if (!measured.row) return is_reason + measured.reason;
  const Sent sent{*measured.row, start_mib};
  std::string message(1 + sizeof sent, is_row);
  std::memcpy(message.data() + 1, &sent, sizeof sent);
  return message;
}

double peak_mib_of(const rusage& used) { return static_cast<double>(used.ru_maxrss) / 1024; }  // KiB on Linux

// What earlier work has left free goes back to the system: a child would begin with it, and use it unseen.
void give_back_free_memory() {
#if defined(__GLIBC__)
  ::malloc_trim(0);
#endif
}

bool send(int descriptor, std::string_view message) {
  while (!message.empty()) {
    const ssize_t sent = ::write(descriptor, message.data(), message.size());
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) return false;
    message.remove_prefix(static_cast<std::size_t>(sent));
  }
  return true;
}

std::string receive(int descriptor, const std::function<void()>& waiting) {
  std::string message;
  for (;;) {
    pollfd ready{descriptor, POLLIN, 0};
    const int polled = ::poll(&ready, 1, 200);
    if (polled == 0) waiting();
    if (polled == 0 || (polled < 0 && errno == EINTR)) continue;
    char bytes[4096];
    const ssize_t count = ::read(descriptor, bytes, sizeof bytes);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return message;
    message.append(bytes, static_cast<std::size_t>(count));
  }
}

MeasuredRow measured_of(const std::string& message, int status, double peak_mib) {
  if (WIFSIGNALED(status))
    return {{{}, fmt::format("its process was ended by signal {} ({}){}", WTERMSIG(status), strsignal(WTERMSIG(status)), WTERMSIG(status) == SIGKILL ? ": short of memory, perhaps" : "")}, peak_mib};
  if (message.size() == 1 + sizeof(Sent) && message.front() == is_row) {
    Sent sent;
    std::memcpy(&sent, message.data() + 1, sizeof sent);
    return {{sent.row, {}}, peak_mib, peak_mib - sent.start_mib};
  }
  if (!message.empty() && message.front() == is_reason) return {{{}, message.substr(1)}, peak_mib};
  return {{{}, "its process ended without a result"}, peak_mib};
}

[[noreturn]] void be_child(study::Subject& subject, const study::Variant& variant, pid_t parent, int descriptor) {
#if defined(__linux__)
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(1);
#else
  static_cast<void>(parent);
#endif
  rusage used{};
  ::getrusage(RUSAGE_SELF, &used);
  std::string message;
  try {
    message = message_of(subject.measure(variant), peak_mib_of(used));
  } catch (const std::bad_alloc&) {
    message = is_reason + std::string("not enough memory");
  }
  ::_exit(send(descriptor, message) ? 0 : 1);
}

}  // namespace

MeasuredRow measure_apart(study::Subject& subject, const study::Variant& variant, const std::function<void()>& waiting) {
  const auto failure = [](const char* what) { return MeasuredRow{{{}, fmt::format("{}: {}", what, std::generic_category().message(errno))}, 0}; };
  give_back_free_memory();
  int ends[2];
  if (::pipe(ends) != 0) return failure("no pipe");
  const pid_t self = ::getpid(), child = ::fork();
  if (child == 0) {
    ::close(ends[0]);
    be_child(subject, variant, self, ends[1]);
  }
  const int fault = errno;
  ::close(ends[1]);
  if (child < 0) {
    ::close(ends[0]);
    errno = fault;
    return failure("no process");
  }
  const std::string message = receive(ends[0], waiting);
  ::close(ends[0]);
  int status = 0;
  rusage used{};
  while (::wait4(child, &status, 0, &used) < 0)
    if (errno != EINTR) return failure("a process is lost");
  return measured_of(message, status, peak_mib_of(used));
}

}  // namespace sagitta::tools
