#include "gelenk/import/urdf_import.h"

#include <cmath>
#include <utility>

#include "absl/container/flat_hash_map.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "gelenk/base/violations.h"
#include "gelenk/formats/unique_names.h"
#include "gelenk/import/urdf_element.h"
#include "gelenk/skeleton/joint_check.h"
#include "gelenk/skeleton/pose.h"

namespace gelenk {
namespace {

using IndexByName = absl::flat_hash_map<absl::string_view, int>;

// Roots that an error lists.
constexpr size_t kMaxListedRoots = 5;

// Which parts of the document belong together, by index; -1 for none.
struct UrdfTree {
  // Per link, the joint that moves it.
  std::vector<int> joint_of_link;
  // Per joint.
  std::vector<int> parent_links;
  std::vector<int> child_links;
  // Per joint with a mimic, the joint it names.
  std::vector<int> followed;
  int root_link = -1;
};

template <class Part>
IndexByName IndexNames(absl::string_view kind, const std::vector<Part>& parts,
                       Violations& violations) {
  IndexByName index_of;
  for (size_t i = 0; i < parts.size(); ++i) {
    const auto [found, is_new] =
        index_of.emplace(parts[i].name, static_cast<int>(i));
    if (is_new) continue;
    violations.Add(
        UrdfLine(parts[i].line),
        absl::StrFormat("%s %s: the one on line %d has that name", kind,
                        QuotedId(parts[i].name), parts[found->second].line));
  }
  return index_of;
}

int Find(absl::string_view kind, const IndexByName& index_of,
         const UrdfReference& reference, absl::string_view by,
         Violations& violations) {
  const auto found = index_of.find(reference.name);
  if (found != index_of.end()) return found->second;
  violations.Add(UrdfLine(reference.line),
                 absl::StrFormat("joint %s: no %s %s", QuotedId(by), kind,
                                 QuotedId(reference.name)));
  return -1;
}

void LinkJoints(const UrdfDocument& document, UrdfTree& tree,
                Violations& violations) {
  const IndexByName links = IndexNames("link", document.links, violations);
  const IndexByName joints = IndexNames("joint", document.joints, violations);
  tree.joint_of_link.assign(document.links.size(), -1);
  for (size_t i = 0; i < document.joints.size(); ++i) {
    const UrdfJoint& joint = document.joints[i];
    const auto find_link = [&](const UrdfReference& reference) {
      return Find("link", links, reference, joint.name, violations);
    };
    tree.parent_links.push_back(find_link(joint.parent_link));
    tree.child_links.push_back(find_link(joint.child_link));
    tree.followed.push_back(
        joint.mimic
            ? Find("joint", joints, joint.mimic->joint, joint.name, violations)
            : -1);
    const int child = tree.child_links.back();
    if (child < 0) continue;
    int& mover = tree.joint_of_link[child];
    if (mover >= 0) {
      violations.Add(
          UrdfLine(joint.child_link.line),
          absl::StrFormat("joint %s: link %s is moved by joint %s already",
                          QuotedId(joint.name), QuotedId(joint.child_link.name),
                          QuotedId(document.joints[mover].name)));
      continue;
    }
    mover = static_cast<int>(i);
  }
}

void FindRoot(const UrdfDocument& document, UrdfTree& tree,
              Violations& violations) {
  std::string roots;
  size_t count = 0;
  for (size_t i = 0; i < document.links.size(); ++i) {
    if (tree.joint_of_link[i] >= 0) continue;
    tree.root_link = static_cast<int>(i);
    if (++count > kMaxListedRoots) continue;
    absl::StrAppend(&roots, count == 1 ? "" : ", ",
                    QuotedId(document.links[i].name), " on line ",
                    document.links[i].line);
  }
  if (count == 1) return;
  if (count > kMaxListedRoots) absl::StrAppend(&roots, ", ...");
  violations.Add(
      "robot",
      count == 0 ? "want one link that no joint moves, got none"
                 : absl::StrFormat("want one link that no joint moves, got %d: "
                                   "%s",
                                   count, roots));
}

// With one root and one mover a link, what does not hang from the root hangs
// from itself.
void CheckReached(const UrdfDocument& document, const UrdfTree& tree,
                  const SkeletonBounds& bounds, Violations& violations) {
  std::vector<std::vector<int>> joints_on_link(document.links.size());
  for (size_t i = 0; i < document.joints.size(); ++i) {
    joints_on_link[tree.parent_links[i]].push_back(static_cast<int>(i));
  }
  std::vector<bool> reached(document.joints.size(), false);
  // The root's joint counts too.
  int depth = 1;
  std::vector<int> level = {tree.root_link};
  while (!level.empty()) {
    std::vector<int> next;
    ++depth;
    for (int link : level) {
      for (int joint : joints_on_link[link]) {
        reached[joint] = true;
        next.push_back(tree.child_links[joint]);
        if (depth != bounds.max_depth + 1) continue;
        violations.Add(UrdfLine(document.joints[joint].line),
                       absl::StrFormat("joint %s: deeper than %d joints",
                                       QuotedId(document.joints[joint].name),
                                       bounds.max_depth));
      }
    }
    level = std::move(next);
  }
  for (size_t i = 0; i < document.joints.size(); ++i) {
    if (reached[i]) continue;
    violations.Add(UrdfLine(document.joints[i].line),
                   absl::StrFormat("joint %s does not hang from the root link: "
                                   "the links are in a circle",
                                   QuotedId(document.joints[i].name)));
  }
}

absl::StatusOr<UrdfTree> FindTree(const UrdfDocument& document,
                                  const SkeletonBounds& bounds) {
  UrdfTree tree;
  Violations violations;
  LinkJoints(document, tree, violations);
  // Roots mean little while names do not fit.
  if (!violations.empty()) return violations.ToStatus();
  FindRoot(document, tree, violations);
  if (!violations.empty()) return violations.ToStatus();
  CheckReached(document, tree, bounds, violations);
  if (!violations.empty()) return violations.ToStatus();
  return tree;
}

// q = multiplier * q of joint `joint` + offset; the joint itself for one that
// mimics none.
struct Follower {
  int joint = -1;
  double multiplier = 1;
  double offset = 0;
};

// Follows chains of mimics to the joint that owns its number.
class MimicResolver {
 public:
  MimicResolver(const UrdfDocument& document, const UrdfTree& tree)
      : document_(document),
        tree_(tree),
        marks_(document.joints.size(), Mark::kNew),
        followers_(document.joints.size()) {}

