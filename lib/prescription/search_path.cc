// SPDX-License-Identifier: Apache-2.0
#include "lib/prescription/search_path.h"

#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>
#include <system_error>

namespace sagitta::prescription {
namespace {

namespace fs = std::filesystem;

bool is_file(const fs::path& path) {
  std::error_code failure;
  const fs::file_status status = fs::status(path, failure);
  return fs::exists(status) && !fs::is_directory(status);
}

}  // namespace

std::vector<std::string> search_folders(const std::string& beside) {
  std::vector<std::string> folders{beside.empty() ? "." : beside};
  if (const char* data = std::getenv("SAGITTA_DATA"); data && *data) folders.push_back(data);
  std::error_code failure;
  const fs::path program = fs::read_symlink("/proc/self/exe", failure);
  if (!failure) folders.push_back((program.parent_path().parent_path() / "share/sagitta").string());
  folders.push_back(SAGITTA_SOURCE_DIR);
  return folders;
}

std::optional<std::string> find_file(const std::string& name, const std::string& beside) {
  if (name.empty()) return std::nullopt;
  if (fs::path(name).is_absolute()) return is_file(name) ? std::optional(name) : std::nullopt;
  for (const std::string& folder : search_folders(beside)) {
    const fs::path path = (fs::path(folder) / name).lexically_normal();
    if (is_file(path)) return path.string();
  }
  return std::nullopt;
}

std::optional<std::string> find_named_file(const std::string& name, const Place& place, Findings& findings) {
  const std::string beside = fs::path(place.file).parent_path().string();
  std::optional<std::string> file = find_file(name, beside);
  if (!file)
    findings.error(place, fmt::format("there is no file '{}'", excerpt(name)),
                   fmt::format("looked for in {}", fmt::join(search_folders(beside), ", ")));
  return file;
}

}  // namespace sagitta::prescription
