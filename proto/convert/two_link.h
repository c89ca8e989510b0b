// Two links and two bones between the contract and the core.
#ifndef GELENK_CONVERT_TWO_LINK_H_
#define GELENK_CONVERT_TWO_LINK_H_

#include "absl/status/statusor.h"
#include "gelenk/ik/two_bone.h"
#include "gelenk/ik/two_link.h"
#include "gelenk/v1/two_link.pb.h"

namespace gelenk::convert {

// INVALID_ARGUMENT naming every bad field; what comes out has passed
// CheckTwoLink and CheckTwoBone.
absl::StatusOr<TwoLinkProblem> FromProto(const v1::PlanarTwoLink& proto);
absl::StatusOr<TwoBoneProblem> FromProto(const v1::TwoBoneLimb& proto);

void ToProto(const TwoLinkAnswer& answer, v1::SolveTwoLinkResponse* proto);
void ToProto(const TwoBoneAnswer& answer, v1::SolveTwoLinkResponse* proto);

}  // namespace gelenk::convert

#endif  // GELENK_CONVERT_TWO_LINK_H_
