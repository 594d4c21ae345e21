// SPDX-License-Identifier: Apache-2.0
#include "lib/output/progress.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pty.h>
#include <termios.h>
#include <unistd.h>

#include <thread>

namespace sagitta::output {
namespace {

using std::chrono::milliseconds;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

// A terminal whose text the test can read.
class Terminal {
 public:
  Terminal() {
    open_ = openpty(&master_, &slave_, nullptr, nullptr, nullptr) == 0;
    if (open_) fcntl(master_, F_SETFL, O_NONBLOCK);
  }
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;
  ~Terminal() {
    close(master_);
    close(slave_);
  }
  bool open() const { return open_; }
  int descriptor() const { return slave_; }
  std::string text() const {
    tcdrain(slave_);
    std::string all;
    char buffer[4096];
    for (ssize_t size = 0; (size = read(master_, buffer, sizeof buffer)) > 0;)
      all.append(buffer, static_cast<std::size_t>(size));
    return all;
  }

 private:
  int master_ = -1, slave_ = -1;
  bool open_ = false;
};

TEST(Progress, ATerminalSeesTheLineAndThenNothingOfIt) {
  const Terminal terminal;
  if (!terminal.open()) GTEST_SKIP() << "no pseudo terminal here";
  {
    Progress progress("tracing", 200, {terminal.descriptor(), milliseconds(0), milliseconds(0)});
    progress.advance(84);
    progress.advance();
    EXPECT_EQ(terminal.text(), "\rtracing  42 %\rtracing  42 %");
  }
  EXPECT_EQ(terminal.text(), "\r             \r");
}

// Half of the work in 50 ms and more leaves that time again: rounded up, a second; unknown before the first step.
TEST(Progress, TimeLeftIsThatOfTheStepsSoFar) {
  const Terminal terminal;
  if (!terminal.open()) GTEST_SKIP() << "no pseudo terminal here";
  {
    Progress progress("study", 200, {terminal.descriptor(), milliseconds(0), milliseconds(0), true});
    progress.advance(0);
    EXPECT_EQ(terminal.text(), "\rstudy  0 %");
    std::this_thread::sleep_for(milliseconds(50));
    progress.advance(100);
    EXPECT_THAT(terminal.text(), HasSubstr("\rstudy  50 %, 1 s left"));
    std::this_thread::sleep_for(milliseconds(1));
  }
  EXPECT_THAT(terminal.text(), EndsWith("\r"));
}

TEST(Progress, ShortWorkShowsNothing) {
  const Terminal terminal;
  if (!terminal.open()) GTEST_SKIP() << "no pseudo terminal here";
  { Progress("tracing", 10, {.descriptor = terminal.descriptor()}).advance(10); }
  EXPECT_EQ(terminal.text(), "");
}

TEST(Progress, UpdatesKeepTheirInterval) {
  const Terminal terminal;
  if (!terminal.open()) GTEST_SKIP() << "no pseudo terminal here";
  {
    Progress progress("tracing", 1000, {terminal.descriptor(), milliseconds(0), std::chrono::hours(1)});
    for (int i = 0; i < 1000; ++i) progress.advance();
  }
  EXPECT_EQ(terminal.text(), "\rtracing  0 %\r            \r");  // the first one, and its end
}

TEST(Progress, WhatIsNoTerminalGetsNothing) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  { Progress("tracing", 1, {ends[1], milliseconds(0), milliseconds(0)}).advance(); }
  close(ends[1]);
  char byte = 0;
  EXPECT_EQ(read(ends[0], &byte, 1), 0);
  close(ends[0]);
}

TEST(Progress, ManyThreadsMayAdvanceIt) {
  const Terminal terminal;
  if (!terminal.open()) GTEST_SKIP() << "no pseudo terminal here";
  Progress progress("tracing", 4001, {terminal.descriptor(), milliseconds(0), milliseconds(20)});
  {
    std::vector<std::jthread> threads;
    for (int t = 0; t < 4; ++t)
      threads.emplace_back([&] {
        for (int i = 0; i < 1000; ++i) progress.advance();
      });
  }
  std::this_thread::sleep_for(milliseconds(30));
  progress.advance();
  EXPECT_THAT(terminal.text(), AllOf(StartsWith("\rtracing"), EndsWith("\rtracing  100 %")));
}

TEST(Progress, SaysDurationsInWholeUnitsRoundedUp) {
  EXPECT_EQ(duration_in_words(0.2), "1 s");
  EXPECT_EQ(duration_in_words(44.2), "45 s");
  EXPECT_EQ(duration_in_words(99.9), "100 s");
  EXPECT_EQ(duration_in_words(100), "2 min");
  EXPECT_EQ(duration_in_words(241), "5 min");
}

}  // namespace
}  // namespace sagitta::output
