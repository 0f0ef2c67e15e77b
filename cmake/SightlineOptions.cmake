# How everything is compiled. Targets of this project link sightline_options privately.
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/bin")
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "" FORCE)
endif()
# Asserts stay in the sanitized builds; Release (-DNDEBUG) drops them.

find_program(SIGHTLINE_CCACHE ccache)
if(SIGHTLINE_CCACHE)
  set(CMAKE_CXX_COMPILER_LAUNCHER "${SIGHTLINE_CCACHE}")
endif()

add_library(sightline_options INTERFACE)
target_compile_options(sightline_options INTERFACE
  -Wall -Wextra -Wconversion -Wshadow -Werror
  # The same bytes everywhere: no fused multiply-add unless it is written.
  -ffp-contract=off)
if(SIGHTLINE_SANITIZE)
  target_compile_options(sightline_options INTERFACE
    -fsanitize=${SIGHTLINE_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  if(SIGHTLINE_SANITIZE MATCHES "address")
    # The address sanitizer finds these at the access itself; checked at every pointer, they make
    # vector code take three times as long to compile.
    target_compile_options(sightline_options INTERFACE
      -fno-sanitize=null,pointer-overflow,object-size)
  endif()
  if(SIGHTLINE_SANITIZE MATCHES "thread")
    # It can follow only threads whose library is compiled with it.
    target_include_directories(sightline_options BEFORE INTERFACE
      "${PROJECT_SOURCE_DIR}/tests/support/tsan")
  endif()
  target_link_options(sightline_options INTERFACE -fsanitize=${SIGHTLINE_SANITIZE})
  # SSE4 would only repeat what AVX2 (no mask registers) and the emulated target show, and vector
  # code under sanitizers is what takes longest to compile.
  target_compile_definitions(sightline_options INTERFACE
    SIGHTLINE_SANITIZED=1 HWY_DISABLED_TARGETS=HWY_SSE4)
endif()
