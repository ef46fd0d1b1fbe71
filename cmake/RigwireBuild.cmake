# Compiler settings and the two functions with which every folder declares itself.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release)
endif()
# -O3 stands where `rigwire bench` shows that it pays (RIGWIRE_INNER_LOOPS); elsewhere it costs a fifth
# of the build.
set(CMAKE_CXX_FLAGS_RELEASE "-O2 -DNDEBUG")
set(RIGWIRE_INNER_LOOPS $<$<CONFIG:Release>:-O3>)

# Two thirds of a build is reading headers. Files of a folder that are compiled together read them once;
# their names in anonymous namespaces must differ. clang-tidy reads each file alone, so that it finds
# a missing include.
option(RIGWIRE_UNITY "Compile the files of a folder together, some ten at a time" ON)
if(RIGWIRE_UNITY AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # GCC collects garbage from 1.5 GB on: a group takes a tenth less time, and scripts/build.sh starts no
  # more than memory allows.
  add_compile_options(--param=ggc-min-expand=400 --param=ggc-min-heapsize=1500000)
endif()

find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM)
  # The place of the tree is left out of what is compared: every clone on a machine builds from what
  # another has built.
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_BASEDIR=${PROJECT_SOURCE_DIR}
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
  # A type of an anonymous namespace in a member is right in a source, also where others include it.
  list(APPEND RIGWIRE_WARNINGS -Wno-subobject-linkage)
  if(NOT RIGWIRE_SANITIZE)
    list(APPEND RIGWIRE_WARNINGS -Werror)  # the sanitizers' own checks make false alarms
  endif()
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

# rigwire_compile_together(<target> [BY_FOLDER] [BYTES <count>]): puts the target's sources into groups that are
# compiled as one, in the order of their paths. A group ends where a folder does once it is half full;
# BY_FOLDER: in any case. BYTES: how large a group may be; larger where headers cost more than the
# sources. Sources with options of their own, or with SKIP_UNITY_BUILD_INCLUSION, are
# compiled alone.
set(RIGWIRE_UNITY_BYTES 100000)
function(rigwire_compile_together target)
  cmake_parse_arguments(ARG "BY_FOLDER" "BYTES" "" ${ARGN})
  if(NOT RIGWIRE_UNITY)
    return()
  endif()
  set(most ${RIGWIRE_UNITY_BYTES})
  if(ARG_BYTES)
    set(most ${ARG_BYTES})
  endif()
  get_target_property(sources ${target} SOURCES)
  list(FILTER sources INCLUDE REGEX "\\.cpp$")
  list(SORT sources)
  math(EXPR half "${most} / 2")
  if(ARG_BY_FOLDER)
    set(half 0)
  endif()
  set(group 0)
  set(bytes 0)
  set(folder "")
  foreach(source ${sources})
    get_filename_component(path ${source} ABSOLUTE)
    get_filename_component(own_folder ${path} DIRECTORY)
    file(SIZE ${path} size)
    math(EXPR filled "${bytes} + ${size}")
    if(filled GREATER most OR (bytes GREATER half AND NOT own_folder STREQUAL folder))
      math(EXPR group "${group} + 1")
      set(filled ${size})
    endif()
    set(bytes ${filled})
    set(folder ${own_folder})
    set_property(SOURCE ${source} PROPERTY UNITY_GROUP ${group})
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
endfunction()

