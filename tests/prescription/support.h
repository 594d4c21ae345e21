// SPDX-License-Identifier: Apache-2.0
// What the tests of the readers share: prescriptions as texts, in a folder of their own that vanishes with them.
#pragma once

#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <string>

#include "lib/prescription/diagnostics.h"
#include "lib/prescription/reader.h"

namespace sagitta::prescription::test {

class TemporaryFolder {
 public:
  TemporaryFolder() {
    static std::atomic<int> serial{0};
    path_ = std::filesystem::temp_directory_path() /
            ("sagitta-test-" + std::to_string(::getpid()) + "-" + std::to_string(serial++));
    std::filesystem::create_directories(path_);
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  // A new file each time: some file systems bring a file that is written over to the disk at once, which takes longer.
  std::string write(const std::string& name, const std::string& text) const {
    std::filesystem::remove(path_ / name);
    std::ofstream(path_ / name, std::ios::binary) << text;
    return (path_ / name).string();
  }
  std::string path() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

// All findings as text, one after the other.
inline std::string text_of(const Findings& findings) {
  std::string text;
  for (const Finding& finding : findings.all()) text += format(finding) + "\n";
  return text;
}

inline ReadResult read_text(const std::string& text) {
  const TemporaryFolder folder;
  return read_prescription(folder.write("system.yaml", text));
}

}  // namespace sagitta::prescription::test
