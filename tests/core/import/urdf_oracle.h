// Where the links of a URDF are, straight from its text: 4 x 4 matrices along
// <parent> and <child>, each number read where it stands. Slow, and independent
// of what is tested.
#ifndef GELENK_TESTS_CORE_IMPORT_URDF_ORACLE_H_
#define GELENK_TESTS_CORE_IMPORT_URDF_ORACLE_H_

#include <tinyxml2.h>

#include <Eigen/Core>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace gelenk::testing {

class UrdfOracle {
 public:
  // `text` is a URDF without faults.
  explicit UrdfOracle(const std::string& text);

  std::vector<std::string> Links() const;
  std::vector<std::string> Joints() const;

  // root_from_link with these numbers of the joints that have one: angle or
  // way; mimics not among them. Floating and planar joints rest.
  Eigen::Matrix4d RootFromLink(const std::string& link,
                               const std::map<std::string, double>& numbers);

 private:
  const tinyxml2::XMLElement* Joint(const std::string& name) const;
  double NumberOf(const tinyxml2::XMLElement& joint,
                  const std::map<std::string, double>& numbers) const;

  tinyxml2::XMLDocument xml_;
};

}  // namespace gelenk::testing

#endif  // GELENK_TESTS_CORE_IMPORT_URDF_ORACLE_H_
