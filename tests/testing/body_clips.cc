#include "tests/testing/body_clips.h"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <utility>

#include "gelenk/formats/bvh_motion.h"
#include "gelenk/formats/bvh_reader.h"
#include "gelenk/motion/first_frame.h"

namespace gelenk::testing {

namespace fs = std::filesystem;

absl::StatusOr<BodyClip> BodyClipFromBvh(absl::string_view text,
                                         std::string name) {
  absl::StatusOr<BvhDocument> document = ReadBvh(text);
  if (!document.ok()) return document.status();
  absl::StatusOr<BvhImport> import = ImportBvh(*document);
  if (!import.ok()) return import.status();
  absl::StatusOr<Eigen::MatrixXd> poses = PosesFromBvh(*document, *import);
  if (!poses.ok()) return poses.status();
  const int first =
      FindFirstFrameJump(*import->skeleton, *poses).has_value() ? 1 : 0;
  const ClipView view = {*poses, document->frame_time_s, first};
  absl::StatusOr<JointMap> map = ProposeJointMap(*import->skeleton, {}, &view);
  if (!map.ok()) return map.status();
  absl::StatusOr<std::shared_ptr<const BodyModel>> model =
      MakeBodyModel(import->skeleton, *map, &view);
  if (!model.ok()) return model.status();
  BodyClip clip;
  clip.name = std::move(name);
  clip.model = *std::move(model);
  clip.positions = poses->rightCols(poses->cols() - first);
  clip.frame_time_s = document->frame_time_s;
  return clip;
}

std::string FileText(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

absl::StatusOr<BodyClip> ReadBodyClip(const fs::path& bvh) {
  return BodyClipFromBvh(FileText(bvh), bvh.stem().string());
}

std::vector<BodyPose> BodyPosesOf(const BodyModel& model,
                                  const Eigen::MatrixXd& positions) {
  std::vector<BodyPose> poses(positions.cols());
  WorldTransforms world_from_joints;
  for (int f = 0; f < positions.cols(); ++f) {
    ForwardKinematics(*model.skeleton, positions.col(f), world_from_joints);
    ReadBodyPose(model, world_from_joints, poses[f]);
  }
  return poses;
}

fs::path CorpusFolder(const fs::path& source_dir) {
  const char* named = std::getenv("GELENK_CORPUS");
  return named != nullptr ? fs::path(named)
                          : source_dir.parent_path() / "shared" / "data";
}

std::vector<fs::path> FilesWith(const fs::path& folder,
                                absl::string_view extension) {
  std::vector<fs::path> files;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(folder, none)) {
    if (entry.path().extension() == fs::path(std::string(extension))) {
      files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace gelenk::testing
