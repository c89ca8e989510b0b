// Muscles: how the sections in the middle of a link swell.
//
// A muscle scales the inner planes of its link across, about a pivot that stays
// where it is: a pivot beside the bone makes a bulge on the other side. Several
// muscles of one link act one after the other; preservation of the volume comes
// last and scales every section about its own centre.
#ifndef GELENK_SKIN_MUSCLE_H_
#define GELENK_SKIN_MUSCLE_H_

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

namespace gelenk {

enum class MuscleMode {
  // scale = 1 + gain * (1 - cos(flexion)) / 2, by the flexion of a joint:
  // its turn away from the rest pose.
  kDriven,
  // The scales as given, whatever the pose.
  kExplicit,
  // The scale, the same for s and t, that gives the link the volume it has at
  // rest; within [min_scale, max_scale], else clamped and reported.
  kPreserveVolume,
};

struct Muscle {
  // Unique, 1 to 63 bytes.
  std::string id;
  std::string link_id;
  MuscleMode mode = MuscleMode::kDriven;

  // Of kDriven. The driver is a joint that turns.
  std::string driver_joint_id;
  double gain_s = 0;
  double gain_t = 0;

  // Of kExplicit: plane P2, plane P4. > 0.
  std::array<double, 2> scale_s = {1, 1};
  std::array<double, 2> scale_t = {1, 1};

  // What stays in place, m across the link: s, t. Not for kPreserveVolume.
  Eigen::Vector2d pivot_m = Eigen::Vector2d::Zero();

  // Of kPreserveVolume, which a link has at most once.
  double min_scale = 0.8;
  double max_scale = 1.35;
};

// A mitre: the three planes of a joint grow in the direction of the bend by
// 1 + fullness * (1 / cos(angle / 2) - 1), as a mitred tube keeps its bore.
struct JointFullness {
  // The link whose first plane is that of the joint; not the root's.
  std::string link_id;
  // 0 .. 1.
  double fullness = 0;
};

struct SkinMuscles {
  std::vector<Muscle> muscles;
  std::vector<JointFullness> fullness;
};

// Largest scale and gain taken: a section of ten times the size is no body.
inline constexpr double kMaxMuscleScale = 10;
// Beyond this the mitre stops growing: a bend of 120 degrees.
inline constexpr double kMaxMitre = 2;
// A body has some 600 muscles; far fewer are shaped one by one.
inline constexpr int kMaxMuscles = 4096;

}  // namespace gelenk

#endif  // GELENK_SKIN_MUSCLE_H_
