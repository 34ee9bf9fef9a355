# Install rules and the exported package: find_package(kerf) gives kerf::geo.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

install(TARGETS geo EXPORT kerf-targets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(DIRECTORY libgeo/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/kerf FILES_MATCHING PATTERN "*.h")
install(EXPORT kerf-targets NAMESPACE kerf:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/kerf)
configure_package_config_file(cmake/kerf-config.cmake.in ${CMAKE_CURRENT_BINARY_DIR}/kerf-config.cmake
  INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/kerf)
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/kerf-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/kerf-config.cmake ${CMAKE_CURRENT_BINARY_DIR}/kerf-config-version.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/kerf)
install(FILES LICENSE README.md CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
