// SPDX-License-Identifier: Apache-2.0
// Writes a file whole or not at all: a full disk, a missing permission or a kill leaves the old file or the new one,
// never half. The bytes go to a temporary name in the same folder (".NAME.tmp-PID-0"), are forced to the disk, and the
// name is moved over the old one, which POSIX makes a single step. Every writer of this folder ends here.
//
// On any failure the temporary is removed and the old file stays as it was. A process that is killed outright can
// leave a temporary behind; it is never mistaken for a result and never in the way of a later run.
// Where RLIMIT_FSIZE is in force the kernel sends SIGXFSZ first: a program that wants the message instead of the
// signal ignores that signal.
#pragma once

#include <string>
#include <string_view>

namespace sagitta::output {

// What became of a file. The error, for the user, names the file and what the system said; empty: it is written.
struct WriteResult {
  std::string error;
  bool ok() const { return error.empty(); }
};

WriteResult write_file(const std::string& path, std::string_view bytes);

}  // namespace sagitta::output
