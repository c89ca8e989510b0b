// What all uploads ask of their pieces.
#ifndef GELENK_SERVER_RPC_PIECE_CHECK_H_
#define GELENK_SERVER_RPC_PIECE_CHECK_H_

#include <cstdint>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "gelenk/base/violations.h"

namespace gelenk::server {

inline absl::Status MalformedPiece(absl::string_view field,
                                   absl::string_view description) {
  Violations violations;
  violations.Add(field, description);
  return violations.ToStatus();
}

// A header comes first and never again.
inline absl::Status CheckHeaderComesFirst(bool has_header, bool is_first) {
  if (has_header == is_first) return absl::OkStatus();
  return MalformedPiece("header",
                        "the first message must hold it, and no other");
}

inline absl::Status CheckUploadSize(absl::string_view field, int64_t bytes,
                                    int64_t most) {
  if (bytes <= most) return absl::OkStatus();
  return MalformedPiece(field, absl::StrCat("want at most ", most, " bytes"));
}

}  // namespace gelenk::server

#endif  // GELENK_SERVER_RPC_PIECE_CHECK_H_
