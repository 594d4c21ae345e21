// SPDX-License-Identifier: Apache-2.0
// Input that is made to hurt: too large to be stored in bad/, or met by the thousand.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include "lib/prescription/reader.h"
#include "tests/prescription/support.h"

namespace sagitta::prescription {
namespace {

#if defined(__SANITIZE_ADDRESS__)
constexpr bool measures_memory = false;  // the sanitizer's own memory drowns the program's
constexpr unsigned most_seconds = 120;
#else
constexpr bool measures_memory = true;
constexpr unsigned most_seconds = 20;  // the slowest takes about one
#endif

struct Outcome {
  bool is_refused;  // ended by itself, with errors and no model
  long grown_kib;   // growth of the peak of memory
};

// Reads the file in a process of its own, which is ended after most_seconds.
Outcome read_apart(const std::string& file) {
  const pid_t child = ::fork();
  if (child == 0) {
    ::alarm(most_seconds);
    rusage before{}, after{};
    ::getrusage(RUSAGE_SELF, &before);
    const ReadResult result = read_prescription(file);
    ::getrusage(RUSAGE_SELF, &after);
    const long grown_mib = (after.ru_maxrss - before.ru_maxrss) / 1024 + 1;
    ::_exit(result.model || !result.findings.has_errors() ? 255 : static_cast<int>(std::min(grown_mib, 254L)));
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  const bool ended = WIFEXITED(status) && WEXITSTATUS(status) != 255;
  return {ended, ended ? WEXITSTATUS(status) * 1024L : 0};
}

std::string repeated(const std::string& unit, std::size_t bytes) {
  std::string text;
  text.reserve(bytes + unit.size());
  while (text.size() < bytes) text += unit;
  text.resize(bytes);
  return text;
}

// yaml-cpp's queue of tokens, its stack of simple keys and its look-ahead are what each of these fills.
TEST(HostileInput, OfAMebibyteIsRefusedInTimeAndMemory) {
  const std::vector<std::string> units{"[",    "{",   "{[", "[a",  "[:",     "[?",   "[],", ",", "- ",  "? ", "a: ",
                                       "a:\n", ":\n", "\"", "'",   "\"a\" ", "&a ",  "&",   "*", "*a ", "!",  "!a ",
                                       "# ",   "|\n", "> ", "a\n", "---\n",  "%a\n", "\t",  "a", "\r",  "`",  "@"};
  const std::vector<std::string> beginnings{"", "[", "{", "- &a x\n- ", "a: \"", "a: |\n  "};
  const test::TemporaryFolder folder;
  int refused_count = 0;
  for (const std::string& beginning : beginnings)
    for (const std::string& unit : units) {
      const std::string text = beginning + repeated(unit, (std::size_t{1} << 20) - beginning.size());
      const Outcome outcome = read_apart(folder.write("hostile.yaml", text));
      EXPECT_TRUE(outcome.is_refused) << beginning << unit;
      refused_count += outcome.is_refused;
      EXPECT_TRUE(!measures_memory || outcome.grown_kib <= 240 * 1024) << beginning << unit << outcome.grown_kib;
    }
  EXPECT_EQ(refused_count, 33 * 6);
}

TEST(HostileInput, OfSixtyMegabytesIsNotEvenRead) {
  const test::TemporaryFolder folder;
  for (const std::string unit : {"[", "- ", "a: "}) {
    const Outcome outcome = read_apart(folder.write("huge.yaml", repeated(unit, 60'000'000)));
    EXPECT_TRUE(outcome.is_refused) << unit;
    EXPECT_TRUE(!measures_memory || outcome.grown_kib <= 8 * 1024) << unit << outcome.grown_kib;
  }
  EXPECT_TRUE(read_apart("/dev/zero").is_refused);
}

TEST(HostileInput, OfManyFaultsGetsAHundredErrorsAndACount) {
  std::string text;
  for (int i = 0; i < 1000; ++i) text += "key" + std::to_string(i) + ": 0\n";
  const ReadResult result = test::read_text(text);
  EXPECT_EQ(result.findings.error_count(), 100);
  EXPECT_EQ(result.findings.all().back().what, "and 904 more errors");  // 1000 unknown keys and 4 missing ones
}

const std::string valid = R"(sagitta: 1
name: &title "an eye: \u00e9 \x41"
source: >
  folded
  text
wavelengths_nm: [486.1, 543, 656.3]
primary_nm: 543
aperture: {stop_diameter_mm: 4}
fields: {angles_deg: [[0, 0], [0, 10]]}
object: {distance_mm: 250.0, medium: air}
surfaces:
  - {name: *title, conic: {radius_mm: 7.72, conic_constant: -0.26}, thickness_mm: 0.55, medium: {index: 1.3777}}
  - {conic: {radius_mm: .inf}, thickness_mm: 3.05, medium: {nd: 1.5168, vd: 64.17}, tilt_deg: [0, 1, 0]}
  - {name: 'pupil', stop: true, thickness_mm: 0, medium: &glass N-BK7, semi_diameter_mm: 2}
  - zernike:
      radius_mm: -6
      normalization_radius_mm: 3
      indexing: noll
      coefficients_um: {4: 0.1, 11: -2e-2}   # a comment
    thickness_mm: 16.3
    medium: *glass
  - {plane: {}, thickness_mm: -3, medium: mirror}
  - {}
)";

// One to four edits of a valid file: a byte changed, a piece cut out, doubled or moved, or a token put in.
std::string mutated(std::string text, std::mt19937_64& random) {
  static const std::vector<std::string> tokens{"[",        "]",    "{",  "}",     ":",    ": ",    ",",
                                               "- ",       "\n",   "  ", "\t",    "&a ",  "*a",    "!!str ",
                                               "|",        ">",    "\"", "'",     "#",    "---\n", "...\n",
                                               ".nan",     ".inf", "-",  "1e999", "true", "\xff",  std::string(1, '\0'),
                                               "\xc2\x9b", "%",    "? ", "<<: ",  "null", "0",     "mirror"};
  const auto below = [&](std::size_t limit) {
    return static_cast<std::size_t>(random() % std::max<std::size_t>(limit, 1));
  };
  for (std::size_t edits = 1 + below(4); edits > 0; --edits) {
    const std::size_t at = below(text.size()), length = below(std::min<std::size_t>(text.size() - at, 40) + 1);
    switch (below(5)) {
      case 0:
        if (!text.empty()) text[at] = static_cast<char>(below(256));
        break;
      case 1:
        text.erase(at, length);
        break;
      case 2:
        text.insert(at, text.substr(at, length));
        break;
      case 3:
        text.insert(below(text.size()), text.substr(at, length));
        break;
      default:
        text.insert(at, tokens[below(tokens.size())]);
    }
  }
  return text;
}

TEST(HostileInput, MutatedFilesGiveEitherAModelOrErrors) {
  ASSERT_TRUE(test::read_text(valid).model) << test::text_of(test::read_text(valid).findings);
  std::mt19937_64 random(20'240'607);
  const test::TemporaryFolder folder;
  int model_count = 0;
  for (int i = 0; i < 20'000; ++i) {
    const std::string text = mutated(valid, random);
    const ReadResult result = read_prescription(folder.write("mutant.yaml", text));
    ASSERT_NE(result.model.has_value(), result.findings.has_errors()) << text;
    model_count += result.model.has_value();
  }
  // Both outcomes are met: some edits touch only a digit, a name or a comment.
  EXPECT_GT(model_count, 100);
  EXPECT_LT(model_count, 10'000);
}

}  // namespace
}  // namespace sagitta::prescription
