// Runs a fuzz target without a fuzzer: every seed, then mutations of seeds that
// are the same on every machine. Finds what a change breaks, not what nobody
// has thought of; that is libFuzzer's work.
//
//   <fuzzer>_replay <folder of seeds or file> [dictionary]

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/escaping.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size);

namespace {

constexpr int kMutations = 200000;
// A slow machine or a sanitizer gets through fewer.
constexpr std::chrono::seconds kTimeLimit{20};
constexpr size_t kMaxBytes = 1 << 16;

std::string ReadFile(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::vector<std::string> ReadSeeds(const std::filesystem::path& path) {
  if (std::filesystem::is_regular_file(path)) return {ReadFile(path)};
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::directory_iterator(path)) {
    paths.push_back(entry.path());
  }
  std::sort(paths.begin(), paths.end());
  std::vector<std::string> seeds;
  for (const auto& seed : paths) seeds.push_back(ReadFile(seed));
  return seeds;
}

// The quoted words of a libFuzzer dictionary.
std::vector<std::string> ReadDictionary(const std::filesystem::path& path) {
  std::vector<std::string> words;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    const size_t first = line.find('"');
    const size_t last = line.rfind('"');
    if (line.starts_with("#") || first == last) continue;
    std::string word;
    if (absl::CUnescape(line.substr(first + 1, last - first - 1), &word)) {
      words.push_back(word);
    }
  }
  return words;
}

class Mutator {
 public:
  Mutator(std::vector<std::string> seeds, std::vector<std::string> words)
      : seeds_(std::move(seeds)), words_(std::move(words)) {}

  // A seed with one to eight small changes.
  std::string Next() {
    std::string text = seeds_[Below(seeds_.size())];
    for (size_t changes = 1 + Below(8); changes > 0; --changes) Change(text);
    if (text.size() > kMaxBytes) text.resize(kMaxBytes);
    return text;
  }

 private:
  size_t Below(size_t end) {
    // Not a distribution: those differ between standard libraries.
    return end == 0 ? 0 : random_() % end;
  }

  void Change(std::string& text) {
    const size_t at = Below(text.size() + 1);
    const size_t length = Below(std::min<size_t>(64, text.size() - at) + 1);
    switch (Below(6)) {
      case 0:
        if (at < text.size()) text[at] = static_cast<char>(random_());
        break;
      case 1:
        text.erase(at, length);
        break;
      case 2:
        text.insert(Below(text.size() + 1), text.substr(at, length));
        break;
      case 3:
        if (!words_.empty()) text.insert(at, words_[Below(words_.size())]);
        break;
      case 4:
        if (!words_.empty()) {
          text.replace(at, length, words_[Below(words_.size())]);
        }
        break;
      case 5: {
        const std::string& other = seeds_[Below(seeds_.size())];
        text = text.substr(0, at) + other.substr(Below(other.size() + 1));
        break;
      }
    }
  }

  std::vector<std::string> seeds_;
  std::vector<std::string> words_;
  std::mt19937 random_{1};
};

void Run(const std::string& input) {
  LLVMFuzzerTestOneInput(reinterpret_cast<const uint8_t*>(input.data()),
                         input.size());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: %s <seeds> [dictionary]\n", argv[0]);
    return 2;
  }
  const std::vector<std::string> seeds = ReadSeeds(argv[1]);
  if (seeds.empty()) {
    std::fprintf(stderr, "no seeds in %s\n", argv[1]);
    return 2;
  }
  for (const std::string& seed : seeds) Run(seed);
  std::vector<std::string> words;
  if (argc > 2) words = ReadDictionary(argv[2]);
  Mutator mutator(seeds, words);
  const auto end = std::chrono::steady_clock::now() + kTimeLimit;
  int mutations = 0;
  while (mutations < kMutations && std::chrono::steady_clock::now() < end) {
    Run(mutator.Next());
    ++mutations;
  }
  std::printf("%zu seeds and %d mutations\n", seeds.size(), mutations);
  return 0;
}
