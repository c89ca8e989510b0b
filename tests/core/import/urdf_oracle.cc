#include "tests/core/import/urdf_oracle.h"

#include <cmath>
#include <sstream>
#include <string_view>

namespace gelenk::testing {
namespace {

using tinyxml2::XMLElement;

Eigen::Vector3d Vector(const XMLElement* element, const char* attribute,
                       const Eigen::Vector3d& otherwise) {
  if (element == nullptr || element->Attribute(attribute) == nullptr) {
    return otherwise;
  }
  std::istringstream text(element->Attribute(attribute));
  Eigen::Vector3d v;
  text >> v.x() >> v.y() >> v.z();
  return v;
}

Eigen::Matrix3d TurnX(double a) {
  Eigen::Matrix3d m;
  m << 1, 0, 0, 0, std::cos(a), -std::sin(a), 0, std::sin(a), std::cos(a);
  return m;
}
Eigen::Matrix3d TurnY(double a) {
  Eigen::Matrix3d m;
  m << std::cos(a), 0, std::sin(a), 0, 1, 0, -std::sin(a), 0, std::cos(a);
  return m;
}
Eigen::Matrix3d TurnZ(double a) {
  Eigen::Matrix3d m;
  m << std::cos(a), -std::sin(a), 0, std::sin(a), std::cos(a), 0, 0, 0, 1;
  return m;
}

// Rodrigues' formula.
Eigen::Matrix3d TurnAbout(const Eigen::Vector3d& axis, double angle) {
  Eigen::Matrix3d cross;
  cross << 0, -axis.z(), axis.y(), axis.z(), 0, -axis.x(), -axis.y(), axis.x(),
      0;
  return Eigen::Matrix3d::Identity() + std::sin(angle) * cross +
         (1 - std::cos(angle)) * cross * cross;
}

Eigen::Matrix4d Affine(const Eigen::Matrix3d& linear,
                       const Eigen::Vector3d& translation) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.topLeftCorner<3, 3>() = linear;
  matrix.topRightCorner<3, 1>() = translation;
  return matrix;
}

std::string_view Type(const XMLElement& joint) {
  return joint.Attribute("type");
}

}  // namespace

UrdfOracle::UrdfOracle(const std::string& text) { xml_.Parse(text.c_str()); }

std::vector<std::string> UrdfOracle::Links() const {
  std::vector<std::string> names;
  for (const XMLElement* link = xml_.RootElement()->FirstChildElement("link");
       link != nullptr; link = link->NextSiblingElement("link")) {
    names.emplace_back(link->Attribute("name"));
  }
  return names;
}

std::vector<std::string> UrdfOracle::Joints() const {
  std::vector<std::string> names;
  for (const XMLElement* joint = xml_.RootElement()->FirstChildElement("joint");
       joint != nullptr; joint = joint->NextSiblingElement("joint")) {
    names.emplace_back(joint->Attribute("name"));
  }
  return names;
}

const XMLElement* UrdfOracle::Joint(const std::string& name) const {
  const XMLElement* joint = xml_.RootElement()->FirstChildElement("joint");
  while (joint != nullptr && joint->Attribute("name") != name) {
    joint = joint->NextSiblingElement("joint");
  }
  return joint;
}

double UrdfOracle::NumberOf(
    const XMLElement& joint,
    const std::map<std::string, double>& numbers) const {
  const XMLElement* mimic = joint.FirstChildElement("mimic");
  if (mimic == nullptr) return numbers.at(joint.Attribute("name"));
  return mimic->DoubleAttribute("multiplier", 1) *
             NumberOf(*Joint(mimic->Attribute("joint")), numbers) +
         mimic->DoubleAttribute("offset", 0);
}

Eigen::Matrix4d UrdfOracle::RootFromLink(
    const std::string& link, const std::map<std::string, double>& numbers) {
  const XMLElement* joint = xml_.RootElement()->FirstChildElement("joint");
  while (joint != nullptr &&
         joint->FirstChildElement("child")->Attribute("link") != link) {
    joint = joint->NextSiblingElement("joint");
  }
  if (joint == nullptr) return Eigen::Matrix4d::Identity();

  const XMLElement* origin = joint->FirstChildElement("origin");
  const Eigen::Vector3d rpy = Vector(origin, "rpy", Eigen::Vector3d::Zero());
  const Eigen::Matrix4d parent_from_joint =
      Affine(TurnZ(rpy.z()) * TurnY(rpy.y()) * TurnX(rpy.x()),
             Vector(origin, "xyz", Eigen::Vector3d::Zero()));
  const Eigen::Vector3d axis =
      Vector(joint->FirstChildElement("axis"), "xyz", Eigen::Vector3d::UnitX())
          .normalized();
  Eigen::Matrix4d motion = Eigen::Matrix4d::Identity();
  if (Type(*joint) == "revolute" || Type(*joint) == "continuous") {
    motion = Affine(TurnAbout(axis, NumberOf(*joint, numbers)),
                    Eigen::Vector3d::Zero());
  } else if (Type(*joint) == "prismatic") {
    motion =
        Affine(Eigen::Matrix3d::Identity(), NumberOf(*joint, numbers) * axis);
  }
  return RootFromLink(joint->FirstChildElement("parent")->Attribute("link"),
                      numbers) *
         parent_from_joint * motion;
}

}  // namespace gelenk::testing
