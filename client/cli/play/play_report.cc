#include "client/cli/play/play_report.h"

#include <numbers>
#include <variant>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "client/cli/text/table.h"

namespace gelenk::cli {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
// Answers lie on their limits to a rounding of about 1e-9.
constexpr double kLimitRounding = 1e-6;
// Errors travel as floats, and goals may be measured in another order.
constexpr double kErrorRounding = 1e-6;

bool IsInsideLimits(const Residuals& residuals) {
  return residuals.limit_excess <= kLimitRounding;
}

bool Agrees(const Residuals& residuals) {
  return residuals.disagreement_m <= kErrorRounding &&
         residuals.disagreement_rad <= kErrorRounding;
}

std::string GoalsText(const Playback& playback) {
  std::vector<std::string> positions;
  std::vector<std::string> poses;
  for (const Goal& goal : playback.goals) {
    const bool is_pose = std::holds_alternative<PoseGoal>(goal.kind);
    (is_pose ? poses : positions).emplace_back(EffectorId(goal.kind));
  }
  constexpr size_t kMostNamed = 8;
  if (positions.size() > kMostNamed) {
    positions = {absl::StrCat(positions.size(), " ends")};
  }
  return absl::StrCat("pose of ", absl::StrJoin(poses, ", "), "; positions of ",
                      absl::StrJoin(positions, ", "));
}

std::string ClipText(const PlayReport& report) {
  const Summary& summary = report.summary;
  return absl::StrFormat("%s, %d frames, %s s at %s fps",
                         report.playback->clip_name, summary.frame_count,
                         Significant(summary.clip_duration_s, 4),
                         Significant(summary.clip_fps, 4));
}

std::string OutcomesText(const Summary& summary) {
  return absl::StrFormat(
      "%s converged (%d of %d), %d stalled at limits, %d unreachable, %d at "
      "the iteration limit",
      Percent(summary.converged_count, summary.answered_count),
      summary.converged_count, summary.answered_count, summary.stalled_count,
      summary.unreachable_count, summary.iteration_limit_count);
}

std::string ExcessText(const Residuals& residuals) {
  if (IsInsideLimits(residuals)) return "every answer inside";
  return absl::StrFormat("BROKEN by %s rad or m at joint %s",
                         Significant(residuals.limit_excess, 3),
                         residuals.limit_joint_id);
}

std::string FactsText(const PlayReport& report) {
  const Summary& summary = report.summary;
  const Playback& playback = *report.playback;
  Facts facts;
  facts.Add("clip", ClipText(report));
  facts.Add("skeleton",
            absl::StrFormat("%d joints, %d degrees of freedom, %s m a unit",
                            playback.skeleton->joint_count(),
                            playback.skeleton->velocity_count(),
                            Significant(report.unit_m, 5)));
  facts.Add("goals", GoalsText(playback));
  facts.Add("limits", report.limits->description);
  for (const std::string& note : report.limits->notes) facts.Add("", note);
  if (report.first_frame_jump) {
    const FirstFrameJump& jump = *report.first_frame_jump;
    facts.Add(
        "first frame",
        absl::StrFormat(
            "no part of the motion: joint %s jumps by %.0f° out of it",
            playback.skeleton->joint(jump.joint).id, jump.angle_rad / kDegree));
  }
  facts.Add("frames",
            absl::StrFormat("%d answered, %d merged, %d refused; %d "
                            "reconnects",
                            summary.answered_count, summary.merged_count,
                            summary.error_count, summary.reconnects));
  facts.Add("outcomes", OutcomesText(summary));
  facts.Add("joint limits", ExcessText(*report.residuals));
  facts.Add("speed", absl::StrFormat("%.0f fps, %.1f times as fast as recorded",
                                     summary.played_fps,
                                     summary.played_fps / summary.clip_fps));
  for (const std::string& path : report.written) facts.Add("wrote", path);
  return facts.ToString();
}

void AddQuantiles(const char* name, const Quantiles& quantiles, Table& table) {
  table.AddRow({name, Significant(quantiles.p50, 3),
                Significant(quantiles.p99, 3), Significant(quantiles.max, 3)});
}

std::string QuantilesText(const Summary& summary) {
  Table table({{""},
               {"P50", Align::kRight},
               {"P99", Align::kRight},
               {"MAX", Align::kRight}});
  AddQuantiles("position residual (mm)", summary.position_mm, table);
  AddQuantiles("rotation residual (mrad)", summary.rotation_mrad, table);
  AddQuantiles("solve time (µs)", summary.solve_us, table);
  AddQuantiles("round trip (µs)", summary.round_trip_us, table);
  return table.ToString();
}

Json QuantilesJson(const Quantiles& quantiles) {
  return {
      {"p50", quantiles.p50}, {"p99", quantiles.p99}, {"max", quantiles.max}};
}

Json OutcomesJson(const Summary& summary) {
  return {{"converged", summary.converged_count},
          {"stalled_at_limits", summary.stalled_count},
          {"unreachable", summary.unreachable_count},
          {"iteration_limit", summary.iteration_limit_count}};
}

Json JumpJson(const PlayReport& report) {
  if (!report.first_frame_jump) return Json();
  const FirstFrameJump& jump = *report.first_frame_jump;
  return {{"joint", report.playback->skeleton->joint(jump.joint).id},
          {"angle_rad", jump.angle_rad},
          {"typical_rad", jump.typical_rad}};
}

}  // namespace

