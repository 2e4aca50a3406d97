#include "console.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>

#include "interrupt.h"
#include "resources.h"

namespace foucault::app {
namespace {

using testing::HasSubstr;

TEST(Console, ResultsAndWarnings) {
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  {
    Console console(false);
    console.say("one");
    console.say(std::vector<std::string>{"two", "three"});
    console.warn("over\ntwo lines\n");
    console.warn("over\ntwo lines\n");  // once is enough
    console.progress("reading", 0.5);
    console.progress_of("reading")(1);
    console.say_once("four");
    console.say_once("four");
    Console(true).say("unheard");
  }
  print_error("wrong");
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "one\ntwo\nthree\nfour\n");
  EXPECT_THAT(testing::internal::GetCapturedStderr(),
              HasSubstr("foucault: warning: over two lines\nfoucault: error: wrong\n"));
}

TEST(Interrupt, WhatAShellIsTold) {
  EXPECT_EQ(Interrupted(SIGINT).exit_code(), 130);
  EXPECT_STREQ(Interrupted(SIGINT).what(), "interrupted");
  EXPECT_STREQ(Interrupted(SIGTERM).what(), "terminated");
  EXPECT_STREQ(Interrupted(SIGHUP).what(), "the terminal has gone");
  EXPECT_TRUE(Interrupted(SIGPIPE).is_silent());
  EXPECT_NO_THROW(stop_if_interrupted());
}

TEST(ResourceMeter, Counts) {
  const ResourceMeter meter;
  EXPECT_GE(meter.used().wall_s, 0);
  EXPECT_GT(meter.used().peak_rss_mb, 1);
}

}  // namespace
}  // namespace foucault::app