  absl::StatusOr<std::vector<Follower>> Resolve() {
    for (size_t i = 0; i < followers_.size(); ++i) {
      ResolveFrom(static_cast<int>(i));
    }
    if (!violations_.empty()) return violations_.ToStatus();
    return std::move(followers_);
  }

 private:
  enum class Mark : char { kNew, kOpen, kDone };

  void ResolveFrom(int start) {
    std::vector<int> walk;
    int at = start;
    while (marks_[at] == Mark::kNew && document_.joints[at].mimic) {
      marks_[at] = Mark::kOpen;
      walk.push_back(at);
      at = tree_.followed[at];
    }
    if (marks_[at] == Mark::kNew) {
      followers_[at].joint = at;
      marks_[at] = Mark::kDone;
    }
    const bool is_circle = marks_[at] == Mark::kOpen;
    for (size_t i = walk.size(); i-- > 0;) {
      if (is_circle) {
        Refuse(walk[i], "joints that mimic each other in a circle");
      } else {
        Compose(walk[i]);
      }
      marks_[walk[i]] = Mark::kDone;
    }
  }

  void Compose(int index) {
    const UrdfMimic& mimic = *document_.joints[index].mimic;
    const Follower& next = followers_[tree_.followed[index]];
    // Below a circle, which has been reported.
    if (next.joint < 0) return;
    const JointType type = document_.joints[next.joint].type;
    if (type != JointType::kRevolute && type != JointType::kPrismatic) {
      Refuse(index, absl::StrFormat("joint %s is %s, and has no number to "
                                    "follow",
                                    QuotedId(document_.joints[next.joint].name),
                                    JointTypeName(type)));
      return;
    }
    followers_[index] = {next.joint, mimic.multiplier * next.multiplier,
                         mimic.multiplier * next.offset + mimic.offset};
    if (!(std::abs(followers_[index].multiplier) <=
          UrdfElement::kMaxMagnitude) ||
        !(std::abs(followers_[index].offset) <= UrdfElement::kMaxMagnitude)) {
      Refuse(index, "the chain of mimics grows beyond 1e9");
    }
  }

