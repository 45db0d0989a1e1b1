# `cmake --install`: libraries, headers, the program, and what find_package(chronormal) needs.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/chronormal)
install(TARGETS chronormal chronormal_io EXPORT chronormalTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(TARGETS chronormal_cli RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/chronormal DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(EXPORT chronormalTargets NAMESPACE chronormal:: DESTINATION ${package_folder})
file(WRITE ${PROJECT_BINARY_DIR}/chronormalConfig.cmake
"include(CMakeFindDependencyMacro)
if(${TBB_FOUND})  # whether the library was built over oneTBB
  find_dependency(TBB)
endif()
find_dependency(hwy)
find_dependency(ZLIB)
find_dependency(pugixml)
find_dependency(meshoptimizer)
find_dependency(draco)
include(\${CMAKE_CURRENT_LIST_DIR}/chronormalTargets.cmake)
")
write_basic_package_version_file(${PROJECT_BINARY_DIR}/chronormalConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/chronormalConfig.cmake ${PROJECT_BINARY_DIR}/chronormalConfigVersion.cmake
        DESTINATION ${package_folder})
