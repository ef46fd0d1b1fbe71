# Compiler settings and the two functions with which every folder declares itself.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release)
endif()

# Two thirds of a build is reading headers of others. It is for those who build once: GCC 12 loses
# which of its warnings are about system headers, and a missing include is not found.
option(RIGWIRE_PRECOMPILE "Read headers of others once, without a warning about anything" OFF)

find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM)
  # The sloppiness is what ccache's manual asks for with precompiled headers. The place of the tree
  # is left out of what is compared: every clone on a machine builds from what another has built.
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env
    CCACHE_SLOPPINESS=pch_defines,time_macros CCACHE_BASEDIR=${PROJECT_SOURCE_DIR}
    CCACHE_NOHASHDIR=yes ${CCACHE_PROGRAM})
endif()

set(RIGWIRE_SANITIZE "" CACHE STRING "Sanitizers to build with, for example address,undefined")
if(RIGWIRE_SANITIZE)
  add_compile_options(-fsanitize=${RIGWIRE_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  add_link_options(-fsanitize=${RIGWIRE_SANITIZE})
endif()

# The fuzzers see into the libraries, and assertions are what they look for.
if(RIGWIRE_FUZZ)
  add_compile_options(-fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=all
    -fno-omit-frame-pointer -UNDEBUG)
  add_link_options(-fsanitize=address,undefined)
endif()

# GCC decides what is a warning; clang, which only builds the fuzz targets, may show its own.
set(RIGWIRE_WARNINGS -Wall -Wextra -Wpedantic -Wconversion -Wshadow)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  list(APPEND RIGWIRE_WARNINGS -Werror)
  if(CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    list(APPEND RIGWIRE_WARNINGS -Wno-restrict)  # false alarms in std::string (GCC bug 105651)
  endif()
endif()
if(RIGWIRE_SANITIZE)
  list(APPEND RIGWIRE_WARNINGS -Wno-maybe-uninitialized)  # false alarms under the sanitizers' checks
endif()
if(RIGWIRE_SANITIZE MATCHES thread)
  list(APPEND RIGWIRE_WARNINGS -Wno-tsan)  # Asio's thread fences, which the sanitizer cannot see
endif()

include(GNUInstallDirs)

# rigwire_precompile(<target> [<header>...]): the standard library's common headers and the named
# ones of others, none of ours: a change of ours compiles what includes it. The targets that name
# none share what rigwire_fields, the first of them, has made.
function(rigwire_precompile target)
  if(NOT RIGWIRE_PRECOMPILE)
    return()
  endif()
  if(ARGN OR target STREQUAL rigwire_fields)
    target_precompile_headers(${target} PRIVATE <algorithm> <array> <chrono> <cmath> <functional>
      <map> <memory> <optional> <ranges> <span> <string> <string_view> <variant> <vector> ${ARGN})
  else()
    target_precompile_headers(${target} REUSE_FROM rigwire_fields)
  endif()
  target_compile_options(${target} PRIVATE -w)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(${target} PRIVATE -fpch-preprocess)  # ccache asks for it
  endif()
endfunction()

# rigwire_library(<folder> [INTERNAL] SOURCES <files> [PUBLIC <targets>] [PRIVATE <targets>]
#                 [PRECOMPILE <headers of others>])
#
# Declares one folder of the house as the static library rigwire_<folder> with the alias
# rigwire::<folder>. Its headers are reachable as "<folder>/name.h", and only by targets that link
# it: the include directory is a link of its own per folder, so that an include against the design
# (docs/architecture.md, "One way through the house") does not compile.
#
# It is installed with its headers, as a component of the package rigwire (cmake/package.cmake);
# INTERNAL: it is not.
function(rigwire_library folder)
  cmake_parse_arguments(ARG "INTERNAL" "" "SOURCES;PUBLIC;PRIVATE;PRECOMPILE" ${ARGN})
  string(REPLACE "/" "_" name ${folder})
  set(include_root ${PROJECT_BINARY_DIR}/include/${name})
  get_filename_component(parent ${include_root}/${folder} DIRECTORY)
  file(MAKE_DIRECTORY ${parent})
  file(CREATE_LINK ${PROJECT_SOURCE_DIR}/${folder} ${include_root}/${folder} SYMBOLIC)

  add_library(rigwire_${name} STATIC ${ARG_SOURCES})
  get_filename_component(leaf ${folder} NAME)
  add_library(rigwire::${leaf} ALIAS rigwire_${name})
  target_include_directories(rigwire_${name} PUBLIC
    $<BUILD_INTERFACE:${include_root}> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/rigwire>)
  target_compile_features(rigwire_${name} PUBLIC cxx_std_20)
  target_compile_options(rigwire_${name} PRIVATE ${RIGWIRE_WARNINGS})
  target_link_libraries(rigwire_${name} PUBLIC ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE})
  rigwire_precompile(rigwire_${name} ${ARG_PRECOMPILE})
  if(NOT ARG_INTERNAL)
    set_target_properties(rigwire_${name} PROPERTIES EXPORT_NAME ${leaf})
    install(TARGETS rigwire_${name} EXPORT rigwire-${leaf} COMPONENT library
      ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
    install(DIRECTORY ${PROJECT_SOURCE_DIR}/${folder}/ COMPONENT library
      DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/rigwire/${folder} FILES_MATCHING PATTERN "*.h")
    install(EXPORT rigwire-${leaf} NAMESPACE rigwire:: COMPONENT library
      DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/rigwire)
  endif()
endfunction()

# rigwire_test(<folder> [ALONE] [LINK <targets>])
#
# One GoogleTest program per folder of the house, <folder>_tests, from every tests/<folder>/**_test.cpp.
# ALONE: each of its tests has both of ./check's processors, because it runs in real time.
function(rigwire_test folder)
  cmake_parse_arguments(ARG "ALONE" "" "LINK" ${ARGN})
  set(processors 1)
  if(ARG_ALONE)
    set(processors 2)
  endif()
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cpp)
  if(NOT sources)
    return()
  endif()
  add_executable(${folder}_tests ${sources})
  # The tests' own code is run once: a quarter of its build time is worth more than its speed.
  target_compile_options(${folder}_tests PRIVATE ${RIGWIRE_WARNINGS}
    $<$<CONFIG:Release>:-O1> $<$<CONFIG:RelWithDebInfo>:-O0>)
  target_include_directories(${folder}_tests PRIVATE ${PROJECT_SOURCE_DIR}/tests/support)
  # Only where it is used: objects that do not know their place are shared by all trees of a cache.
  set(place RIGWIRE_SOURCE_DIR="${PROJECT_SOURCE_DIR}" RIGWIRE_BINARY_DIR="${PROJECT_BINARY_DIR}")
  file(GLOB_RECURSE headers CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.h)
  foreach(file ${sources} ${headers})
    file(STRINGS ${file} uses REGEX "RIGWIRE_(SOURCE|BINARY)_DIR" LIMIT_COUNT 1)
    if(uses AND file MATCHES "\\.h$")
      target_compile_definitions(${folder}_tests PRIVATE ${place})
    elseif(uses)
      set_property(SOURCE ${file} APPEND PROPERTY COMPILE_DEFINITIONS ${place})
    endif()
  endforeach()
  target_link_libraries(${folder}_tests PRIVATE ${ARG_LINK} GTest::gmock_main)
  set(test_seconds 300)
  if(RIGWIRE_SANITIZE)
    set(test_seconds 1200)  # every access is looked at
  endif()
  gtest_discover_tests(${folder}_tests DISCOVERY_TIMEOUT 60 NO_PRETTY_VALUES PROPERTIES TIMEOUT ${test_seconds}
    LABELS ${folder}
    PROCESSORS ${processors})
endfunction()
