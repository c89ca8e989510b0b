# gelenk_test(<name> SOURCES <file>... LIBS <target>...
#             [LABELS <label>...] [TIMEOUT <seconds>] [DEFINES <macro>...])
#
# One GoogleTest executable, one ctest entry of the same name. Without LABELS it
# is a `unit` test; TIMEOUT is 120 s unless told. Headers of the tree are
# included from its root ("tests/testing/random_pose.h").
#
# Labels in use: unit, integration, architecture, concurrent (also run under
# ThreadSanitizer), fuzz (readers on broken input), soak (only with `./dev soak`),
# corpus (on files that are not part of the project; skipped where they are not
# found). The target LABEL_tests builds the tests of one label and what they need.
#
# GELENK_TEST_PRECOMPILED is the target whose precompiled headers the tests of a
# folder reuse.
find_package(GTest CONFIG REQUIRED)

# What tests exercise is in the libraries, and optimised; themselves they are to
# compile fast.
function(gelenk_compile_fast target)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
endfunction()

function(gelenk_test name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "TIMEOUT"
                        "SOURCES;LIBS;LABELS;DEFINES")
  if(arg_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "gelenk_test(${name}): ${arg_UNPARSED_ARGUMENTS}?")
  endif()
  if(NOT arg_LABELS)
    set(arg_LABELS unit)
  endif()
  if(NOT arg_TIMEOUT)
    set(arg_TIMEOUT 120)
  endif()

  add_executable(${name} ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE ${arg_LIBS} GTest::gtest_main
                                        GTest::gmock)
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR})
  target_compile_definitions(${name} PRIVATE ${arg_DEFINES})
  gelenk_compile_fast(${name})
  gelenk_reuse_precompiled(${name} "${GELENK_TEST_PRECOMPILED}")
  gelenk_warnings(${name})
  add_test(NAME ${name} COMMAND ${name})
  gelenk_label_test(${name} ${name} "${arg_LABELS}" ${arg_TIMEOUT})
endfunction()

# gelenk_label_test(<test> <target> <labels> <seconds>): labels and time limit of
# a test that runs the executable <target>.
function(gelenk_label_test test target labels timeout)
  set_tests_properties(${test} PROPERTIES LABELS "${labels}"
                                          TIMEOUT ${timeout})
  foreach(label IN LISTS labels)
    if(NOT TARGET ${label}_tests)
      add_custom_target(${label}_tests)
    endif()
    add_dependencies(${label}_tests ${target})
  endforeach()
endfunction()
