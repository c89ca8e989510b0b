#include "convert/chain.h"

#include <optional>

#include "absl/strings/str_cat.h"
#include "convert/geometry.h"
#include "convert/limits.h"
#include "gelenk/base/violations.h"

namespace gelenk::convert {

absl::StatusOr<PlanarChain> FromProto(const v1::PlanarChain& proto) {
  Violations violations;
  if (proto.base().z() != 0) {
    violations.Add("base.z", absl::StrCat("want 0, got ", proto.base().z()));
  }
  PlanarChain chain;
  chain.link_lengths_m.assign(proto.link_lengths().begin(),
                              proto.link_lengths().end());
  chain.base = {proto.base().x(), proto.base().y()};
  chain.movable_base = proto.movable_base();
  for (const v1::JointLimits& limits : proto.limits()) {
    chain.limits.push_back(FromProto(limits));
  }
  if (!violations.empty()) return violations.ToStatus();
  return chain;
}

absl::StatusOr<DhConvention> FromProto(v1::DhTable::Convention convention) {
  switch (convention) {
    case v1::DhTable::CONVENTION_STANDARD:
      return DhConvention::kStandard;
    case v1::DhTable::CONVENTION_MODIFIED:
      return DhConvention::kModified;
    default:
      break;
  }
  Violations violations;
  violations.Add("convention", absl::StrCat("want standard or modified, got ",
                                            static_cast<int>(convention)));
  return violations.ToStatus();
}

absl::StatusOr<DhTable> FromProto(const v1::DhTable& proto) {
  Violations violations;
  DhTable table;
  const absl::StatusOr<DhConvention> convention = FromProto(proto.convention());
  violations.AddStatus("", convention.status());
  table.convention = convention.value_or(DhConvention::kStandard);
  for (int i = 0; i < proto.rows_size(); ++i) {
    const v1::DhRow& in = proto.rows(i);
    DhRow row;
    row.a_m = in.a_m();
    row.alpha_rad = in.alpha_rad();
    row.d_m = in.d_m();
    row.theta_rad = in.theta_rad();
    row.limits = FromProto(in.limits());
    const std::optional<JointType> type = FromProto(in.type());
    if (type) {
      row.type = *type;
    } else {
      violations.Add(
          absl::StrCat("rows[", i, "].type"),
          absl::StrCat("no such joint type: ", static_cast<int>(in.type())));
    }
    table.rows.push_back(row);
  }
  table.world_from_base = FromProto(proto.world_from_base());
  table.last_from_tool = FromProto(proto.last_from_tool());
  if (!violations.empty()) return violations.ToStatus();
  return table;
}

void ToProto(const DhTable& table, v1::DhTable* proto) {
  proto->set_convention(table.convention == DhConvention::kStandard
                            ? v1::DhTable::CONVENTION_STANDARD
                            : v1::DhTable::CONVENTION_MODIFIED);
  for (const DhRow& row : table.rows) {
    v1::DhRow* out = proto->add_rows();
    out->set_a_m(row.a_m);
    out->set_alpha_rad(row.alpha_rad);
    out->set_d_m(row.d_m);
    out->set_theta_rad(row.theta_rad);
    out->set_type(ToProto(row.type));
    ToProto(row.limits, out->mutable_limits());
  }
  ToProto(table.world_from_base, proto->mutable_world_from_base());
  ToProto(table.last_from_tool, proto->mutable_last_from_tool());
}

}  // namespace gelenk::convert
