// Runs every fuzz target on the stored inputs: the corpora, the seeds of seeds.txt, and damaged
// copies of them. What libFuzzer finds is stored in corpus/TARGET/ and so stays tested.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/fuzz/targets.h"

namespace bevloc::fuzz {
namespace {

using Input = std::vector<uint8_t>;
namespace fs = std::filesystem;

const fs::path kSource = BEVLOC_SOURCE_DIR;

Input read_input(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// All files of a folder, or those with an extension.
void add_files(const fs::path& folder, const std::string& extension, std::vector<fs::path>& files) {
  for (const auto& entry : fs::directory_iterator(folder)) {
    const bool wanted = extension.empty() || entry.path().extension() == extension;
    if (entry.is_regular_file() && wanted) files.push_back(entry.path());
  }
}

/// The corpus of a target, and its lines `target folder extension` in seeds.txt.
std::vector<fs::path> inputs_of(const std::string& target) {
  std::vector<fs::path> files;
  const fs::path corpus = kSource / "tests/fuzz/corpus" / target;
  if (fs::exists(corpus)) add_files(corpus, "", files);
  std::ifstream seeds(kSource / "tests/fuzz/seeds.txt");
  for (std::string line; std::getline(seeds, line);) {
    std::istringstream words(line);
    std::string name, folder, extension;
    if (words >> name >> folder >> extension && name == target) {
      add_files(kSource / folder, extension, files);
    }
  }
  std::ranges::sort(files);
  return files;
}

/// One to four bytes replaced, or a piece cut out or repeated.
Input damaged(Input input, std::mt19937_64& random) {
  const auto below = [&random](size_t end) { return static_cast<size_t>(random() % end); };
  if (input.empty()) return {static_cast<uint8_t>(below(256))};
  if (below(4) == 0) {
    const size_t begin = below(input.size());
    const size_t end = std::min(input.size(), begin + 1 + below(64));
    const Input piece(input.begin() + begin, input.begin() + end);
    if (below(2) == 0) {
      input.erase(input.begin() + begin, input.begin() + end);
    } else {
      input.insert(input.begin() + end, piece.begin(), piece.end());
    }
    return input;
  }
  for (size_t count = 1 + below(4); count > 0; --count) {
    constexpr uint8_t kSpecial[] = {0x00, 0xFF, 0x7F, 0x80, '-', '9', 'e', '\n'};
    const bool special = below(2) == 0;
    input[below(input.size())] =
        special ? kSpecial[below(std::size(kSpecial))] : static_cast<uint8_t>(below(256));
  }
  return input;
}

class FuzzCorpus : public ::testing::TestWithParam<Target> {};

TEST_P(FuzzCorpus, SurvivesStoredInputs) {
  const std::vector<fs::path> files = inputs_of(std::string(GetParam().name));
  ASSERT_GE(files.size(), 2U);
  for (const fs::path& file : files) {
    SCOPED_TRACE(file);
    GetParam().run(read_input(file));
  }
}

TEST_P(FuzzCorpus, SurvivesDamagedInputs) {
  constexpr int kRounds = 20;
  constexpr size_t kLargest = 16'384;
  std::mt19937_64 random(1);
  for (const fs::path& file : inputs_of(std::string(GetParam().name))) {
    const Input input = read_input(file);
    if (input.size() > kLargest) continue;
    for (int i = 0; i < kRounds; ++i) GetParam().run(damaged(input, random));
  }
}

INSTANTIATE_TEST_SUITE_P(Targets, FuzzCorpus, ::testing::ValuesIn(kTargets),
                         [](const auto& target) { return std::string(target.param.name); });

}  // namespace
}  // namespace bevloc::fuzz
