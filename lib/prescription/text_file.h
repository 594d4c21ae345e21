// SPDX-License-Identifier: Apache-2.0
// Files of text, whole: read up to a limit, and made UTF-8 whatever their encoding.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "lib/prescription/diagnostics.h"

namespace sagitta::prescription {

// The bytes of a file. An error where it is missing, a folder, unreadable, or larger than `most_bytes`, a whole number of MiB;
// `hint` is what to do then.
std::optional<std::string> read_file(const std::string& file, std::size_t most_bytes, const std::string& hint, Findings& findings);

// Whether a byte order mark says UTF-16; whether it is that without a mark, as the zero bytes tell: a Latin letter has one, before or behind it.
bool has_utf_16_mark(std::string_view bytes);
bool is_utf_16_without_mark(std::string_view bytes);

// The text as UTF-8, without a byte order mark. By that mark UTF-8 or UTF-16, either end first; without it UTF-8 where all bytes are,
// and else Latin-1, as instruments and programs of Windows write it. What is no character becomes U+FFFD.
std::string utf8_text(const std::string& bytes);

// Both: the text of a file. An error, too, where it is UTF-16 without a mark, which would be read as Latin-1 with zero bytes.
std::optional<std::string> read_text_file(const std::string& file, std::size_t most_bytes, const std::string& hint, Findings& findings);

}  // namespace sagitta::prescription
