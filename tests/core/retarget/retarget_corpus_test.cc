// The bars of docs/retargeting.md on real clips, none of them part of the
// project: every body of the folder that GELENK_CORPUS names, or of shared/data
// beside the source tree, on the humanoid, on the glTF bodies there and on each
// other.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "gelenk/import/gltf_import.h"
#include "gelenk/import/gltf_reader.h"
#include "gelenk/retarget/humanoid.h"
#include "tests/testing/retarget_runs.h"

namespace gelenk {
namespace {

using testing::BodyClip;
using testing::RetargetRun;
using testing::RetargetWay;
using testing::SourceClip;

struct Corpus {
  std::vector<SourceClip> sources;
  std::vector<std::pair<std::string, std::shared_ptr<const BodyModel>>> targets;
};

// The characters among the glTF files: those that stand on two legs at rest.
void AddGltfBodies(const std::filesystem::path& folder, Corpus& corpus) {
  for (const auto& path : testing::FilesWith(folder, ".glb")) {
    std::ifstream file(path, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(file), {}};
    const auto document = ReadGltf(bytes);
    if (!document.ok()) continue;
    const auto import = ImportGltf(*document);
    if (!import.ok()) continue;
    const auto map = ProposeJointMap(*import->skeleton);
    if (!map.ok() || !map->HasLegs()) continue;
    const auto model = MakeBodyModel(import->skeleton, *map);
    if (!model.ok()) continue;
    corpus.targets.emplace_back(path.stem().string(), *model);
  }
}

Corpus ReadCorpus() {
  Corpus corpus;
  const auto humanoid = MakeHumanoid();
  corpus.targets.emplace_back(
      "humanoid", *MakeBodyModel(humanoid, *ProposeJointMap(*humanoid)));
  const auto folder = testing::CorpusFolder(GELENK_SOURCE_DIR);
  for (const auto& path : testing::FilesWith(folder / "bvh", ".bvh")) {
    absl::StatusOr<BodyClip> clip = testing::ReadBodyClip(path);
    EXPECT_TRUE(clip.ok()) << path << ": " << clip.status();
    // The others test the format.
    if (!clip.ok() || !clip->model->map.HasLegs()) continue;
    corpus.targets.emplace_back(clip->name, clip->model);
    if (clip->frame_count() < kMinContactFrames) continue;
    corpus.sources.push_back(testing::MakeSource(*std::move(clip)));
  }
  AddGltfBodies(folder / "gltf", corpus);
  return corpus;
}

// Sums over pairs of one way.
struct Sums {
  double source_label = 0;
  double label = 0;
  double source_rule = 0;
  double rule = 0;
  double jerk = 0;
  double hand = 0;
  int count = 0;
};

void CheckPair(const SourceClip& source, const BodyModel& target,
               const RetargetRun& run, Sums& sums) {
  EXPECT_LE(run.comparison.label_skate_ratio, 0.4);
  EXPECT_LE(run.quality.penetration.max_m, 1e-3);
  EXPECT_EQ(run.comparison.new_hyper_extended_frames, 0);
  EXPECT_LE(run.limit_excess, 1e-6);
  EXPECT_LE(run.comparison.jerk_ratio, 1.6);
  EXPECT_LE(run.comparison.largest_extra_turn_deg, 25);
  const double scale = target.leg_length / source.clip.model->leg_length;
  sums.source_label += scale * source.quality.skate.label_cm_s;
  sums.label += run.quality.skate.label_cm_s;
  sums.source_rule += scale * source.quality.skate.rule_cm_s;
  sums.rule += run.quality.skate.rule_cm_s;
  sums.jerk += run.comparison.jerk_ratio;
  sums.hand += run.hand_error;
  ++sums.count;
}

void CheckWay(const Corpus& corpus, RetargetWay way) {
  Sums sums;
  for (const SourceClip& source : corpus.sources) {
    for (const auto& [name, target] : corpus.targets) {
      SCOPED_TRACE(source.clip.name + " > " + name);
      const auto run = RunRetarget(source, target, way);
      ASSERT_TRUE(run.ok()) << run.status();
      CheckPair(source, *target, *run, sums);
    }
  }
  EXPECT_LE(sums.label, 0.15 * sums.source_label);
  EXPECT_LE(sums.rule, 0.4 * sums.source_rule);
  EXPECT_LE(sums.jerk, 1.3 * sums.count);
  EXPECT_LE(sums.hand, 0.005 * sums.count);
}

TEST(RetargetCorpusTest, EveryPairHoldsTheBarsOnline) {
  const Corpus corpus = ReadCorpus();
  if (corpus.sources.empty()) GTEST_SKIP() << "SKIPPED: no clips";
  CheckWay(corpus, RetargetWay::kOnline);
}

TEST(RetargetCorpusTest, EveryPairHoldsTheBarsOffline) {
  const Corpus corpus = ReadCorpus();
  if (corpus.sources.empty()) GTEST_SKIP() << "SKIPPED: no clips";
  CheckWay(corpus, RetargetWay::kOffline);
}

}  // namespace
}  // namespace gelenk
