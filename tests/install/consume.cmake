# cmake -DFROM=package|folder|fetch_content -DBUILD=... -DSOURCE=... -DVERSION=... -P: configures, builds and runs a
# project of a user (CMakeLists.txt beside this file) that gets chronormal in the way that FROM names. For `package`,
# chronormal is first installed from BUILD into a separate folder.
cmake_minimum_required(VERSION 3.22)  # without policies, "folder" below would mean the variable of that name
set(folder ${BUILD}/consume_${FROM})
file(REMOVE_RECURSE ${folder})
function(run)
  execute_process(COMMAND ${ARGN} WORKING_DIRECTORY ${folder} RESULT_VARIABLE result OUTPUT_VARIABLE output
                  ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "${ARGN}\n${output}")
  endif()
  message(STATUS "${output}")
endfunction()
file(MAKE_DIRECTORY ${folder})

set(options -DFROM=${FROM} -DSOURCE=${SOURCE} -DVERSION=${VERSION} -DCMAKE_CXX_COMPILER=${COMPILER})
set(programs core)
set(project ${SOURCE}/tests/install)
if(FROM STREQUAL "package")
  run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${folder}/prefix)
  # Moves the installed files to another folder, to check that they do not depend on the path of the first folder.
  file(RENAME ${folder}/prefix ${folder}/moved)
  list(APPEND options -DCMAKE_PREFIX_PATH=${folder}/moved)
  list(APPEND programs engine core_by_pkg_config engine_by_pkg_config c_by_pkg_config c_by_component)
elseif(FROM STREQUAL "folder")
  # Makes the project that docs/cpp.md shows, which includes this repository as a folder.
  set(project ${folder}/project)
  set(programs first_steps)
  file(READ ${SOURCE}/docs/cpp.md page)
  string(REGEX MATCH "```cmake\n([^`]*)```" block "${page}")
  file(WRITE ${project}/CMakeLists.txt "${CMAKE_MATCH_1}")
  file(COPY ${SOURCE}/examples/first_steps.cpp DESTINATION ${project})
  file(CREATE_LINK ${SOURCE} ${project}/chronormal SYMBOLIC)
  foreach(package ZLIB pugixml nlohmann_json meshoptimizer draco CLI11 fmt hwy)  # packages that count as not installed
    list(APPEND options -DCMAKE_DISABLE_FIND_PACKAGE_${package}=ON)
  endforeach()
else()
  list(APPEND programs engine)
endif()
run(${CMAKE_COMMAND} -G ${GENERATOR} -S ${project} -B ${folder}/build ${options})
run(${CMAKE_COMMAND} --build ${folder}/build --parallel 2)
foreach(program ${programs})
  run(${folder}/build/${program})
endforeach()
if(FROM STREQUAL "package")
  run(${folder}/moved/bin/chronormal --version)
endif()
