// Bodies with the joint names of well-known rigs.
#ifndef GELENK_TESTS_TESTING_RIG_FAMILY_H_
#define GELENK_TESTS_TESTING_RIG_FAMILY_H_

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "gelenk/skeleton/skeleton.h"

namespace gelenk::testing {

// The names of one family. Those of the left side; `right` names the right one
// in the same order.
struct RigFamily {
  std::string family;
  std::string pelvis;
  std::vector<std::string> spine;  // the last one is the chest
  std::vector<std::string> neck;
  std::string head;
  // clavicle (may be empty), upper arm, forearm, hand, thigh, shin, foot, toe
  std::array<std::string, 8> left;
  std::array<std::string, 8> right;
};

// Mixamo, CMU, HumanIK, VRM, Unity, Rokoko, Xsens, OptiTrack, Biped, SMPL,
// Rigify, Unreal, and one that says nothing.
const std::vector<RigFamily>& RigFamilies();

// A T-pose of an adult, free pelvis, other joints spherical; end effectors at
// the toes' and hands' tips.
std::shared_ptr<const Skeleton> BodyOf(const RigFamily& family);

}  // namespace gelenk::testing

#endif  // GELENK_TESTS_TESTING_RIG_FAMILY_H_
