# Runs the benchmarks on tiny meshes: each of them verifies what it times, and ends the run where it is wrong.
execute_process(COMMAND ${PROGRAM} --quick --sizes 1k --filter "^(faces|vertices|schemes|blend|dense blend|uses|cones)/1k/" --json -
                OUTPUT_VARIABLE json ERROR_VARIABLE log RESULT_VARIABLE result)
if(NOT result EQUAL 0)
  message(FATAL_ERROR "the benchmarks failed (${result}):\n${log}")
endif()
string(JSON rows LENGTH "${json}" rows)
string(JSON bandwidths LENGTH "${json}" bandwidths)
string(JSON first GET "${json}" rows 0 median_ns)
if(rows LESS 60 OR bandwidths LESS 3 OR first LESS_EQUAL 0)
  message(FATAL_ERROR "too little was measured: ${rows} rows, ${bandwidths} bandwidths")
endif()
# What is wrong is found: an unknown size, an expression that is none.
foreach(arguments "--sizes;99999M" "--filter;(")
  execute_process(COMMAND ${PROGRAM} --quick --sizes 1k ${arguments} OUTPUT_QUIET ERROR_QUIET RESULT_VARIABLE result)
  if(result EQUAL 0)
    message(FATAL_ERROR "'${arguments}' was taken")
  endif()
endforeach()
