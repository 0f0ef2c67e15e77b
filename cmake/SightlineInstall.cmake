# Installs the program, the static library with its headers, and what find_package(sightline) and
# pkg-config need. Everything is relative to the prefix, so `cmake --install --prefix` may choose it.
include(CMakePackageConfigHelpers)

set(SIGHTLINE_CMAKE_DIR "${CMAKE_INSTALL_LIBDIR}/cmake/sightline")

install(TARGETS sightline EXPORT sightlineTargets ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}")
install(EXPORT sightlineTargets NAMESPACE sightline:: DESTINATION "${SIGHTLINE_CMAKE_DIR}")
install(DIRECTORY "${PROJECT_SOURCE_DIR}/include/sightline" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}"
        FILES_MATCHING PATTERN "*.hpp")

install(FILES LICENSE README.md CHANGELOG.md DESTINATION "${CMAKE_INSTALL_DOCDIR}")
install(DIRECTORY docs/ DESTINATION "${CMAKE_INSTALL_DOCDIR}/docs")
install(DIRECTORY samples/ DESTINATION "${CMAKE_INSTALL_DATADIR}/sightline/samples")

configure_package_config_file(
  "${CMAKE_CURRENT_LIST_DIR}/sightlineConfig.cmake.in" "${PROJECT_BINARY_DIR}/sightlineConfig.cmake"
  INSTALL_DESTINATION "${SIGHTLINE_CMAKE_DIR}")
# Until 1.0 a new minor version may break a caller.
write_basic_package_version_file("${PROJECT_BINARY_DIR}/sightlineConfigVersion.cmake"
  COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/sightlineConfig.cmake"
              "${PROJECT_BINARY_DIR}/sightlineConfigVersion.cmake"
        DESTINATION "${SIGHTLINE_CMAKE_DIR}")

# From the folder of sightline.pc up to the prefix, whatever CMAKE_INSTALL_LIBDIR is.
file(RELATIVE_PATH SIGHTLINE_PC_TO_PREFIX "/${CMAKE_INSTALL_LIBDIR}/pkgconfig" "/")
configure_file("${CMAKE_CURRENT_LIST_DIR}/sightline.pc.in" "${PROJECT_BINARY_DIR}/sightline.pc"
               @ONLY)
install(FILES "${PROJECT_BINARY_DIR}/sightline.pc"
        DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig")
