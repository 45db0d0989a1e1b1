# cmake -DBUILD=... -DSOURCE=... -P: installs the build into a folder of its own, then configures, builds and runs a
# project that finds it there.
set(folder ${BUILD}/install_and_consume)
file(REMOVE_RECURSE ${folder})
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "${ARGN}\n${output}")
  endif()
  message(STATUS "${output}")
endfunction()
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${folder}/prefix)
run(${CMAKE_COMMAND} -G ${GENERATOR} -S ${SOURCE}/tests/install -B ${folder}/build -DCMAKE_PREFIX_PATH=${folder}/prefix
    -DEXAMPLE=${SOURCE}/examples/first_steps.cpp -DCMAKE_CXX_COMPILER=${COMPILER})
run(${CMAKE_COMMAND} --build ${folder}/build)
run(${folder}/build/consumer)
run(${folder}/prefix/bin/chronormal --version)
