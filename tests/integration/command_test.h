// The real `gelenk`, run in a folder of its own, and a real gelenkd beside it.
#ifndef GELENK_TESTS_INTEGRATION_COMMAND_TEST_H_
#define GELENK_TESTS_INTEGRATION_COMMAND_TEST_H_

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "tests/testing/server_process.h"
#include "tests/testing/walking_bvh.h"

namespace gelenk {

namespace fs = std::filesystem;
using nlohmann::json;

inline constexpr int kFrames = 80;

inline std::string Read(const fs::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

struct Ending {
  int exit_code = -1;
  std::string out;
  std::string err;
};

// A folder with a walk in it, and gelenk to be run there.
class CommandLineTest : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    Write("walk.bvh", gelenk::testing::WalkingBvh(kFrames));
  }
  void TearDown() override { fs::remove_all(folder_); }

  void Write(const std::string& name, const std::string& text) {
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }

  // `arguments` hold no quotes. Bounded in time; without a terminal.
  Ending Run(std::vector<std::string> arguments) {
    if (!server_.empty()) {
      arguments.insert(arguments.begin(), {"--server", server_});
    }
    const std::string command = absl::StrCat(
        "cd '", folder_.string(), "' && timeout 100 " GELENK " '",
        absl::StrJoin(arguments, "' '"), "' >out.txt 2>err.txt </dev/null");
    const int status = std::system(command.c_str());
    return {WEXITSTATUS(status), Read(folder_ / "out.txt"),
            Read(folder_ / "err.txt")};
  }

  // What a command that succeeds prints with --format json.
  json RunJson(std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"--format", "json"});
    const Ending ending = Run(arguments);
    EXPECT_EQ(ending.exit_code, 0) << ending.err;
    return json::parse(ending.out, nullptr, false);
  }

  const fs::path folder_ =
      fs::path(::testing::TempDir()) / absl::StrCat("gelenk-", getpid());
  std::string server_;
};

// With a service in its own process, and with one that runs.
enum class Host { kInProcess, kServer };

class ServedCommandTest : public CommandLineTest,
                          public ::testing::WithParamInterface<Host> {
 protected:
  void SetUp() override {
    CommandLineTest::SetUp();
    if (GetParam() == Host::kInProcess) return;
    ASSERT_EQ(gelenkd_.Start(), absl::OkStatus());
    server_ = gelenkd_.target();
  }

  gelenk::testing::ServerProcess gelenkd_{GELENKD};
};

inline std::string HostName(const ::testing::TestParamInfo<Host>& info) {
  return info.param == Host::kInProcess ? "InProcess" : "Server";
}

}  // namespace gelenk

#endif  // GELENK_TESTS_INTEGRATION_COMMAND_TEST_H_
