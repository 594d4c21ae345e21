// SPDX-License-Identifier: Apache-2.0
// The fuzzer (LLVM's libFuzzer, https://llvm.org/docs/LibFuzzer.html) of one target, $SAGITTA_FUZZ_TARGET.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <random>
#include <vector>

#include "lib/prescription/keys.h"
#include "lib/prescription/study_keys.h"
#include "tests/fuzz/targets.h"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

namespace {

using namespace sagitta;

const fuzz::Target& target() {
  static const fuzz::Target* const chosen = [] {
    const char* name = std::getenv("SAGITTA_FUZZ_TARGET");
    for (const fuzz::Target& one : fuzz::targets)
      if (name && one.name == name) return &one;
    std::fprintf(stderr, "SAGITTA_FUZZ_TARGET must be one of");
    for (const fuzz::Target& one : fuzz::targets) std::fprintf(stderr, " %s", std::string(one.name).c_str());
    std::fprintf(stderr, "\n");
    std::exit(2);
  }();
  return *chosen;
}

// Numbers at which arithmetic changes its ways, and the words of the formats: keys and choices from the tables that the readers
// go by.
const std::vector<std::string>& numbers() {
  static const std::vector<std::string> all{"0", "1", "-1", "2", "-0.0", "0.5", "1e-3", "1e3", "1e-9", "1e9", "1e-15", "1e15", "-1e15", "1e99", "-1e100", "1e-300",
                                            "4.9e-324", "1.8e308", ".inf", "-.inf", ".nan", "nan", "90", "180", "89.99999999", "-1.000000000000001",
                                            "-0.9999999999999999", "1.0000000000000002", "2147483648", "4294967296", "9223372036854775808", "18446744073709551616"};
  return all;
}
const std::vector<std::string>& words() {
  static const std::vector<std::string> all = [] {
    std::vector<std::string> found{": ", ", ", "\n", "\n- ", "\n  ", "{", "}", "[", "]", "&a ", "*a", "|", "#", "\"", "%%\n", "base.yaml", "cloud.xyz", "points.xyz", "points.polar",
                                   "points.cso", "points.ply", "glass", "mirror", "air", "true", "false", "DATA:", "type: ", "formula ", "tabulated n", "tabulated nk",
                                   "wavelength_range: ", "coefficients: ", "data: |\n", "NM ", "CD ", "LD ", "GC ", "\nSURF 1\n", "\n  TYPE ", "STANDARD", "COORDBRK", "EVENASPH", "SZERNSAG", "GRINSUR3", "\n  PARM 1 ", "\n  XDAT 2 ", "\n  CURV ", "\n  DISZ ", "INFINITY", "\n  GLAS ", "___BLANK 1 0 ", "MIRROR", "\n  STOP", "\nS 1 2 ", "\nSI 0 0\n", "; DAR; ", "; REV; ", "; BEN; ", "ADE ", "YDE ", "PIM", "REFL", "N-BK7", "517.642", "&\n", "formula Cornu", "Dato misurato : Elevazioni\n", "Anelli : ", "Semimeridiani : ", "---\n", "-1000", ";", "\t",
                                   "x,y,z\n", "ring,meridian,radius,z\n", "element vertex ", "element face ", "property double ", "property float ", "property list uchar int i\n",
                                   "format ascii 1.0\n", "format binary_little_endian 1.0\n", "format binary_big_endian 1.0\n", "end_header\n", "comment\n", "\r\n", "\xEF\xBB\xBF", "parameters: {A: 4}\n", "= A", "= 2 * ", "= max(A, ", "ln(", "-(", "^"};
    const auto take = [&](prescription::KeyTable table) {
      for (const numerics::Key& key : table) {
        found.push_back(std::string(key.name) + ": ");
        for (std::string& word : numerics::words_of(key.choices)) found.push_back(std::move(word));
      }
    };
    using namespace prescription;
    for (const KeyTable table : {KeyTable(system_keys), KeyTable(aperture_section_keys), KeyTable(field_keys), KeyTable(object_keys), KeyTable(surface_keys), KeyTable(medium_keys),
                                 KeyTable(study_keys), KeyTable(variant_keys), KeyTable(roughness_keys), KeyTable(paper_keys)})
      take(table);
    for (const ShapeKind& kind : shape_kinds()) {
      found.push_back(std::string(kind.name) + ": {");
      take(kind.keys);
    }
    return found;
  }();
  return all;
}

// A number that stands in the text becomes another one, or a word is put in at random.
std::string with_one_edit(std::string text, std::mt19937_64& random) {
  const auto below = [&](std::size_t limit) { return static_cast<std::size_t>(random() % std::max<std::size_t>(limit, 1)); };
  const std::size_t at = below(text.size() + 1);
  if (below(3) == 0) return text.insert(at, words()[below(words().size())]);
  constexpr std::string_view digits = "0123456789";
  std::size_t begin = text.find_first_of(digits, at);
  if (begin == std::string::npos) begin = text.find_first_of(digits);
  if (begin == std::string::npos) return text;
  while (begin > 0 && std::string_view("0123456789.+-eE").find(text[begin - 1]) != std::string_view::npos) --begin;
  const std::size_t length = std::min(text.find_first_not_of("0123456789.+-eE", begin), text.size()) - begin;
  const double value = std::strtod(text.substr(begin, length).c_str(), nullptr);
  switch (below(3)) {
    case 0: return text.replace(begin, length, numbers()[below(numbers().size())]);
    case 1: return text.replace(begin, length, fmt::format("{}", -value));
    default: return text.replace(begin, length, fmt::format("{:.4g}", value * std::exp(std::normal_distribution<double>()(random))));
  }
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  target();
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const fuzz::Folder folder;
  static const bool is_set_up = (fuzz::put_named_files(folder), true);
  const std::string wrong = is_set_up ? target().run(folder, {reinterpret_cast<const char*>(data), size}) : "";
  if (wrong.empty()) return 0;
  std::fprintf(stderr, "%s: %s\n", std::string(target().name).c_str(), wrong.c_str());
  std::abort();
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most, unsigned seed) {
  std::mt19937_64 random(seed);
  if (random() % 2 == 0) return LLVMFuzzerMutate(data, size, most);
  const std::string text = with_one_edit({reinterpret_cast<const char*>(data), size}, random);
  if (text.size() > most) return LLVMFuzzerMutate(data, size, most);
  std::memcpy(data, text.data(), text.size());
  return text.size();
}
