# `cmake --install` installs the libraries and the program as far as they were built, the headers, and the files that
# find_package(chronormal) and pkg-config need. The package has the component `io` if chronormal_io was built, and `c`
# if chronormal_c was built.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/chronormal)
set(config_folder ${PROJECT_BINARY_DIR}/package)
set(pkg_config_folder ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
# The path from the folder of the .pc files to the prefix. A relative path lets users move an installed package.
file(RELATIVE_PATH prefix_from_pkg_config /${pkg_config_folder} /)

# chronormal_install_pkg_config(TARGET REQUIRES LIBS): installs the file that describes a library to pkg-config.
function(chronormal_install_pkg_config target requires libraries)
  # A program that links a static library must also link the libraries that the static library needs. Therefore the
  # needed libraries are in Requires and not in Requires.private.
  file(CONFIGURE OUTPUT ${config_folder}/${target}.pc CONTENT
"prefix=\${pcfiledir}/@prefix_from_pkg_config@
libdir=\${prefix}/@CMAKE_INSTALL_LIBDIR@
includedir=\${prefix}/@CMAKE_INSTALL_INCLUDEDIR@

Name: @target@
Description: @PROJECT_DESCRIPTION@
Version: @PROJECT_VERSION@
Requires: @requires@
Cflags: -I\${includedir}
Libs: -L\${libdir} -l@target@@libraries@
" @ONLY)
  install(FILES ${config_folder}/${target}.pc DESTINATION ${pkg_config_folder})
endfunction()

# chronormal_install_library(TARGET PKG_CONFIG_REQUIRES PKG_CONFIG_LIBS): installs a library and its description for
# pkg-config.
function(chronormal_install_library target requires libraries)
  install(TARGETS ${target} EXPORT ${target}Targets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
  install(EXPORT ${target}Targets NAMESPACE chronormal:: DESTINATION ${package_folder})
  chronormal_install_pkg_config(${target} "${requires}" "${libraries}")
endfunction()

set(core_requires "")
if(CHRONORMAL_HIGHWAY)
  set(core_requires libhwy)
endif()
set(core_libraries "")
if(CMAKE_THREAD_LIBS_INIT)
  set(core_libraries " ${CMAKE_THREAD_LIBS_INIT}")
endif()
chronormal_install_library(chronormal "${core_requires}" "${core_libraries}")
if(CHRONORMAL_IO)
  chronormal_install_library(chronormal_io "chronormal zlib pugixml draco" " -lmeshoptimizer")
endif()
if(CHRONORMAL_C)
  install(TARGETS chronormal_c EXPORT chronormal_cTargets LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
  install(EXPORT chronormal_cTargets NAMESPACE chronormal:: DESTINATION ${package_folder})
  install(FILES ${PROJECT_SOURCE_DIR}/include/chronormal_c.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
  chronormal_install_pkg_config(chronormal_c "" "")
endif()
if(CHRONORMAL_PROGRAM)
  install(TARGETS chronormal_cli RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
  # The program writes its own manual page and completions.
  set(written ${PROJECT_BINARY_DIR}/share)
  set(program $<TARGET_FILE:chronormal_cli>)
  file(MAKE_DIRECTORY ${written})
  add_custom_command(
    TARGET chronormal_cli POST_BUILD
    COMMAND ${program} --manual-page > ${written}/chronormal.1
    COMMAND ${program} --completions bash > ${written}/chronormal
    COMMAND ${program} --completions zsh > ${written}/_chronormal
    COMMAND ${program} --completions fish > ${written}/chronormal.fish
    VERBATIM)
  install(FILES ${written}/chronormal.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
  install(FILES ${written}/chronormal DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
  install(FILES ${written}/_chronormal DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions)
  install(FILES ${written}/chronormal.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d)
  # Installs the page of reports, if ./run report has built the page. The page lies in a folder beside all builds, where
  # the programs in these builds look for it.
  install(FILES ${PROJECT_BINARY_DIR}/../share/chronormal/report.html DESTINATION ${CMAKE_INSTALL_DATADIR}/chronormal
          OPTIONAL)
endif()
install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/chronormal DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME copyright)
install(FILES ${PROJECT_SOURCE_DIR}/CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DOCDIR})

file(CONFIGURE OUTPUT ${config_folder}/chronormalConfig.cmake CONTENT
"include(CMakeFindDependencyMacro)

# The component c is a shared library that needs neither the other components nor their dependencies.
set(chronormal_c_file \${CMAKE_CURRENT_LIST_DIR}/chronormal_cTargets.cmake)
if(EXISTS \${chronormal_c_file} AND (NOT chronormal_FIND_COMPONENTS OR \"c\" IN_LIST chronormal_FIND_COMPONENTS))
  include(\${chronormal_c_file})
  set(chronormal_c_FOUND TRUE)
endif()

# The component core is loaded unless c alone was requested.
if(NOT \"\${chronormal_FIND_COMPONENTS}\" STREQUAL \"c\")
  if(\"@CHRONORMAL_HIGHWAY@\")  # true if the library was built with Google Highway
    find_dependency(hwy)
  endif()
  find_dependency(Threads)
  include(\${CMAKE_CURRENT_LIST_DIR}/chronormalTargets.cmake)
  set(chronormal_core_FOUND TRUE)
endif()

# The component io is loaded if it is installed and no other component alone was requested.
set(chronormal_io_file \${CMAKE_CURRENT_LIST_DIR}/chronormal_ioTargets.cmake)
if(EXISTS \${chronormal_io_file} AND (NOT chronormal_FIND_COMPONENTS OR \"io\" IN_LIST chronormal_FIND_COMPONENTS))
  find_dependency(ZLIB)
  find_dependency(pugixml)
  find_dependency(meshoptimizer)
  find_dependency(draco)
  include(\${chronormal_io_file})
  set(chronormal_io_FOUND TRUE)
endif()
foreach(component \${chronormal_FIND_COMPONENTS})
  if(chronormal_FIND_REQUIRED_\${component} AND NOT chronormal_\${component}_FOUND)
    set(chronormal_FOUND FALSE)
    set(chronormal_NOT_FOUND_MESSAGE \"chronormal has no component \${component} here; there are core and, with CHRONORMAL_IO, io, and with CHRONORMAL_C, c\")
  endif()
endforeach()
" @ONLY)
write_basic_package_version_file(${config_folder}/chronormalConfigVersion.cmake VERSION ${PROJECT_VERSION} COMPATIBILITY SameMinorVersion)
install(FILES ${config_folder}/chronormalConfig.cmake ${config_folder}/chronormalConfigVersion.cmake
        DESTINATION ${package_folder})

# `cpack` in the build folder makes a Debian package of the whole product, which depends on the shared libraries in use.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME chronormal)
set(CPACK_PACKAGE_CONTACT "the authors of chronormal <chronormal@users.noreply.github.com>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "libhwy-dev, zlib1g-dev, libpugixml-dev, libmeshoptimizer-dev, libdraco-dev")
include(CPack)
