// Planar chains and Denavit-Hartenberg tables between the contract and the
// core.
#ifndef GELENK_CONVERT_CHAIN_H_
#define GELENK_CONVERT_CHAIN_H_

#include "absl/status/statusor.h"
#include "gelenk/kinematics/dh_table.h"
#include "gelenk/skeleton/planar_chain.h"
#include "gelenk/v1/chain.pb.h"

namespace gelenk::convert {

// INVALID_ARGUMENT where the base is not in the plane; BuilderOf checks the
// rest.
absl::StatusOr<PlanarChain> FromProto(const v1::PlanarChain& proto);

// INVALID_ARGUMENT naming an unset convention and rows without a type.
absl::StatusOr<DhTable> FromProto(const v1::DhTable& proto);
void ToProto(const DhTable& table, v1::DhTable* proto);

// INVALID_ARGUMENT naming "convention" when it is unset.
absl::StatusOr<DhConvention> FromProto(v1::DhTable::Convention convention);

}  // namespace gelenk::convert

#endif  // GELENK_CONVERT_CHAIN_H_
