#include "client/cli/ik_result_text.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>

#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/strip.h"
#include "client/cli/joint_frames_text.h"
#include "client/cli/text/table.h"

namespace gelenk::cli {
namespace {

// OUTCOME_STALLED_AT_LIMITS as "stalled_at_limits".
std::string OutcomeName(v1::SolveReport::Outcome outcome) {
  const std::string& name = v1::SolveReport::Outcome_Name(outcome);
  return absl::AsciiStrToLower(absl::StripPrefix(name, "OUTCOME_"));
}

// The member of Goal.kind that is set; null for none.
const google::protobuf::FieldDescriptor* KindFieldOf(const v1::Goal& goal) {
  return v1::Goal::descriptor()->FindFieldByNumber(goal.kind_case());
}

std::string KindOf(const v1::Goal& goal) {
  const auto* field = KindFieldOf(goal);
  return field == nullptr ? "" : field->name();
}

// What the goal is about; goals of the whole body go by their own id.
std::string EffectorOf(const v1::Goal& goal) {
  const auto* field = KindFieldOf(goal);
  if (field == nullptr) return goal.goal_id();
  const google::protobuf::Message& kind =
      goal.GetReflection()->GetMessage(goal, field);
  const auto* effector =
      kind.GetDescriptor()->FindFieldByName("end_effector_id");
  if (effector == nullptr) return goal.goal_id();
  return kind.GetReflection()->GetString(kind, effector);
}

std::vector<std::string> LimitedJoints(const Skeleton& skeleton,
                                       const v1::SolveReport& report) {
  std::vector<std::string> ids;
  for (int joint : report.limited_joints()) {
    if (joint >= 0 && joint < skeleton.joint_count()) {
      ids.push_back(skeleton.joint(joint).id);
    }
  }
  return ids;
}

double SolveSeconds(const v1::SolveReport& report) {
  return static_cast<double>(report.solve_duration().seconds()) +
         1e-9 * report.solve_duration().nanos();
}

// The error of goal `i`; 0 where the report has none.
double ErrorAt(const google::protobuf::RepeatedField<float>& errors, int i) {
  return i < errors.size() ? errors.Get(i) : 0;
}

std::string FactsText(const Skeleton& skeleton,
                      const v1::SolveInverseKinematicsRequest& request,
                      const v1::SolveReport& report) {
  Facts facts;
  facts.Add("outcome",
            absl::StrReplaceAll(OutcomeName(report.outcome()), {{"_", " "}}));
  facts.Add("iterations", absl::StrCat(report.iteration_count()));
  facts.Add("restarts", absl::StrCat(report.restart_count()));
  facts.Add("solve time",
            absl::StrCat(Significant(1e6 * SolveSeconds(report), 3), " µs"));
  const std::vector<std::string> limited = LimitedJoints(skeleton, report);
  facts.Add("on limits",
            limited.empty() ? "none" : absl::StrJoin(limited, ", "));
  if (request.solver_options().diagnose()) {
    facts.Add("rank",
              absl::StrCat(report.rank(), " of ", skeleton.velocity_count(),
                           ", ", report.free_velocity_count(), " free"));
    facts.Add("manipulability",
              absl::StrCat("translation ",
                           Significant(report.translation_manipulability(), 4),
                           ", rotation ",
                           Significant(report.rotation_manipulability(), 4)));
  }
  return facts.ToString();
}

std::string GoalsText(const v1::SolveInverseKinematicsRequest& request,
                      const v1::SolveReport& report) {
  Table table({{"GOAL"},
               {"KIND"},
               {"OFF BY (mm)", Align::kRight},
               {"OFF BY (mrad)", Align::kRight}});
  for (int i = 0; i < request.goals_size(); ++i) {
    const v1::Goal& goal = request.goals(i);
    const std::string position =
        Significant(1e3 * ErrorAt(report.position_errors_m(), i), 3);
    const std::string rotation =
        Significant(1e3 * ErrorAt(report.rotation_errors_rad(), i), 3);
    table.AddRow(
        {EffectorOf(goal), KindOf(goal), goal.has_rotation() ? "-" : position,
         goal.has_position() || goal.has_center_of_mass() ? "-" : rotation});
  }
  return table.ToString();
}

}  // namespace

std::string IkResultText(const Skeleton& skeleton,
                         const v1::SolveInverseKinematicsRequest& request,
                         const v1::SolveInverseKinematicsResponse& response) {
  std::string text = FactsText(skeleton, request, response.report());
  if (request.goals_size() > 0) {
    absl::StrAppend(&text, "\n", GoalsText(request, response.report()));
  }
  absl::StrAppend(&text, "\n", PoseText(skeleton, response.pose()));
  return text;
}

Json IkResultJson(const Skeleton& skeleton,
                  const v1::SolveInverseKinematicsRequest& request,
                  const v1::SolveInverseKinematicsResponse& response) {
  const v1::SolveReport& report = response.report();
  Json json;
  json["outcome"] = OutcomeName(report.outcome());
  json["iterations"] = report.iteration_count();
  json["restarts"] = report.restart_count();
  json["solve_s"] = SolveSeconds(report);
  json["limited_joints"] = LimitedJoints(skeleton, report);
  if (request.solver_options().diagnose()) {
    json["rank"] = report.rank();
    json["free_velocity_count"] = report.free_velocity_count();
    json["translation_manipulability"] = report.translation_manipulability();
    json["rotation_manipulability"] = report.rotation_manipulability();
  }
  json["goals"] = Json::array();
  for (int i = 0; i < request.goals_size(); ++i) {
    json["goals"].push_back(
        {{"end_effector", EffectorOf(request.goals(i))},
         {"kind", KindOf(request.goals(i))},
         {"position_error_m", ErrorAt(report.position_errors_m(), i)},
         {"rotation_error_rad", ErrorAt(report.rotation_errors_rad(), i)}});
  }
  json["joints"] = PoseJson(skeleton, response.pose());
  json["positions"] = response.pose().positions();
  return json;
}

}  // namespace gelenk::cli
