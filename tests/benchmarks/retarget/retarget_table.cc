// Every clip on the humanoid, on bodies of glTF and URDF files and on the other
// clips' skeletons, beside plain rotation copy, as the table of
// docs/retargeting.md.
//
//   retarget_table [--pairs | --time] [--onto FILE]... CLIP.bvh...
//
// A row is the mean over the targets of a clip; with --pairs there is one for
// each. --time measures warm online frames instead.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "gelenk/import/gltf_import.h"
#include "gelenk/import/gltf_reader.h"
#include "gelenk/import/urdf_import.h"
#include "gelenk/import/urdf_reader.h"
#include "gelenk/retarget/floating_base.h"
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

absl::StatusOr<std::shared_ptr<const Skeleton>> ReadSkeleton(
    const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  if (std::filesystem::path(path).extension() == ".urdf") {
    absl::StatusOr<UrdfDocument> document = ReadUrdf(bytes);
    if (!document.ok()) return document.status();
    absl::StatusOr<UrdfImport> import = ImportUrdf(*document);
    if (!import.ok()) return import.status();
    return WithFloatingBase(import->skeleton);
  }
  absl::StatusOr<GltfDocument> document = ReadGltf(bytes);
  if (!document.ok()) return document.status();
  absl::StatusOr<GltfImport> import = ImportGltf(*document);
  if (!import.ok()) return import.status();
  return import->skeleton;
}

absl::StatusOr<Target> FileTarget(const std::string& path) {
  absl::StatusOr<std::shared_ptr<const Skeleton>> skeleton = ReadSkeleton(path);
  if (!skeleton.ok()) return skeleton.status();
  absl::StatusOr<JointMap> map = ProposeJointMap(**skeleton);
  if (!map.ok()) return map.status();
  absl::StatusOr<std::shared_ptr<const BodyModel>> model =
      MakeBodyModel(*skeleton, *map);
  if (!model.ok()) return model.status();
  return Target{std::filesystem::path(path).stem().string(), *model};
}

// What a row shows, by way.
struct Row {
  double contact = 0;
  double source_label = 0;
  double source_rule = 0;
  std::array<double, 3> label = {};
  std::array<double, 3> rule = {};
  std::array<double, 3> penetration_mm = {};
  std::array<double, 3> hand_percent = {};
  std::array<double, 3> jerk = {};
  std::array<double, 3> extra_turn_deg = {};
  std::array<double, 3> hyper = {};

  // Every number of a row.
  std::vector<double*> Numbers() {
    std::vector<double*> numbers = {&contact, &source_label, &source_rule};
    for (auto* values : {&label, &rule, &penetration_mm, &hand_percent, &jerk,
                         &extra_turn_deg, &hyper}) {
      for (double& value : *values) numbers.push_back(&value);
    }
    return numbers;
  }
};

// Sums of rows.
class Mean {
 public:
  void Add(Row row) {
    const std::vector<double*> from = row.Numbers();
    const std::vector<double*> to = sum_.Numbers();
    for (size_t i = 0; i < to.size(); ++i) *to[i] += *from[i];
    ++count_;
  }
  Row Value() const {
    Row mean = sum_;
    for (double* number : mean.Numbers()) *number /= std::max(1, count_);
    return mean;
  }
  int count() const { return count_; }

 private:
  Row sum_;
  int count_ = 0;
};

void PrintHead() {
  std::printf(
      "| clip | contact %% | label skate, cm/s: source / copy / online / "
      "offline | rule skate | penetration, mm: copy / online / offline | hand "
      "error, %% of arm: online / offline | jerk ratio: copy / online / "
      "offline "
      "| extra turn, degrees a frame | new hyper-extensions |\n"
      "|---|---|---|---|---|---|---|---|---|\n");
}

void Print(const std::string& name, const Row& r) {
  std::printf(
      "| %s | %.0f | %.2f / %.2f / %.2f / %.2f | %.2f / %.2f / %.2f / %.2f | "
      "%.1f / %.2f / %.2f | %.2f / %.2f | %.2f / %.2f / %.2f | "
      "%.1f / %.1f / %.1f | %.0f / %.0f |\n",
      name.c_str(), 100 * r.contact, r.source_label, r.label[0], r.label[1],
      r.label[2], r.source_rule, r.rule[0], r.rule[1], r.rule[2],
      r.penetration_mm[0], r.penetration_mm[1], r.penetration_mm[2],
      r.hand_percent[1], r.hand_percent[2], r.jerk[0], r.jerk[1], r.jerk[2],
      r.extra_turn_deg[0], r.extra_turn_deg[1], r.extra_turn_deg[2], r.hyper[1],
      r.hyper[2]);
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
      std::fprintf(stderr, "%s > %s: %s\n", source.clip.name.c_str(),
                   target.name.c_str(), run.status().ToString().c_str());
      continue;
    }
    row.label[k] = run->quality.skate.label_cm_s;
    row.rule[k] = run->quality.skate.rule_cm_s;
    row.penetration_mm[k] = 1000 * run->quality.penetration.max_m;
    row.hand_percent[k] = 100 * run->hand_error;
    row.jerk[k] = run->comparison.jerk_ratio;
    row.extra_turn_deg[k] = run->comparison.largest_extra_turn_deg;
    row.hyper[k] = run->comparison.new_hyper_extended_frames;
  }
  return row;
}

// The time of a warm online frame, contacts included; the best of some rounds.
void PrintTime(const SourceClip& source, const Target& target) {
  auto retargeter = Retargeter::Create(source.clip.model, target.model);
  double best_us = 1e9;
  for (int round = 0; round < 20; ++round) {
    const auto start = std::chrono::steady_clock::now();
    for (int f = 0; f < source.clip.frame_count(); ++f) {
      (void)(*retargeter)
          ->Retarget(source.clip.positions.col(f), source.clip.frame_time_s);
    }
    const std::chrono::duration<double, std::micro> time =
        std::chrono::steady_clock::now() - start;
    best_us = std::min(best_us, time.count() / source.clip.frame_count());
  }
  std::printf("%s (%d joints) > %s (%d joints): %.1f us a frame\n",
              source.clip.name.c_str(),
              source.clip.model->skeleton->joint_count(), target.name.c_str(),
              target.model->skeleton->joint_count(), best_us);
}

int Main(int argc, char** argv) {
  bool pairs = false;
  bool time = false;
  std::vector<Target> targets = {HumanoidTarget()};
  std::vector<SourceClip> sources;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--pairs" || argument == "--time") {
      (argument == "--time" ? time : pairs) = true;
      continue;
    }
    if (argument == "--onto" && i + 1 < argc) {
      absl::StatusOr<Target> target = FileTarget(argv[++i]);
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
  if (time) {
    for (const SourceClip& source : sources) {
      PrintTime(source, targets.front());
      for (const Target& target : targets) {
        if (target.name == source.clip.name) PrintTime(source, target);
      }
    }
    return 0;
  }
  PrintHead();
  Mean all;
  for (const SourceClip& source : sources) {
    Mean of_clip;
    for (const Target& target : targets) {
      const Row row = RowOf(source, target);
      if (pairs) Print(source.clip.name + " > " + target.name, row);
      of_clip.Add(row);
      all.Add(row);
    }
    if (!pairs) Print(source.clip.name, of_clip.Value());
  }
  Print("**mean of " + std::to_string(all.count()) + " pairs**", all.Value());
  return 0;
}

}  // namespace
}  // namespace gelenk::testing

int main(int argc, char** argv) { return gelenk::testing::Main(argc, argv); }
