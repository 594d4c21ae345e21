// SPDX-License-Identifier: Apache-2.0
// Runs the program as it is shipped and reads what it prints. Files go to a fresh folder per test.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

namespace sagitta::test {

inline std::string read_text(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

// A folder of its own for the running test, removed at the end.
class Folder {
 public:
  Folder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "sagitta-test-XXXXXX").string();
    path_ = mkdtemp(pattern.data());
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  std::string file(const std::string& name, const std::string& text) const {
    std::ofstream(path_ / name, std::ios::binary) << text;
    return (path_ / name).string();
  }
  std::string path(const std::string& name = {}) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_;
};

struct Outcome {
  int status = 0;  // exit status; 128 + signal where it was killed
  std::string out, err;
};

// `arguments` as a shell would take them.
inline Outcome run_program(const std::string& arguments, const std::string& before = {}, const char* program = SAGITTA_PROGRAM) {
  const Folder folder;
  const std::string command = before + "'" + program + "' " + arguments + " >'" + folder.path("out") + "' 2>'" + folder.path("err") + "'";
  const int status = std::system(command.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), read_text(folder.path("out")), read_text(folder.path("err"))};
}

// One row of `sagitta rays`.
struct RayRow {
  int ray, field, surface;
  double wavelength_nm, x, y, z, l, m, n, opl;
  std::string name, status;
};

inline std::vector<RayRow> parse_rays(const std::string& csv) {
  std::vector<RayRow> rows;
  std::istringstream stream(csv);
  std::string line;
  std::getline(stream, line);
  EXPECT_EQ(line, "ray,field,wavelength_nm,surface,name,x_mm,y_mm,z_mm,l,m,n,opl_mm,status");
  while (std::getline(stream, line)) {
    std::vector<std::string> cells;
    std::istringstream parts(line);
    for (std::string cell; std::getline(parts, cell, ',');) cells.push_back(cell);
    if (cells.size() != 13) {
      ADD_FAILURE() << "not 13 cells: " << line;
      continue;
    }
    const auto number = [&](std::size_t i) { return std::strtod(cells[i].c_str(), nullptr); };
    rows.push_back({std::stoi(cells[0]), std::stoi(cells[1]), std::stoi(cells[3]), number(2), number(5), number(6), number(7),
                    number(8), number(9), number(10), number(11), cells[4], cells[12]});
  }
  return rows;
}

// Runs `sagitta rays` on a system given as text; `rays` are lines "x,y,z,l,m,n".
inline std::vector<RayRow> trace_given(const std::string& system, const std::vector<std::string>& rays, int expected_status = 0) {
  const Folder folder;
  std::string csv = "x_mm,y_mm,z_mm,l,m,n\n";
  for (const std::string& ray : rays) csv += ray + "\n";
  const Outcome run = run_program("rays " + folder.file("system.yaml", system) + " --from " + folder.file("rays.csv", csv));
  EXPECT_EQ(run.status, expected_status) << run.err;
  return parse_rays(run.out);
}

}  // namespace sagitta::test
