# What `cmake --install` installs, beside the libraries (RigwireBuild.cmake) and the programs. Its
# components: library, program (rigwire and the configurations), bench (rigwire-bench).
include(CMakePackageConfigHelpers)

set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/rigwire)
set(configs_folder ${CMAKE_INSTALL_DATADIR}/rigwire/configs)
set(package_files ${PROJECT_BINARY_DIR}/rigwire-config.cmake
  ${PROJECT_BINARY_DIR}/rigwire-config-version.cmake
  ${CMAKE_CURRENT_LIST_DIR}/FindOpenCVStereo.cmake)

configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/rigwire-config.cmake.in
  ${PROJECT_BINARY_DIR}/rigwire-config.cmake
  INSTALL_DESTINATION ${package_folder} PATH_VARS configs_folder)
# As long as the version is 0.x each minor one may change what a program sees, so that none serves in
# place of another. From 1.0 on this is to be SameMajorVersion.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/rigwire-config-version.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${package_files} DESTINATION ${package_folder} COMPONENT library)

# Library and program both read them; they are one set of files.
foreach(component library program)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/configs/ DESTINATION ${configs_folder}
    COMPONENT ${component} PATTERN "*.py" EXCLUDE)
  install(FILES ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_SOURCE_DIR}/NOTICE
    ${PROJECT_SOURCE_DIR}/CHANGELOG.md
    DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT ${component})
endforeach()
