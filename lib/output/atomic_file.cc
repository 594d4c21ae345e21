// SPDX-License-Identifier: Apache-2.0
#include "lib/output/atomic_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <system_error>

namespace sagitta::output {
namespace {

// An open file that is closed and, unless it was moved to its place, removed.
class Temporary {
 public:
  explicit Temporary(const std::filesystem::path& target) {
    // The name is cut so that it stays a legal one where the target's own name is as long as names may be. A number
    // that is taken belongs to another thread, or to a killed process that had our id.
    const std::string stem = fmt::format(".{}.tmp-{}-", target.filename().string().substr(0, 200), ::getpid());
    for (int attempt = 0; attempt < 1000 && descriptor_ < 0; ++attempt) {
      path_ = target.parent_path() / (stem + std::to_string(attempt));
      descriptor_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
      if (descriptor_ < 0 && errno != EEXIST) break;
    }
    exists_ = descriptor_ >= 0;
  }
  Temporary(const Temporary&) = delete;
  Temporary& operator=(const Temporary&) = delete;
  ~Temporary() {
    if (descriptor_ >= 0) ::close(descriptor_);
    if (exists_) ::unlink(path_.c_str());
  }

  bool is_open() const { return descriptor_ >= 0; }

  bool write(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) return false;
      bytes.remove_prefix(static_cast<std::size_t>(written));
    }
    return true;
  }

  // A delayed write error (quota, network disk) shows in fsync or in close at the latest.
  bool finish() {
    if (::fsync(descriptor_) != 0) return false;
    const int descriptor = descriptor_;
    descriptor_ = -1;
    return ::close(descriptor) == 0;
  }

  bool move_to(const std::filesystem::path& target) {
    if (::rename(path_.c_str(), target.c_str()) != 0) return false;
    exists_ = false;
    return true;
  }

 private:
  std::filesystem::path path_;
  int descriptor_ = -1;
  bool exists_ = false;
};

}  // namespace

WriteResult write_file(const std::string& path, std::string_view bytes) {
  const std::filesystem::path target = path;
  const auto failure = [&](std::string_view what) {
    return WriteResult{fmt::format("{}: {}: {}", path, what, std::generic_category().message(errno))};
  };
  if (!target.has_filename()) return {fmt::format("'{}': not the name of a file", path)};

  Temporary temporary(target);
  if (!temporary.is_open()) return failure("cannot be created");
  if (!temporary.write(bytes) || !temporary.finish()) return failure("cannot be written");
  if (!temporary.move_to(target)) return failure("cannot be replaced");
  return {};
}

}  // namespace sagitta::output
