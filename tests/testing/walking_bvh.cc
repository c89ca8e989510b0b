#include "tests/testing/walking_bvh.h"

#include <cmath>
#include <numbers>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"

namespace gelenk::testing {
namespace {

constexpr double kFrameTimeS = 0.02;
constexpr double kStepsPerSecond = 1.0;

// A joint, what hangs from it, and its end site where that is nothing.
struct Limb {
  std::string name;
  std::string offset;
  std::vector<Limb> children;
  std::string end_offset;
};

std::vector<Limb> Leg(const std::string& side, double x) {
  const Limb toes = {side + "Toes", "0 -6 12", {}, "0 0 6"};
  const Limb foot = {side + "Foot", "0 -42 0", {toes}, ""};
  const Limb shin = {side + "Leg", "0 -43 0", {foot}, ""};
  return {{side + "UpLeg", absl::StrCat(x, " -2 0"), {shin}, ""}};
}

std::vector<Limb> Arm(const std::string& side, double sign) {
  const auto along = [sign](double length) {
    return absl::StrCat(sign * length, " 0 0");
  };
  const Limb hand = {side + "Hand", along(25), {}, along(15)};
  const Limb forearm = {side + "ForeArm", along(28), {hand}, ""};
  return {{side + "Arm", absl::StrCat(sign * 18, " 14 0"), {forearm}, ""}};
}

std::vector<Limb> Concatenated(const std::vector<std::vector<Limb>>& lists) {
  std::vector<Limb> all;
  for (const auto& list : lists)
    all.insert(all.end(), list.begin(), list.end());
  return all;
}

void Append(const Limb& limb, const std::string& keyword, std::string& text) {
  absl::StrAppend(&text, keyword, " ", limb.name, "\n{\nOFFSET ", limb.offset,
                  "\nCHANNELS ");
  absl::StrAppend(
      &text, keyword == "ROOT" ? "6 Xposition Yposition Zposition " : "3 ");
  absl::StrAppend(&text, "Zrotation Xrotation Yrotation\n");
  for (const Limb& child : limb.children) Append(child, "JOINT", text);
  if (!limb.end_offset.empty()) {
    absl::StrAppend(&text, "End Site\n{\nOFFSET ", limb.end_offset, "\n}\n");
  }
  absl::StrAppend(&text, "}\n");
}

// Degrees about Z, X, Y at a phase of the walk, in the order of Body().
std::vector<double> Angles(double phase) {
  const double swing = std::sin(phase);
  const double left_knee = 20 + 18 * std::sin(phase + 1.2);
  const double right_knee = 20 - 18 * std::sin(phase + 1.2);
  const std::vector<std::vector<double>> joints = {
      {0, 4, 3 * swing},  // Hips
      {1, -25 * swing, 0},
      {0, left_knee, 0},  // left leg
      {0, -8, 0},
      {0, 3, 0},  //
      {-1, 25 * swing, 0},
      {0, right_knee, 0},  // right leg
      {0, -8, 0},
      {0, 3, 0},           //
      {0, 3, -4 * swing},  // Spine
      {-72, 0, 22 * swing},
      {0, 0, -25 - 8 * swing},  // left arm
      {5, 6, 0},                //
      {72, 0, 22 * swing},
      {0, 0, 25 - 8 * swing},  // right arm
      {-5, 6, 0},              //
      {0, -3, 5 * swing}};     // Head
  std::vector<double> angles;
  for (const auto& joint : joints) {
    angles.insert(angles.end(), joint.begin(), joint.end());
  }
  return angles;
}

Limb Body() {
  const Limb head = {"Head", "0 22 0", {}, "0 18 0"};
  const Limb spine = {"Spine", "0 30 0",
                      Concatenated({Arm("Left", 1), Arm("Right", -1), {head}}),
                      ""};
  return {"Hips", "0 0 0",
          Concatenated({Leg("Left", 9), Leg("Right", -9), {spine}}), ""};
}

}  // namespace

namespace {

std::string RowAt(double time_s) {
  const double phase = 2 * std::numbers::pi * kStepsPerSecond * time_s;
  return absl::StrCat(2 * std::sin(phase), " ", 92 + 1.5 * std::cos(2 * phase),
                      " ", 110 * time_s, " ", absl::StrJoin(Angles(phase), " "),
                      "\n");
}

std::string TextWith(const std::vector<std::string>& rows) {
  std::string text = "HIERARCHY\n";
  Append(Body(), "ROOT", text);
  absl::StrAppend(&text, "MOTION\nFrames: ", rows.size(),
                  "\nFrame Time: ", kFrameTimeS, "\n", absl::StrJoin(rows, ""));
  return text;
}

std::vector<std::string> Rows(int frame_count) {
  std::vector<std::string> rows;
  for (int i = 0; i < frame_count; ++i) rows.push_back(RowAt(i * kFrameTimeS));
  return rows;
}

}  // namespace

std::string WalkingBvh(int frame_count) { return TextWith(Rows(frame_count)); }

std::string WalkingBvhBehindATPose(int frame_count) {
  std::vector<std::string> rows = Rows(frame_count);
  const std::vector<double> still(3 * kWalkingJointCount, 0);
  rows.insert(rows.begin(),
              absl::StrCat("0 93.5 0 ", absl::StrJoin(still, " "), "\n"));
  return TextWith(rows);
}

}  // namespace gelenk::testing
