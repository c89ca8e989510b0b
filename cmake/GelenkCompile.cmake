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
