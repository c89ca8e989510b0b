// The closed-form solutions of two links in the plane, drawn.
#ifndef CLIENT_CLI_PICTURE_TWO_LINK_PICTURE_H_
#define CLIENT_CLI_PICTURE_TWO_LINK_PICTURE_H_

#include <string>

#include "gelenk/v1/two_link.pb.h"

namespace gelenk::cli {

// The reach as a ring, the target, and both solutions: the best in full, the
// other pale.
std::string TwoLinkPictureSvg(const v1::PlanarTwoLink& limb,
                              const v1::SolveTwoLinkResponse& response);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_PICTURE_TWO_LINK_PICTURE_H_
