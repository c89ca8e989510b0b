// Newton's method in one dimension as a picture: the function, and the tangents
// on which the iterates slide down.
#ifndef CLIENT_CLI_PICTURE_TANGENT_PICTURE_H_
#define CLIENT_CLI_PICTURE_TANGENT_PICTURE_H_

#include <string>

#include "gelenk/ik/newton_1d.h"

namespace gelenk::cli {

// SVG. Shows `function` between `lower` and `upper`, lower < upper.
std::string TangentPicture(const ScalarFunction& function,
                           const Newton1dResult& result, double lower,
                           double upper);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_PICTURE_TANGENT_PICTURE_H_
