// `gelenkd --health-check` beside a gelenkd that serves, and without one.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <string>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "absl/time/time.h"
#include "tests/testing/server_process.h"

namespace gelenk {
namespace {

// Of a command of the shell, in silence.
int ExitCode(const std::string& command) {
  const int status =
      std::system(absl::StrCat(command, " >/dev/null 2>&1").c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST(HealthCheckTest, SaysWhetherTheServerServes) {
  testing::ServerProcess server(GELENKD);
  ASSERT_EQ(server.Start(), absl::OkStatus());
  const std::string by_flag = absl::StrCat(
      "timeout 60 " GELENKD " --health-check --listen ", server.target());
  const std::string by_environment =
      absl::StrCat("GELENKD_LISTEN=", server.target(),
                   " timeout 60 " GELENKD " --health-check");
  EXPECT_EQ(ExitCode(by_flag), 0);
  EXPECT_EQ(ExitCode(by_environment), 0);
  EXPECT_EQ(server.Terminate(absl::Seconds(20)), 0);
  EXPECT_EQ(ExitCode(by_flag), 1);
  EXPECT_EQ(ExitCode(by_environment), 1);
}

// It listens everywhere; the check has to find an address to call.
TEST(HealthCheckTest, FindsAServerThatListensOnEveryAddress) {
  testing::ServerProcess server(GELENKD);
  ASSERT_EQ(server.Start(), absl::OkStatus());
  EXPECT_EQ(ExitCode(absl::StrCat("timeout 60 " GELENKD
                                  " --health-check --listen 0.0.0.0:",
                                  server.port())),
            0);
}

TEST(HealthCheckTest, AWrongFlagIsNoAnswer) {
  EXPECT_EQ(ExitCode("timeout 60 " GELENKD " --health-check=often"), 2);
}

}  // namespace
}  // namespace gelenk
