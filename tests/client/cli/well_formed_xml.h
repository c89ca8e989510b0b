// Checks the form of small XML texts: enough for what the CLI draws.
#ifndef GELENK_TESTS_CLIENT_CLI_WELL_FORMED_XML_H_
#define GELENK_TESTS_CLIENT_CLI_WELL_FORMED_XML_H_

#include <map>
#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace gelenk::cli {

// How often each element occurs, by `name` and by `name.class` for each of its
// classes. INVALID_ARGUMENT when elements are not closed in order, attributes
// are not quoted or repeated, or a bare & or < stands in text. No declarations,
// comments or CDATA.
absl::StatusOr<std::map<std::string, int>> CountElements(absl::string_view xml);

}  // namespace gelenk::cli

#endif  // GELENK_TESTS_CLIENT_CLI_WELL_FORMED_XML_H_
