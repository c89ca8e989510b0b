#include "gelenk/import/urdf_reader.h"

#include <tinyxml2.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "absl/status/status.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "gelenk/import/urdf_element.h"
#include "gelenk/math/rotation.h"
#include "gelenk/skeleton/joint_check.h"

namespace gelenk {
namespace {

using tinyxml2::XMLDocument;
using tinyxml2::XMLElement;

// Shorter than this an axis is rounding, not a direction.
constexpr double kShortestAxis = 1e-6;

// What robots write for "no limit", and more than any joint can go.
constexpr double kUnlimited = 1e9;

absl::Status CheckSize(absl::string_view bytes, const UrdfBounds& bounds) {
  const auto check = [](absl::string_view what, size_t count, size_t most) {
    return count <= most
               ? absl::OkStatus()
               : absl::InvalidArgumentError(absl::StrFormat(
                     "want at most %d %s, got %d", most, what, count));
  };
  absl::Status status = check("bytes", bytes.size(), bounds.max_bytes);
  if (!status.ok()) return status;
  status.Update(check("elements", std::count(bytes.begin(), bytes.end(), '<'),
                      bounds.max_elements));
  status.Update(check("attributes", std::count(bytes.begin(), bytes.end(), '='),
                      bounds.max_attributes));
  // The parser would stop there without a word.
  if (absl::StrContains(bytes, '\0')) {
    status.Update(absl::InvalidArgumentError(
        "there is a byte 0 in the file: want text in UTF-8"));
  }
  return status;
}

absl::string_view ErrorText(tinyxml2::XMLError error) {
  switch (error) {
    case tinyxml2::XML_ERROR_EMPTY_DOCUMENT:
      return "the file is empty";
    case tinyxml2::XML_ERROR_MISMATCHED_ELEMENT:
      return "an element is not closed, or closed twice";
    case tinyxml2::XML_ERROR_PARSING_ATTRIBUTE:
      return "malformed attribute";
    case tinyxml2::XML_ELEMENT_DEPTH_EXCEEDED:
      return "elements are nested too deep";
    default:
      return "malformed or cut off";
  }
}

absl::Status ParseXml(absl::string_view bytes, XMLDocument& xml) {
  const tinyxml2::XMLError error = xml.Parse(bytes.data(), bytes.size());
  if (error == tinyxml2::XML_SUCCESS) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrFormat(
      "line %d: no well-formed XML: %s", xml.ErrorLineNum(), ErrorText(error)));
}

absl::StatusOr<const XMLElement*> FindRobot(const XMLDocument& xml) {
  const XMLElement* root = xml.RootElement();
  if (root == nullptr) return absl::InvalidArgumentError("no <robot>");
  if (absl::string_view(root->Name()) == "robot") return root;
  return absl::InvalidArgumentError(
      absl::StrCat(UrdfLine(root->GetLineNum()),
                   ": want <robot>, got an element ", QuotedId(root->Name())));
}

const XMLElement* NextInDocument(const XMLElement* at) {
  if (at->FirstChildElement() != nullptr) return at->FirstChildElement();
  while (at != nullptr && at->NextSiblingElement() == nullptr) {
    at = at->Parent()->ToElement();
  }
  return at == nullptr ? nullptr : at->NextSiblingElement();
}

// A namespace alone is no sign: expanded files keep it.
absl::Status RefuseXacro(const XMLElement& robot) {
  for (const XMLElement* at = &robot; at != nullptr; at = NextInDocument(at)) {
    if (!absl::StartsWith(at->Name(), "xacro:")) continue;
    return absl::InvalidArgumentError(absl::StrCat(
        UrdfLine(at->GetLineNum()),
        ": a xacro file is no URDF yet: run `xacro FILE > ROBOT.urdf` first"));
  }
  return absl::OkStatus();
}

struct TypeName {
  absl::string_view name;
  JointType type;
};
constexpr TypeName kTypeNames[] = {
    {"fixed", JointType::kFixed},         {"revolute", JointType::kRevolute},
    {"continuous", JointType::kRevolute}, {"prismatic", JointType::kPrismatic},
    {"planar", JointType::kPlanar},       {"floating", JointType::kFree}};

bool IsScalar(JointType type) {
  return type == JointType::kRevolute || type == JointType::kPrismatic;
}

class UrdfParser {
 public:
  explicit UrdfParser(const UrdfBounds& bounds) : bounds_(bounds) {}