# rigwire_library(<folder> [INTERNAL] [BY_FOLDER] [BYTES <count>] SOURCES <files> [PUBLIC <targets>] [PRIVATE <targets>])
#
# Declares one folder of the tree as the static library rigwire_<folder> with the alias
# rigwire::<folder>. Its headers are reachable as "<folder>/name.h", and only by targets that link
# it: the include directory is a link of its own per folder, so that an include against the design
# (docs/architecture.md, "Folders") does not compile.
#
# It is installed with its headers, as a component of the package rigwire (cmake/package.cmake);
# INTERNAL: it is not. BY_FOLDER, BYTES: as of rigwire_compile_together.
function(rigwire_library folder)
  cmake_parse_arguments(ARG "INTERNAL;BY_FOLDER" "BYTES" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
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
  set(grouping "")
  if(ARG_BYTES)
    set(grouping BYTES ${ARG_BYTES})
  endif()
  if(ARG_BY_FOLDER)
    list(APPEND grouping BY_FOLDER)
  endif()
  rigwire_compile_together(rigwire_${name} ${grouping})
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

# A test of ctest that computes takes a processor: so many places of `ctest -j`. One that waits for
# other programs or for the clock takes one place. ./check gives as many places for each processor.
set(RIGWIRE_PLACES 3)
if(RIGWIRE_SANITIZE)
  set(RIGWIRE_PLACES 1)  # there a live test computes, too
endif()

# rigwire_test(<folder> [EACH] [QUICK] [WAITS] [LINK <targets>] [SOURCES <files>])
#
# One GoogleTest program per folder of the house, <folder>_tests, from every tests/<folder>/**.cpp and
# SOURCES. ctest runs each suite in a process; with EACH, or where the environment has
# RIGWIRE_EACH_TEST, each test (tests/support/list_tests.py). QUICK: they belong to ./check --quick.
# WAITS: they mostly wait, so that several run for each processor.
function(rigwire_test folder)
  cmake_parse_arguments(ARG "EACH;QUICK;WAITS" "" "LINK;SOURCES" ${ARGN})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cpp)
  if(NOT sources)
    return()
  endif()
  # The place of the tree is told only where it is used: objects that do not know it are shared by
  # all trees of a cache.
  set(place RIGWIRE_SOURCE_DIR="${PROJECT_SOURCE_DIR}" RIGWIRE_BINARY_DIR="${PROJECT_BINARY_DIR}")
  file(GLOB_RECURSE headers CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.h)
  set(placed "")
  foreach(file ${sources} ${headers})
    file(STRINGS ${file} uses REGEX "RIGWIRE_(SOURCE|BINARY)_DIR" LIMIT_COUNT 1)
    if(uses AND file MATCHES "\\.h$")
      set(placed ${sources})
    elseif(uses)
      list(APPEND placed ${file})
    endif()
  endforeach()
  list(REMOVE_DUPLICATES placed)
  list(REMOVE_ITEM sources ${placed})

  add_executable(${folder}_tests ${sources} ${ARG_SOURCES})
  set(parts ${folder}_tests)
  if(placed)
    add_library(${folder}_placed_tests OBJECT ${placed})
    target_compile_definitions(${folder}_placed_tests PRIVATE ${place})
    target_sources(${folder}_tests PRIVATE $<TARGET_OBJECTS:${folder}_placed_tests>)
    list(APPEND parts ${folder}_placed_tests)
  endif()
  foreach(part ${parts})
    # The tests' own code is run once: a quarter of its build time is worth more than its speed.
    target_compile_options(${part} PRIVATE ${RIGWIRE_WARNINGS}
      $<$<CONFIG:Release>:-O1> $<$<CONFIG:RelWithDebInfo>:-O0>)
    target_include_directories(${part} PRIVATE ${PROJECT_SOURCE_DIR}/tests/support)
    target_link_libraries(${part} PRIVATE ${ARG_LINK} GTest::gmock_main)
    rigwire_compile_together(${part})
  endforeach()

  set(test_seconds 300)
  if(RIGWIRE_SANITIZE)
    set(test_seconds 1200)  # every access is looked at
  endif()
  set(scheduled PROCESSORS=${RIGWIRE_PLACES})
  if(ARG_WAITS)
    set(scheduled PROCESSORS=1)
  endif()
  rigwire_list_tests(${folder}_tests $<$<BOOL:${ARG_EACH}>:--each> TIMEOUT=${test_seconds}
    ${scheduled} LABELS=${folder}$<$<BOOL:${ARG_QUICK}>:,quick>)
endfunction()

# rigwire_list_tests(<program> [--each] <name>=<value>[,<value>...]...): gives the program's tests to
# ctest, with these properties.
function(rigwire_list_tests program)
  set(listed ${CMAKE_CURRENT_BINARY_DIR}/${program}_listed.cmake)
  add_custom_command(TARGET ${program} POST_BUILD VERBATIM COMMAND_EXPAND_LISTS
    COMMAND ${PROJECT_SOURCE_DIR}/tests/support/list_tests.py $<TARGET_FILE:${program}> ${listed} ${ARGN})
  set(included ${CMAKE_CURRENT_BINARY_DIR}/${program}_included.cmake)
  file(WRITE ${included} "if(EXISTS \"${listed}\")\n  include(\"${listed}\")\nelse()\n"
    "  add_test(${program}_NOT_BUILT ${program}_NOT_BUILT)\nendif()\n")
  set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${included})
endfunction()
