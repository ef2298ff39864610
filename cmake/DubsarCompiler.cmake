# Language, warnings and sanitizers for every target of the project.
set(CMAKE_CXX_STANDARD 23)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_C_STANDARD 11)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)

if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()

find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  # With paths taken relative to the tree, a second clone finds what the first one compiled.
  set(CMAKE_CXX_COMPILER_LAUNCHER env CCACHE_BASEDIR=${CMAKE_SOURCE_DIR} CCACHE_NOHASHDIR=1 ${CCACHE_PROGRAM})
endif()

add_library(dubsar_options INTERFACE)
target_compile_options(dubsar_options INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual -Wcast-qual -Wformat=2 -Werror
  # Contracting a*b+c would make results differ between machines; the same input must give the same bytes.
  -ffp-contract=off)
if(CMAKE_CXX_COMPILER_ID STREQUAL Clang)
  # Clang before 19 says of itself that it lacks what libstdc++ asks of it for std::expected; it does not.
  target_compile_options(dubsar_options INTERFACE -Wno-macro-redefined
    $<$<AND:$<COMPILE_LANGUAGE:CXX>,$<NOT:$<STREQUAL:$<TARGET_PROPERTY:CXX_STANDARD>,17>>>:-D__cpp_concepts=202002L>)
endif()

# A package must depend on what the programs use, not on everything that a library's configuration names.
target_link_options(dubsar_options INTERFACE -Wl,--as-needed)

set(DUBSAR_SANITIZE "" CACHE STRING "Sanitizers, e.g. address,undefined or thread")
if(DUBSAR_SANITIZE)
  # The library's own checks of indices see what stays inside a block of memory; undefined behaviour ends the program,
  # as else no test would fail of it; lines are enough for a report.
  target_compile_definitions(dubsar_options INTERFACE _GLIBCXX_ASSERTIONS)
  target_compile_options(dubsar_options INTERFACE -fsanitize=${DUBSAR_SANITIZE} -fno-omit-frame-pointer -g1
    -fno-sanitize-recover=all
    # GCC 12 reports spurious maybe-uninitialized reads in instrumented Eigen code.
    $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
  target_link_options(dubsar_options INTERFACE -fsanitize=${DUBSAR_SANITIZE})

  # What a test has to preload before a library of its own: the sanitizer's.
  if(DUBSAR_SANITIZE MATCHES "address|thread")
    string(SUBSTRING ${CMAKE_MATCH_0} 0 1 letter)
    set(DUBSAR_SANITIZER_LIBRARY lib${letter}san.so)
    if(CMAKE_CXX_COMPILER_ID STREQUAL Clang)
      set(DUBSAR_SANITIZER_LIBRARY libclang_rt.${letter}san-${CMAKE_SYSTEM_PROCESSOR}.so)
    endif()
    execute_process(COMMAND ${CMAKE_CXX_COMPILER} -print-file-name=${DUBSAR_SANITIZER_LIBRARY}
      OUTPUT_VARIABLE DUBSAR_SANITIZER_LIBRARY OUTPUT_STRIP_TRAILING_WHITESPACE)
    if(CMAKE_CXX_COMPILER_ID STREQUAL Clang AND NOT DUBSAR_LIBFUZZER)
      # GCC's is a library by itself; Clang's would else stand in each program, where a preloaded library comes before it.
      get_filename_component(folder ${DUBSAR_SANITIZER_LIBRARY} DIRECTORY)
      target_link_options(dubsar_options INTERFACE -shared-libsan -Wl,-rpath,${folder})
    endif()
    string(APPEND DUBSAR_SANITIZER_LIBRARY ":")
  endif()
endif()
