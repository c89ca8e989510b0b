include(CMakeFindDependencyMacro)
find_dependency(Eigen3 3.4 NO_MODULE)
find_dependency(absl)
include("${CMAKE_CURRENT_LIST_DIR}/gelenk_core-targets.cmake")
