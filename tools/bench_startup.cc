// SPDX-License-Identifier: Apache-2.0
// The program that CMake names (SAGITTA_PROGRAM, SAGITTA_PICTURES_MODULE) on a prescription of systems/ (SAGITTA_SOURCE_DIR).
#include "tools/bench_startup.h"

#include <benchmark/benchmark.h>
#include <elf.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <vector>

#include "tools/bench_program.h"

namespace sagitta::bench {
namespace {

namespace fs = std::filesystem;

const std::string triplet = SAGITTA_SOURCE_DIR "/systems/cooke-triplet.yaml";

struct Command {
  const char* name;
  const char* shown;
  std::vector<std::string> arguments;
};
const std::vector<Command>& commands() {
  static const std::vector<Command> all{
      {"startup_version", "--version", {"--version"}},
      {"startup_check", "check cooke-triplet.yaml", {"check", triplet}},
      {"startup_rays", "rays cooke-triplet.yaml", {"rays", triplet}},
      {"startup_trace", "trace cooke-triplet.yaml --only spot --rays 100", {"trace", triplet, "--only", "spot", "--rays", "100", "--threads", "1", "-o"}}};
  return all;
}

double middle(std::vector<double> values) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

void measure(benchmark::State& state, const Command& command) {
  const fs::path folder = fs::temp_directory_path() / ("sagitta-bench-" + std::to_string(getpid()));
  std::vector<std::string> arguments = command.arguments;
  if (arguments.back() == "-o") arguments.push_back(folder.string());
  std::vector<double> process_ms, clock_ms;
  for (auto _ : state) {
    const auto run = run_program(arguments);
    if (!run) {
      state.SkipWithError("the program failed");
      break;
    }
    state.SetIterationTime(run->processor);
    process_ms.push_back(1e3 * run->processor);
    clock_ms.push_back(1e3 * run->wall);
  }
  fs::remove_all(folder);
  if (process_ms.empty()) return;
  state.counters["process_ms"] = middle(process_ms);
  state.counters["clock_ms"] = middle(clock_ms);
}

// Bytes of the section .text of a 64-bit ELF file; 0 where it has none.
std::size_t text_size(const std::string& bytes) {
  Elf64_Ehdr header;
  if (bytes.size() < sizeof header) return 0;
  std::memcpy(&header, bytes.data(), sizeof header);
  if (std::memcmp(header.e_ident, ELFMAG, SELFMAG) != 0 || header.e_ident[EI_CLASS] != ELFCLASS64) return 0;
  std::vector<Elf64_Shdr> sections(header.e_shnum);
  if (header.e_shoff + sections.size() * sizeof(Elf64_Shdr) > bytes.size() || header.e_shstrndx >= sections.size()) return 0;
  std::memcpy(sections.data(), bytes.data() + header.e_shoff, sections.size() * sizeof(Elf64_Shdr));
  for (const Elf64_Shdr& section : sections) {
    const std::size_t name = sections[header.e_shstrndx].sh_offset + section.sh_name;
    if (name < bytes.size() && bytes.compare(name, 6, std::string(".text\0", 6)) == 0) return section.sh_size;
  }
  return 0;
}

std::string sizes(const char* what, const char* file) {
  std::ifstream stream(file, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  return fmt::format("{:<49}{:>12.2f}{:>10.2f}\n", what, 1e-6 * static_cast<double>(bytes.size()), 1e-6 * static_cast<double>(text_size(bytes)));
}

}  // namespace

void register_startup() {
  for (const Command& command : commands())
    benchmark::RegisterBenchmark(command.name, [&command](benchmark::State& state) { measure(state, command); })->UseManualTime()->Unit(benchmark::kMillisecond);
}

void print_startup(const Medians& medians) {
  std::string rows;
  for (const Command& command : commands()) {
    const double process = median(medians, command.name, "process_ms");
    if (!std::isnan(process)) rows += fmt::format("{:<49}{:>12.2f}{:>10.2f}\n", command.shown, process, median(medians, command.name, "clock_ms"));
  }
  if (rows.empty()) return;
  fmt::print("\nThe program from its start to its end, milliseconds, medians of all runs: of the processor (user and system), and of the\n"
             "clock; and its size in megabytes, the file and its section .text\n\n{:<49}{:>12}{:>10}\n{}\n{:<49}{:>12}{:>10}\n{}{}",
             "sagitta", "processor", "clock", rows, "", "file", ".text", sizes("sagitta", SAGITTA_PROGRAM),
             sizes("libsagitta_pictures.so", SAGITTA_PICTURES_MODULE));
}

}  // namespace sagitta::bench
