# What `cmake --install` installs, beside the libraries (RigwireBuild.cmake) and the programs. Its
# components: library, program (rigwire, its manual page, the field programs and the configurations),
# bench (rigwire-bench), system (what only a system's package brings).
include(CMakePackageConfigHelpers)

set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/rigwire)
set(configs_folder ${CMAKE_INSTALL_DATADIR}/rigwire/configs)
set(package_files ${PROJECT_BINARY_DIR}/rigwire-config.cmake
  ${PROJECT_BINARY_DIR}/rigwire-config-version.cmake)

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
    COMPONENT ${component} USE_SOURCE_PERMISSIONS PATTERN "*.py" EXCLUDE)
  install(FILES ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_SOURCE_DIR}/NOTICE
    ${PROJECT_SOURCE_DIR}/CHANGELOG.md
    DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT ${component})
endforeach()

# The pages that `rigwire describe` names; without their pictures.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs/ DESTINATION ${CMAKE_INSTALL_DATADIR}/rigwire/docs
  COMPONENT program FILES_MATCHING PATTERN "*.md" PATTERN "pictures" EXCLUDE)

install(FILES ${PROJECT_BINARY_DIR}/rigwire.1.gz DESTINATION ${CMAKE_INSTALL_MANDIR}/man1
  COMPONENT program)

install(FILES ${PROJECT_SOURCE_DIR}/packaging/rigwire@.service DESTINATION lib/systemd/user
  COMPONENT system)
install(FILES ${PROJECT_SOURCE_DIR}/packaging/70-rigwire.rules DESTINATION lib/udev/rules.d
  COMPONENT system)
install(FILES ${PROJECT_SOURCE_DIR}/NOTICE DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME copyright
  COMPONENT system)

# `cpack --config build/CPackConfig.cmake` makes the Debian package of program and system.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "Rigwire <rigwire@localhost>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL program system)
set(CPACK_COMPONENTS_GROUPING ALL_COMPONENTS_IN_ONE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_NAME rigwire)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS proj-data)
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "can-utils, usbip, parallel, slurm-client")
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION "An excavator, a truck, a roller and a utility vehicle with their \
sensors and actuators on serial lines, UDP, CAN, Modbus, GigE Vision and USB. A machine's control \
software runs against them unmodified.")
include(CPack)
