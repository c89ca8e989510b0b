#include "gelenk/ik/goal_list_check.h"

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "gelenk/ik/ik_problem.h"
#include "gelenk/skeleton/joint_check.h"

namespace gelenk {

bool GoalListCheck::AddCount(size_t count) {
  if (count <= size_t{kMaxGoals}) return true;
  violations_.Add("goals",
                  absl::StrFormat("want at most %d, got %d", kMaxGoals, count));
  return false;
}

bool GoalListCheck::Add(Goal& goal) {
  const std::string field = absl::StrCat("goals[", count_, "]");
  const absl::Status alone = CheckAndNormalize(goal);
  violations_.AddStatus(field, alone);
  AddId(field, goal);
  if (skeleton_ == nullptr) return alone.ok();
  const absl::Status on_skeleton = CheckOn(*skeleton_, goal);
  violations_.AddStatus(field, on_skeleton);
  return alone.ok() && on_skeleton.ok();
}

void GoalListCheck::AddWithoutKind(const Goal& goal) {
  const std::string field = absl::StrCat("goals[", count_, "]");
  violations_.AddStatus(field, CheckWithoutKind(goal));
  AddId(field, goal);
}

void GoalListCheck::AddId(const std::string& field, const Goal& goal) {
  ++count_;
  if (ids_.insert(goal.id).second) return;
  violations_.Add(absl::StrCat(field, ".goal_id"),
                  absl::StrCat("duplicate ", QuotedId(goal.id)));
}

}  // namespace gelenk
