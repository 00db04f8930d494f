# Install and export: find_package(batten) gives batten::batten, and batten::cad (component cad) where STEP and IGES were built.
include(CMakePackageConfigHelpers)

install(TARGETS batten_library EXPORT batten-targets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(TARGETS batten_command RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/src/batten DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING PATTERN "*.hpp")
install(EXPORT batten-targets NAMESPACE batten:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/batten)
if(BATTEN_CAD)
  install(TARGETS batten_cad EXPORT batten-cad-targets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
  install(TARGETS batten_cad_program RUNTIME DESTINATION ${CMAKE_INSTALL_LIBEXECDIR})
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/cad/include/batten DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
  install(EXPORT batten-cad-targets NAMESPACE batten:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/batten)
endif()
configure_package_config_file(cmake/batten-config.cmake.in ${CMAKE_BINARY_DIR}/batten-config.cmake
                              INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/batten)
write_basic_package_version_file(${CMAKE_BINARY_DIR}/batten-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/batten-config.cmake ${CMAKE_BINARY_DIR}/batten-config-version.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/batten)
