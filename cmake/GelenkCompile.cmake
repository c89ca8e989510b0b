# How every target of the project is compiled.
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Build type" FORCE)
endif()
set(CMAKE_CXX_FLAGS_RELEASE "-O3 -DNDEBUG")

set(GELENK_SANITIZE "" CACHE STRING
    "Sanitizers, as given to -fsanitize (address,undefined or thread)")
if(GELENK_SANITIZE)
  add_compile_options(-fsanitize=${GELENK_SANITIZE} -fno-omit-frame-pointer -g1)
  add_link_options(-fsanitize=${GELENK_SANITIZE})
  if(GELENK_SANITIZE MATCHES "undefined")
    add_compile_options(-fno-sanitize-recover=undefined)
  endif()
endif()

# Compiler cache when there is one; never needed.
find_program(GELENK_CCACHE ccache)
if(GELENK_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${GELENK_CCACHE})
endif()

# Warnings are for our own code; generated code does not get them.
function(gelenk_warnings target)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wnon-virtual-dtor
                         -Woverloaded-virtual -Wno-psabi)
endfunction()

# Headers of other libraries, and those of the contract, that most files of a
# room read are compiled once: `target_precompile_headers`, and this for targets
# that read the same. Never a header of our own: one change would compile
# everything again. Files still include what they use, which clang-tidy sees, and
# -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON builds without.
function(gelenk_reuse_precompiled target owner)
  if(TARGET ${owner})
    target_precompile_headers(${target} REUSE_FROM ${owner})
  endif()
endfunction()

set(GELENK_CORE_HEADERS
  <algorithm> <array> <cmath> <cstdint> <functional> <limits> <memory> <numbers>
  <optional> <string> <utility> <variant> <vector>
  <Eigen/Core> <Eigen/Geometry> <Eigen/LU>
  <absl/container/flat_hash_map.h> <absl/status/status.h>
  <absl/status/statusor.h> <absl/strings/match.h> <absl/strings/str_cat.h>
  <absl/strings/str_format.h> <absl/strings/string_view.h> <absl/time/time.h>
  <absl/types/span.h>)
set(GELENK_SERVICE_HEADERS ${GELENK_CORE_HEADERS}
  <grpcpp/grpcpp.h>
  <gelenk/v1/kinematics_service.grpc.pb.h> <gelenk/v1/motion_service.grpc.pb.h>
  <gelenk/v1/session_service.grpc.pb.h> <gelenk/v1/skin_service.grpc.pb.h>)
set(GELENK_TEST_HEADERS <gmock/gmock.h> <gtest/gtest.h>)
