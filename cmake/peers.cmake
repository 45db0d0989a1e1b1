# Finds the libraries with which the benchmarks compare chronormal. ./run bench installs and uses these libraries.
find_package(OpenMesh QUIET)
find_package(VTK QUIET COMPONENTS CommonCore CommonDataModel FiltersCore FiltersModeling)
# CGAL complains about build types other than Release, unless this setting is on.
set(CGAL_DO_NOT_WARN_ABOUT_CMAKE_BUILD_TYPE TRUE)
find_package(CGAL QUIET)
if(NOT TARGET OpenMeshCore OR NOT VTK_FOUND OR NOT CGAL_FOUND)
  message(STATUS "OpenMesh, VTK or CGAL was not found (Debian: libopenmesh-dev, libvtk9-dev, libcgal-dev): "
                 "normals are not compared with theirs")
  return()
endif()

file(GLOB peer_sources CONFIGURE_DEPENDS bench/peers/*.cpp)
add_library(chronormal_peers STATIC ${peer_sources})
target_include_directories(chronormal_peers PUBLIC ${PROJECT_SOURCE_DIR}/bench)
# In Release, assertions are off as in the product. Otherwise OpenMesh would check every handle.
target_link_libraries(chronormal_peers PUBLIC chronormal PRIVATE chronormal_product_flags OpenMeshCore VTK::CommonCore
                                                                 VTK::CommonDataModel VTK::FiltersCore VTK::FiltersModeling
                                                                 CGAL::CGAL)