std::string PlayReportText(const PlayReport& report) {
  std::string text =
      absl::StrCat(FactsText(report), "\n", QuantilesText(report.summary));
  if (!Agrees(*report.residuals)) {
    absl::StrAppend(
        &text, "\nThe service reports other residuals than measured: by up to ",
        Significant(1e3 * report.residuals->disagreement_m, 3), " mm, ",
        Significant(1e3 * report.residuals->disagreement_rad, 3), " mrad.\n");
  }
  return text;
}

Json PlayReportJson(const PlayReport& report) {
  const Summary& summary = report.summary;
  const Playback& playback = *report.playback;
  Json json;
  json["clip"] = playback.clip_name;
  json["frames"] = summary.frame_count;
  json["clip_fps"] = summary.clip_fps;
  json["clip_duration_s"] = summary.clip_duration_s;
  json["unit_m"] = report.unit_m;
  json["joints"] = playback.skeleton->joint_count();
  json["velocity_count"] = playback.skeleton->velocity_count();
  json["goals"] = Json::array();
  for (const Goal& goal : playback.goals) {
    json["goals"].push_back(
        {{"end_effector", std::string(EffectorId(goal.kind))},
         {"kind", std::string(GoalKindName(goal.kind))}});
  }
  json["limits"] = report.limits->description;
  json["limit_notes"] = report.limits->notes;
  json["first_frame_jump"] = JumpJson(report);
  json["position_tolerance_m"] = playback.tolerance.position_m;
  json["rotation_tolerance_rad"] = playback.tolerance.rotation_rad;
  json["answered"] = summary.answered_count;
  json["merged"] = summary.merged_count;
  json["refused"] = summary.error_count;
  json["reconnects"] = summary.reconnects;
  json["outcomes"] = OutcomesJson(summary);
  json["converged_share"] = summary.converged_share;
  json["position_residual_mm"] = QuantilesJson(summary.position_mm);
  json["rotation_residual_mrad"] = QuantilesJson(summary.rotation_mrad);
  json["residual_disagreement_m"] = report.residuals->disagreement_m;
  json["residual_disagreement_rad"] = report.residuals->disagreement_rad;
  json["limit_excess"] = report.residuals->limit_excess;
  json["limits_kept"] = IsInsideLimits(*report.residuals);
  json["solve_us"] = QuantilesJson(summary.solve_us);
  json["round_trip_us"] = QuantilesJson(summary.round_trip_us);
  json["played_fps"] = summary.played_fps;
  json["written"] = report.written;
  return json;
}

absl::Status CheckPlayed(const PlayReport& report) {
  for (size_t i = 0; i < report.playback->answers.size(); ++i) {
    const std::string& error = report.playback->answers[i].error;
    if (error.empty()) continue;
    return absl::InternalError(
        absl::StrFormat("%d frames were refused, the first: frame %d: %s",
                        report.summary.error_count, i, error));
  }
  if (!IsInsideLimits(*report.residuals)) {
    return absl::InternalError(
        absl::StrCat("joint limits: ", ExcessText(*report.residuals)));
  }
  if (!Agrees(*report.residuals)) {
    return absl::InternalError(
        "the service reports other residuals than measured");
  }
  return absl::OkStatus();
}

}  // namespace gelenk::cli
