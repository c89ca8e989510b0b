// For calls whose work grows with what they are given.
#ifndef CLIENT_CLI_PATIENT_CALL_H_
#define CLIENT_CLI_PATIENT_CALL_H_

#include "gelenk/client/connection.h"

namespace gelenk::cli {

// Binding a large mesh, or retargeting a long clip, takes a while.
inline client::CallOptions PatientCall() {
  client::CallOptions options;
  options.timeout = absl::Minutes(5);
  return options;
}

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_PATIENT_CALL_H_
