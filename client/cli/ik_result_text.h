// The answer to one inverse kinematics request.
#ifndef CLIENT_CLI_IK_RESULT_TEXT_H_
#define CLIENT_CLI_IK_RESULT_TEXT_H_

#include <string>

#include "client/cli/text/format.h"
#include "gelenk/skeleton/skeleton.h"
#include "gelenk/v1/kinematics_service.pb.h"

namespace gelenk::cli {

std::string IkResultText(const Skeleton& skeleton,
                         const v1::SolveInverseKinematicsRequest& request,
                         const v1::SolveInverseKinematicsResponse& response);

// Keys stay; numbers in m, rad, s.
Json IkResultJson(const Skeleton& skeleton,
                  const v1::SolveInverseKinematicsRequest& request,
                  const v1::SolveInverseKinematicsResponse& response);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_IK_RESULT_TEXT_H_