  void Refuse(int index, absl::string_view reason) {
    const UrdfJoint& joint = document_.joints[index];
    violations_.Add(
        UrdfLine(joint.mimic->joint.line),
        absl::StrCat("<mimic> of joint ", QuotedId(joint.name), ": ", reason));
  }

  const UrdfDocument& document_;
  const UrdfTree& tree_;
  std::vector<Mark> marks_;
  std::vector<Follower> followers_;
  Violations violations_;
};

class UrdfSkeletonBuilder {
 public:
  UrdfSkeletonBuilder(const UrdfDocument& document, const UrdfTree& tree,
                      const std::vector<Follower>& followers,
                      const SkeletonBounds& bounds)
      : document_(document),
        tree_(tree),
        followers_(followers),
        bounds_(bounds),
        ids_(kMaxIdBytes),
        warnings_(document.warnings) {}

  absl::StatusOr<UrdfImport> Build();

 private:
  void TakeIds();
  std::string TakeId(absl::string_view kind, const std::string& name);
  const std::string& IdOfMover(int link) const;
  void AddJoints();
  void AddJoint(int index);
  void AddLinkFrames();
  absl::StatusOr<std::shared_ptr<const Skeleton>> BuildFrom(
      absl::Span<const Joint> joints, const Eigen::VectorXd& rest) const;
  // The skeleton once more, resting inside its limits.
  absl::StatusOr<std::shared_ptr<const Skeleton>> RestInsideLimits(
      std::shared_ptr<const Skeleton> skeleton);

