// What a binding decided, for people and for programs.
#ifndef CLIENT_CLI_SKIN_BINDING_TEXT_H_
#define CLIENT_CLI_SKIN_BINDING_TEXT_H_

#include <string>

#include "client/cli/text/format.h"
#include "gelenk/v1/skin.pb.h"
#include "gelenk/v1/skin_service.pb.h"

namespace gelenk::cli {

// What it is; of a mesh in volumes also `binding`: classes link by link,
// stretched edges, and, of a report in detail, vertices.
std::string BindingText(const v1::Skin& skin, const v1::Binding& binding);
Json BindingJson(const v1::Skin& skin, const v1::Binding& binding);

// What a decision changed, or would.
std::string RebindText(const v1::RebindVerticesResponse& response,
                       bool dry_run);

// "3 vertices: 0-1, 7"; long lists end with "...".
std::string RunsText(const v1::VertexRuns& runs);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_SKIN_BINDING_TEXT_H_
