// SPDX-License-Identifier: Apache-2.0
#include "lib/output/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

#include "lib/output/text.h"

namespace sagitta::output {

std::string duration_in_words(double seconds) {
  if (!(seconds < 100)) return fmt::format("{:.0f} min", std::ceil(seconds / 60));
  return fmt::format("{:.0f} s", std::ceil(seconds));
}

Progress::Progress(std::string what, std::uint64_t total, ProgressManners manners)
    : what_(printable(what, 40)),
      total_(std::max<std::uint64_t>(1, total)),
      manners_(manners),
      on_terminal_(::isatty(manners.descriptor) == 1),
      start_(std::chrono::steady_clock::now()),
      next_(start_ + manners.silence) {}

Progress::~Progress() {
  if (shown_ > 0) show({});
}

void Progress::advance(std::uint64_t steps) {
  const std::uint64_t done = std::min(total_, done_ += steps);
  if (!on_terminal_) return;
  const std::unique_lock lock(drawing_, std::try_to_lock);
  if (!lock) return;
  const auto now = std::chrono::steady_clock::now();
  if (now < next_) return;
  next_ = now + manners_.interval;
  const auto percent = static_cast<int>(100.0 * static_cast<double>(done) / static_cast<double>(total_));
  const bool tells = manners_.tells_time_left && done > 0;
  const double left = std::chrono::duration<double>(now - start_).count() * (static_cast<double>(total_) / static_cast<double>(std::max<std::uint64_t>(1, done)) - 1);
  show(fmt::format("{}  {} %{}", what_, percent, tells ? ", " + duration_in_words(left) + " left" : ""));
}

void Progress::show(std::string line) {
  const std::size_t width = line.size();
  if (width < shown_) line.append(shown_ - width, ' ');
  const std::string bytes = "\r" + line + (width == 0 ? "\r" : "");
  shown_ = width;
  // A terminal that does not take it costs a progress line, nothing else.
  [[maybe_unused]] const ssize_t written = ::write(manners_.descriptor, bytes.data(), bytes.size());
}

}  // namespace sagitta::output