  const UrdfDocument& document_;
  const UrdfTree& tree_;
  const std::vector<Follower>& followers_;
  const SkeletonBounds bounds_;
  UniqueNames ids_;
  std::string root_id_;
  std::vector<std::string> joint_ids_;
  std::vector<Joint> joints_;
  std::vector<EndEffector> end_effectors_;
  std::vector<std::string> warnings_;
};

absl::StatusOr<UrdfImport> UrdfSkeletonBuilder::Build() {
  TakeIds();
  AddJoints();
  AddLinkFrames();
  absl::StatusOr<std::shared_ptr<const Skeleton>> skeleton =
      BuildFrom(joints_, Eigen::VectorXd());
  if (skeleton.ok()) skeleton = RestInsideLimits(*std::move(skeleton));
  if (!skeleton.ok()) return skeleton.status();
  return UrdfImport{*std::move(skeleton), std::move(warnings_)};
}

// Joints first: what is called like a joint is the joint.
void UrdfSkeletonBuilder::TakeIds() {
  for (const UrdfJoint& joint : document_.joints) {
    joint_ids_.push_back(TakeId("joint", joint.name));
  }
  root_id_ = TakeId("link", document_.links[tree_.root_link].name);
}

std::string UrdfSkeletonBuilder::TakeId(absl::string_view kind,
                                        const std::string& name) {
  const std::string printable = PrintableUtf8(name);
  std::string id = ids_.Take(printable);
  if (id != name) {
    warnings_.push_back(
        absl::StrCat(kind, " \"", printable, "\" is called \"", id, "\""));
  }
  return id;
}

const std::string& UrdfSkeletonBuilder::IdOfMover(int link) const {
  const int joint = tree_.joint_of_link[link];
  return joint < 0 ? root_id_ : joint_ids_[joint];
}

void UrdfSkeletonBuilder::AddJoints() {
  Joint root;
  root.id = root_id_;
  const UrdfLink& link = document_.links[tree_.root_link];
  root.link_mass_kg = link.mass_kg;
  root.link_center_of_mass = link.center_of_mass;
  joints_.push_back(std::move(root));
  for (size_t i = 0; i < document_.joints.size(); ++i) {
    AddJoint(static_cast<int>(i));
  }
}

void UrdfSkeletonBuilder::AddJoint(int index) {
  const UrdfJoint& from = document_.joints[index];
  const UrdfLink& link = document_.links[tree_.child_links[index]];
  Joint joint;
  joint.id = joint_ids_[index];
  joint.parent_id = IdOfMover(tree_.parent_links[index]);
  joint.type = from.type;
  joint.parent_from_joint = from.parent_from_joint;
  joint.axis = from.axis;
  joint.limits = from.limits;
  joint.link_mass_kg = link.mass_kg;
  joint.link_center_of_mass = link.center_of_mass;
  if (from.mimic) {
    const Follower& follower = followers_[index];
    joint.mimic = {joint_ids_[follower.joint], follower.multiplier,
                   follower.offset};
  }
  joints_.push_back(std::move(joint));
}

void UrdfSkeletonBuilder::AddLinkFrames() {
  constexpr absl::string_view kSuffix = ".link";
  for (size_t i = 0; i < document_.links.size(); ++i) {
    EndEffector frame;
    frame.joint_id = IdOfMover(static_cast<int>(i));
    std::string name = PrintableUtf8(document_.links[i].name);
    // Its joint is found by that name.
    if (name == frame.joint_id) continue;
    if (static_cast<int>(i) == tree_.root_link) continue;
    if (ids_.Contains(name)) {
      const std::string called = absl::StrCat(
          TruncateUtf8(name, kMaxIdBytes - kSuffix.size()), kSuffix);
      frame.id = ids_.Take(called);
      warnings_.push_back(absl::StrCat("link \"", name, "\" is called \"",
                                       frame.id,
                                       "\": another joint has its name"));
    } else {
      frame.id = TakeId("link", document_.links[i].name);
    }
    end_effectors_.push_back(std::move(frame));
  }
}

absl::StatusOr<std::shared_ptr<const Skeleton>> UrdfSkeletonBuilder::BuildFrom(
    absl::Span<const Joint> joints, const Eigen::VectorXd& rest) const {
  SkeletonBuilder builder;
  builder.SetUp(Eigen::Vector3d::UnitZ()).SetBounds(bounds_);
  builder.SetRestPositions(rest);
  for (const Joint& joint : joints) builder.AddJoint(joint);
  for (const EndEffector& frame : end_effectors_) builder.AddEndEffector(frame);
  return builder.Build();
}

absl::StatusOr<std::shared_ptr<const Skeleton>>
UrdfSkeletonBuilder::RestInsideLimits(
    std::shared_ptr<const Skeleton> skeleton) {
  Eigen::VectorXd rest = skeleton->rest_positions();
  if (ClampToLimits(*skeleton, rest) == 0) return skeleton;
  std::string moved;
  for (int i = 0; i < skeleton->joint_count(); ++i) {
    const int at = skeleton->span(i).position_offset;
    if (at < 0 || rest[at] == skeleton->rest_positions()[at]) continue;
    absl::StrAppend(&moved, moved.empty() ? "" : ", ", "\"",
                    skeleton->joint(i).id, "\"");
  }
  warnings_.push_back(absl::StrCat(
      "zero is outside the limits: the rest pose has another value for ",
      moved));
  return BuildFrom(skeleton->joints(), rest);
}

}  // namespace

absl::StatusOr<UrdfImport> ImportUrdf(const UrdfDocument& document,
                                      const SkeletonBounds& bounds) {
  const absl::StatusOr<UrdfTree> tree = FindTree(document, bounds);
  if (!tree.ok()) return tree.status();
  const absl::StatusOr<std::vector<Follower>> followers =
      MimicResolver(document, *tree).Resolve();
  if (!followers.ok()) return followers.status();
  return UrdfSkeletonBuilder(document, *tree, *followers, bounds).Build();
}

}  // namespace gelenk