  absl::StatusOr<UrdfDocument> Parse(const XMLElement& robot);

 private:
  UrdfElement Element(const XMLElement& xml, std::string title = "") {
    return UrdfElement(xml, std::move(title), findings_);
  }

  void ReadLink(const XMLElement& xml);
  void ReadJoint(const XMLElement& xml);
  void ReadType(const UrdfElement& element, UrdfJoint& joint);
  UrdfReference ReadReference(const UrdfElement& element, const char* name);
  void ReadAxis(const UrdfElement& element, UrdfJoint& joint);
  void ReadLimits(const UrdfElement& element, bool is_continuous,
                  JointLimits& limits);
  void ReadRange(const UrdfElement& limit, JointLimits& limits);
  void ReadVelocity(const UrdfElement& limit, JointLimits& limits);
  void ReadMimic(const UrdfElement& element, UrdfJoint& joint);

  const UrdfBounds bounds_;
  UrdfFindings findings_;
  UrdfDocument document_;
};

absl::StatusOr<UrdfDocument> UrdfParser::Parse(const XMLElement& robot) {
  document_.name = std::string(Element(robot).Text("name").value_or(""));
  for (const XMLElement* xml = robot.FirstChildElement(); xml != nullptr;
       xml = xml->NextSiblingElement()) {
    const absl::string_view name = xml->Name();
    if (name == "link") ReadLink(*xml);
    if (name == "joint") ReadJoint(*xml);
    const size_t count =
        std::max(document_.links.size(), document_.joints.size());
    // A root link, and one link a joint.
    if (count > static_cast<size_t>(bounds_.max_joints)) {
      return absl::InvalidArgumentError(
          absl::StrFormat("line %d: want at most %d joints", xml->GetLineNum(),
                          bounds_.max_joints));
    }
  }
  if (!findings_.violations.empty()) return findings_.violations.ToStatus();
  document_.warnings = std::move(findings_.warnings);
  return std::move(document_);
}

void UrdfParser::ReadLink(const XMLElement& xml) {
  UrdfLink link;
  link.line = xml.GetLineNum();
  link.name = std::string(Element(xml).RequiredText("name"));
  const UrdfElement element =
      Element(xml, absl::StrCat("link ", QuotedId(link.name)));
  if (const auto inertial = element.Child("inertial")) {
    RigidTransform link_from_inertial;
    if (const auto origin = inertial->Child("origin")) {
      origin->ReadTransform(link_from_inertial);
    }
    link.center_of_mass = link_from_inertial.translation;
    if (const auto mass = inertial->Child("mass")) {
      mass->ReadNumber("value", link.mass_kg);
      if (!(link.mass_kg >= 0 && link.mass_kg <= UrdfElement::kMaxMagnitude)) {
        mass->Refuse("value", "want 0 to 1e9 kg");
      }
    }
  }
  document_.links.push_back(std::move(link));
}

void UrdfParser::ReadJoint(const XMLElement& xml) {
  UrdfJoint joint;
  joint.line = xml.GetLineNum();
  joint.name = std::string(Element(xml).RequiredText("name"));
  const UrdfElement element =
      Element(xml, absl::StrCat("joint ", QuotedId(joint.name)));
  joint.parent_link = ReadReference(element, "parent");
  joint.child_link = ReadReference(element, "child");
  if (const auto origin = element.Child("origin")) {
    origin->ReadTransform(joint.parent_from_joint);
  }
  ReadType(element, joint);
  document_.joints.push_back(std::move(joint));
}

// The type, and what only some types have.
void UrdfParser::ReadType(const UrdfElement& element, UrdfJoint& joint) {
  const absl::string_view name = element.RequiredText("type");
  if (name.empty()) return;
  const auto* found = std::find_if(
      std::begin(kTypeNames), std::end(kTypeNames),
      [name](const TypeName& candidate) { return candidate.name == name; });
  if (found == std::end(kTypeNames)) {
    element.Refuse("type",
                   "want fixed, revolute, continuous, prismatic, planar or "
                   "floating");
    return;
  }
  joint.type = found->type;
  if (NeedsAxis(joint.type)) ReadAxis(element, joint);
  if (IsScalar(joint.type)) {
    ReadLimits(element, name == "continuous", joint.limits);
  }
  ReadMimic(element, joint);
}

UrdfReference UrdfParser::ReadReference(const UrdfElement& element,
                                        const char* name) {
  const auto child = element.Child(name);
  if (!child) {
    element.Refuse(nullptr, absl::StrCat("no <", name, ">"));
    return {};
  }
  return {std::string(child->RequiredText("link")), child->line()};
}

void UrdfParser::ReadAxis(const UrdfElement& element, UrdfJoint& joint) {
  const auto axis = element.Child("axis");
  if (!axis) return;
  axis->ReadVector("xyz", joint.axis);
  const double norm = joint.axis.norm();
  if (norm < kShortestAxis) {
    axis->Refuse("xyz", "no direction");
    joint.axis = Eigen::Vector3d::UnitX();
    return;
  }
  if (std::abs(norm - 1) > kUnitTolerance) {
    axis->Warn(absl::StrFormat("%g long, taken as a unit vector", norm));
  }
  joint.axis /= norm;
}

void UrdfParser::ReadLimits(const UrdfElement& element, bool is_continuous,
                            JointLimits& limits) {
  const auto limit = element.Child("limit");
  if (!limit) {
    if (!is_continuous) element.Warn("no <limit>: unlimited");
    return;
  }
  ReadVelocity(*limit, limits);
  if (!is_continuous) ReadRange(*limit, limits);
}

void UrdfParser::ReadRange(const UrdfElement& limit, JointLimits& limits) {
  if (!limit.Text("lower") && !limit.Text("upper")) {
    limit.Warn("neither lower nor upper: unlimited");
    return;
  }
  double lower = 0;
  double upper = 0;
  for (const auto& [name, value] :
       {std::make_pair("lower", &lower), std::make_pair("upper", &upper)}) {
    limit.ReadNumber(name, *value);
    if (!limit.Text(name))
      limit.Warn(absl::StrCat("no ", name, ": taken as 0"));
  }
  if (lower > upper) {
    limit.Refuse("lower", absl::StrFormat("above upper, %g", upper));
    return;
  }
  if (lower == upper) limit.Warn("lower and upper are equal: it cannot move");
  if (lower <= -kUnlimited) lower = -INFINITY;
  if (upper >= kUnlimited) upper = INFINITY;
  limits.lower = {lower};
  limits.upper = {upper};
}

void UrdfParser::ReadVelocity(const UrdfElement& limit, JointLimits& limits) {
  if (!limit.Text("velocity")) return;
  double velocity = 0;
  limit.ReadNumber("velocity", velocity);
  if (velocity < 0) {
    limit.Refuse("velocity", "below 0");
  } else if (velocity == 0) {
    limit.Warn("a velocity of 0 is taken as no limit");
  } else if (velocity < kUnlimited) {
    limits.max_velocity = {velocity};
  }
}

void UrdfParser::ReadMimic(const UrdfElement& element, UrdfJoint& joint) {
  const auto mimic = element.Child("mimic");
  if (!mimic) return;
  if (!IsScalar(joint.type)) {
    mimic->Warn(absl::StrCat("a ", JointTypeName(joint.type),
                             " joint cannot follow another: ignored"));
    return;
  }
  UrdfMimic& followed = joint.mimic.emplace();
  followed.joint = {std::string(mimic->RequiredText("joint")), mimic->line()};
  for (const auto& [name, value] :
       {std::make_pair("multiplier", &followed.multiplier),
        std::make_pair("offset", &followed.offset)}) {
    mimic->ReadNumber(name, *value);
    if (std::abs(*value) > UrdfElement::kMaxMagnitude) {
      mimic->Refuse(name, "want a number of at most 1e9");
    }
  }
}

}  // namespace

absl::StatusOr<UrdfDocument> ReadUrdf(absl::string_view bytes,
                                      const UrdfBounds& bounds) {
  absl::Status status = CheckSize(bytes, bounds);
  if (!status.ok()) return status;
  XMLDocument xml;
  status = ParseXml(bytes, xml);
  if (!status.ok()) return status;
  const absl::StatusOr<const XMLElement*> robot = FindRobot(xml);
  if (!robot.ok()) return robot.status();
  status = RefuseXacro(**robot);
  if (!status.ok()) return status;
  return UrdfParser(bounds).Parse(**robot);
}

}  // namespace gelenk
