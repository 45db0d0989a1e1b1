# cmake -DBUILD=... -DFOLDER=... -P: makes the Debian package, unpacks it into FOLDER, and runs the programs in it.
file(REMOVE_RECURSE ${FOLDER})
file(MAKE_DIRECTORY ${FOLDER})
function(run output_name)
  execute_process(COMMAND ${ARGN} WORKING_DIRECTORY ${FOLDER} RESULT_VARIABLE result OUTPUT_VARIABLE output
                  ERROR_VARIABLE errors)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "${ARGN}\n${output}${errors}")
  endif()
  set(${output_name} "${output}" PARENT_SCOPE)
endfunction()

get_filename_component(tools ${CMAKE_COMMAND} DIRECTORY)
run(made ${tools}/cpack --config ${BUILD}/CPackConfig.cmake -B ${FOLDER})
file(GLOB package ${FOLDER}/*.deb)
run(unpacked dpkg-deb -x ${package} ${FOLDER}/root)
run(needs dpkg-deb -f ${package} Depends)
foreach(library libhwy1 libfmt9 libdraco7)
  if(NOT needs MATCHES ${library})
    message(FATAL_ERROR "the package does not depend on ${library}: ${needs}")
  endif()
endforeach()
foreach(file lib/libchronormal.a lib/libchronormal_c.so.0 lib/pkgconfig/chronormal.pc include/chronormal_c.h
             share/man/man1/chronormal.1 share/bash-completion/completions/chronormal
             share/zsh/vendor-completions/_chronormal share/fish/vendor_completions.d/chronormal.fish
             share/doc/chronormal/copyright)
  if(NOT EXISTS ${FOLDER}/root/usr/${file})
    message(FATAL_ERROR "the package has no ${file}")
  endif()
endforeach()
# The page of reports is made by npm and may be missing in this build. If the build has the page, the package must
# contain it.
if(EXISTS ${BUILD}/../share/chronormal/report.html)
  run(said ${FOLDER}/root/usr/bin/chronormal report --sample twist -o twist.html)
endif()
run(said ${FOLDER}/root/usr/bin/chronormal sample --sample twist --times 0.5 -o normals.npy)
file(SIZE ${FOLDER}/normals.npy bytes)
if(bytes LESS 1000)
  message(FATAL_ERROR "the packaged program wrote ${bytes} bytes of normals")
endif()
