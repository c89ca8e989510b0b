// retarget_table CLIP.bvh... : every clip on the humanoid, on the glTF bodies
// of the same corpus and on the other clips' skeletons, as a table for docs.
//
//   retarget_table [--pairs] [--gltf FILE.glb]... CLIP.bvh...
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "gelenk/import/gltf_import.h"
#include "gelenk/import/gltf_reader.h"
#include "gelenk/retarget/humanoid.h"
#include "tests/testing/retarget_runs.h"

namespace gelenk::testing {
namespace {

struct Target {
  std::string name;
  std::shared_ptr<const BodyModel> model;
};

Target HumanoidTarget() {
  const std::shared_ptr<const Skeleton> skeleton = MakeHumanoid();
  return {"humanoid", *MakeBodyModel(skeleton, *ProposeJointMap(*skeleton))};
}

absl::StatusOr<Target> GltfTarget(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  absl::StatusOr<GltfDocument> document = ReadGltf(bytes);
  if (!document.ok()) return document.status();
  absl::StatusOr<GltfImport> import = ImportGltf(*document);
  if (!import.ok()) return import.status();
  absl::StatusOr<JointMap> map = ProposeJointMap(*import->skeleton);
  if (!map.ok()) return map.status();
  absl::StatusOr<std::shared_ptr<const BodyModel>> model =
      MakeBodyModel(import->skeleton, *map);
  if (!model.ok()) return model.status();
  return Target{std::filesystem::path(path).stem().string(), *model};
}

// What a row shows, by way.
struct Row {
  double contact = 0;
  double source_label = 0;
  double source_rule = 0;
  std::array<double, 3> label = {};
  std::array<double, 3> turning = {};
  std::array<double, 3> rule = {};
  std::array<double, 3> penetration_mm = {};
  std::array<double, 3> hand = {};
  std::array<double, 3> jerk = {};
  std::array<double, 3> extra_turn = {};
  std::array<double, 3> hyper = {};
  std::array<double, 3> limit = {};
  std::array<double, 3> limited = {};
};

void Print(const std::string& name, const Row& r) {
  std::printf(
      "| %s | %.0f | %.2f / %.2f / %.2f / %.2f | %.2f / %.2f / %.2f / %.2f | "
      "%.1f / %.2f / %.2f | %.2f / %.2f | %.2f / %.2f / %.2f | "
      "%.1f / %.1f / %.1f | %.0f / %.0f | %.4f %.0f | turn %.2f\n",
      name.c_str(), 100 * r.contact, r.source_label, r.label[0], r.label[1],
      r.label[2], r.source_rule, r.rule[0], r.rule[1], r.rule[2],
      r.penetration_mm[0], r.penetration_mm[1], r.penetration_mm[2],
      100 * r.hand[1], 100 * r.hand[2], r.jerk[0], r.jerk[1], r.jerk[2],
      r.extra_turn[0], r.extra_turn[1], r.extra_turn[2], r.hyper[1], r.hyper[2],
      r.limit[1], 100 * r.limited[1], r.turning[1]);
}

Row RowOf(const SourceClip& source, const Target& target) {
  Row row;
  const double scale = target.model->leg_length / source.clip.model->leg_length;
  row.contact = source.labels.ContactRatio();
  row.source_label = source.quality.skate.label_cm_s * scale;
  row.source_rule = source.quality.skate.rule_cm_s * scale;
  for (RetargetWay way : kRetargetWays) {
    const int k = static_cast<int>(way);
    const absl::StatusOr<RetargetRun> run =
        RunRetarget(source, target.model, way);
    if (!run.ok()) {
      std::printf("%s\n", run.status().ToString().c_str());
      continue;
    }
    row.label[k] = run->quality.skate.label_cm_s;
    row.turning[k] = run->quality.skate.label_with_turning_cm_s;
    row.rule[k] = run->quality.skate.rule_cm_s;
    row.penetration_mm[k] = 1000 * run->quality.penetration.max_m;
    row.hand[k] = run->hand_error;
    row.jerk[k] = run->comparison.jerk_ratio;
    row.extra_turn[k] = run->comparison.largest_extra_turn_deg;
    row.hyper[k] = run->comparison.new_hyper_extended_frames;
    row.limit[k] = run->limit_excess;
    row.limited[k] = run->limited_part;
  }
  return row;
}

int Main(int argc, char** argv) {
  bool pairs = false;
  std::vector<Target> targets = {HumanoidTarget()};
  std::vector<SourceClip> sources;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--pairs") {
      pairs = true;
      continue;
    }
    if (argument == "--gltf" && i + 1 < argc) {
      absl::StatusOr<Target> target = GltfTarget(argv[++i]);
      if (!target.ok()) {
        std::fprintf(stderr, "%s: %s\n", argv[i],
                     target.status().ToString().c_str());
        return 1;
      }
      targets.push_back(*std::move(target));
      continue;
    }
    absl::StatusOr<BodyClip> clip = ReadBodyClip(argument);
    if (!clip.ok() || !clip->model->map.HasLegs()) {
      std::fprintf(stderr, "%s: no body: %s\n", argv[i],
                   clip.status().ToString().c_str());
      continue;
    }
    targets.push_back({clip->name, clip->model});
    if (clip->frame_count() >= kMinContactFrames) {
      sources.push_back(MakeSource(*std::move(clip)));
    }
  }
  Row mean;
  int count = 0;
  double worst_label = 0;
  double worst_jerk = 0;
  double worst_turn = 0;
  double worst_penetration = 0;
  double label_ratio = 0;
  for (const SourceClip& source : sources) {
    for (const Target& target : targets) {
      const Row row = RowOf(source, target);
      if (pairs) Print(source.clip.name + " > " + target.name, row);
      mean.contact += row.contact;
      mean.source_label += row.source_label;
      mean.source_rule += row.source_rule;
      for (int k = 0; k < 3; ++k) {
        mean.label[k] += row.label[k];
        mean.turning[k] += row.turning[k];
        mean.rule[k] += row.rule[k];
        mean.penetration_mm[k] += row.penetration_mm[k];
        mean.hand[k] += row.hand[k];
        mean.jerk[k] += row.jerk[k];
        mean.extra_turn[k] += row.extra_turn[k];
        mean.hyper[k] += row.hyper[k];
        mean.limited[k] += row.limited[k];
      }
      worst_label =
          std::max(worst_label, row.label[1] / std::max(row.source_label, .01));
      label_ratio += row.label[1] / std::max(row.source_label, .01);
      worst_jerk = std::max(worst_jerk, row.jerk[1]);
      worst_turn = std::max(worst_turn, row.extra_turn[1]);
      worst_penetration = std::max(worst_penetration, row.penetration_mm[1]);
      ++count;
    }
  }
  for (double* value : {&mean.contact, &mean.source_label, &mean.source_rule}) {
    *value /= count;
  }
  for (int k = 0; k < 3; ++k) {
    for (auto* values : {&mean.label, &mean.turning, &mean.rule,
                         &mean.penetration_mm, &mean.hand, &mean.jerk,
                         &mean.extra_turn, &mean.hyper, &mean.limited}) {
      (*values)[k] /= count;
    }
  }
  Print("mean", mean);
  std::printf(
      "%d pairs; online: label ratio mean %.3f (of means %.3f) worst %.3f, "
      "rule "
      "of means %.3f, jerk worst %.2f, extra turn worst %.1f, penetration "
      "worst "
      "%.3f mm\n",
      count, label_ratio / count, mean.label[1] / mean.source_label,
      worst_label, mean.rule[1] / mean.source_rule, worst_jerk, worst_turn,
      worst_penetration);
  return 0;
}

}  // namespace
}  // namespace gelenk::testing

int main(int argc, char** argv) { return gelenk::testing::Main(argc, argv); }
