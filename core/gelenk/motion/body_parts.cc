#include "gelenk/motion/body_parts.h"

#include <vector>

#include "gelenk/motion/body_part_name.h"
#include "gelenk/motion/body_shape.h"

namespace gelenk {
namespace {

// Joints in the root of the tree first, so that the wrist comes before a hand
// below it.
std::vector<int> DepthsOf(const Skeleton& skeleton) {
  std::vector<int> depths(skeleton.joint_count(), 0);
  for (int i = 0; i < skeleton.joint_count(); ++i) {
    const int parent = skeleton.span(i).parent;
    if (parent >= 0) depths[i] = depths[parent] + 1;
  }
  return depths;
}

// Of several joints of a name's kind the one nearest to the root: the wrist
// above the hand, the ankle above the foot's ball.
BodyParts FindByNames(const Skeleton& skeleton) {
  BodyParts parts;
  int root = -1;
  const std::vector<int> depths = DepthsOf(skeleton);
  for (int i = 0; i < skeleton.joint_count(); ++i) {
    const BodyPartName name = ReadBodyPartName(skeleton.joint(i).id);
    const bool left = name.side == BodySide::kLeft;
    int* slot = nullptr;
    switch (name.part) {
      case BodyPart::kHips:
        slot = &parts.hips;
        break;
      case BodyPart::kRoot:
        slot = &root;
        break;
      case BodyPart::kHand:
        slot = left ? &parts.left_hand : &parts.right_hand;
        break;
      case BodyPart::kFoot:
        slot = left ? &parts.left_foot : &parts.right_foot;
        break;
      case BodyPart::kHead:
        slot = &parts.head;
        break;
      case BodyPart::kOther:
        continue;
    }
    if (*slot < 0 || depths[i] < depths[*slot]) *slot = i;
  }
  if (parts.hips < 0) parts.hips = root;
  return parts;
}

}  // namespace

absl::string_view EvidenceName(BodyParts::Evidence evidence) {
  switch (evidence) {
    case BodyParts::Evidence::kNone:
      return "nothing";
    case BodyParts::Evidence::kNames:
      return "names";
    case BodyParts::Evidence::kShape:
      return "shape";
    case BodyParts::Evidence::kNamesAndShape:
      return "names and shape";
  }
  return "unknown";
}

BodyParts FindBodyParts(const Skeleton& skeleton) {
  BodyParts parts = FindByNames(skeleton);
  parts.evidence = BodyParts::Evidence::kNames;
  if (!parts.HasLimbs()) {
    const BodyParts shape = FindBodyPartsByShape(skeleton);
    if (!shape.HasLimbs()) {
      const bool any = parts.head >= 0 || parts.left_hand >= 0 ||
                       parts.right_hand >= 0 || parts.left_foot >= 0 ||
                       parts.right_foot >= 0;
      if (!any) parts.evidence = BodyParts::Evidence::kNone;
      return parts;
    }
    const int named_head = parts.head;
    parts = shape;
    if (named_head >= 0) {
      parts.head = named_head;
      parts.evidence = BodyParts::Evidence::kNamesAndShape;
    }
    return parts;
  }
  if (parts.hips < 0) {
    parts.hips = CommonAncestor(skeleton, parts.left_foot, parts.right_foot);
    parts.evidence = BodyParts::Evidence::kNamesAndShape;
  }
  if (parts.head < 0) {
    parts.head = FindHeadByShape(skeleton, parts.left_hand, parts.right_hand);
    parts.evidence = BodyParts::Evidence::kNamesAndShape;
  }
  return parts;
}

}  // namespace gelenk
