# Installs a build into a fresh prefix and builds and runs the mini-project on it.
#   cmake -D WAY=cmake|pkg-config -D BUILD=... -D SOURCE=... -D CXX=... -D LIBDIR=... -P run.cmake
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status)
  if(NOT status EQUAL 0)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "'${command}' ended with ${status}")
  endif()
endfunction()

set(work "${BUILD}/consumer-${WAY}")
set(prefix "${work}/prefix")
file(REMOVE_RECURSE "${work}")
file(MAKE_DIRECTORY "${work}/build")
run("${CMAKE_COMMAND}" --install "${BUILD}" --prefix "${prefix}")

if(WAY STREQUAL "cmake")
  run("${CMAKE_COMMAND}" -G Ninja -S "${SOURCE}" -B "${work}/build"
      "-DCMAKE_PREFIX_PATH=${prefix}" "-DCMAKE_CXX_COMPILER=${CXX}")
  run("${CMAKE_COMMAND}" --build "${work}/build")
else()
  set(ENV{PKG_CONFIG_PATH} "${prefix}/${LIBDIR}/pkgconfig")
  execute_process(COMMAND pkg-config --cflags --libs sightline
    OUTPUT_VARIABLE flags OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
  separate_arguments(flags UNIX_COMMAND "${flags}")
  run("${CXX}" -std=c++20 "${SOURCE}/consumer.cpp" -o "${work}/build/consumer" ${flags})
endif()
run("${work}/build/consumer")
