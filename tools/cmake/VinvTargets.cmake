# Targets of this project: warnings as errors, sanitizers, ccache, data files compiled into the binary, tests with labels.

find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CCACHE_PROGRAM})
endif()

if(VINV_TIDY)
  find_program(CLANG_TIDY_PROGRAM clang-tidy REQUIRED)
  set(CMAKE_CXX_CLANG_TIDY ${CLANG_TIDY_PROGRAM};--warnings-as-errors=*)
endif()

add_library(vinv_options INTERFACE)
target_compile_options(vinv_options INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor
  -Woverloaded-virtual -Wnull-dereference -Werror)
# g++ 12 sees overlaps in string concatenation that are not there (GCC bug 105651).
target_compile_options(vinv_options INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>)
# What inlining makes a compiler suspect at -O3 differs from version to version: nobody's release build fails for it.
target_compile_options(vinv_options INTERFACE $<$<CONFIG:Release>:-Wno-error>)
target_include_directories(vinv_options INTERFACE ${PROJECT_SOURCE_DIR})
if(VINV_SANITIZE)
  target_compile_options(vinv_options INTERFACE -fsanitize=${VINV_SANITIZE} -fno-omit-frame-pointer
    -fno-sanitize-recover=all)
  target_link_options(vinv_options INTERFACE -fsanitize=${VINV_SANITIZE})
endif()

# vinv_library(name SOURCES ... LINKS ...): a static library of this tree; a library without sources is header-only.
function(vinv_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINKS;PRIVATE_LINKS" ${ARGN})
  if(ARG_SOURCES)
    add_library(${name} STATIC ${ARG_SOURCES})
    target_link_libraries(${name} PUBLIC vinv_options ${ARG_LINKS} PRIVATE ${ARG_PRIVATE_LINKS})
  else()
    add_library(${name} INTERFACE)
    target_link_libraries(${name} INTERFACE vinv_options ${ARG_LINKS})
  endif()
endfunction()

# vinv_embed(target namespace NAME path [NAME path ...]): compiles data files of the tree into the target as
# std::string_view namespace::NAME, declared in <build>/embedded/<target>_data.hpp.
function(vinv_embed target namespace)
  set(dir ${CMAKE_CURRENT_BINARY_DIR}/embedded)
  set(hpp ${dir}/${target}_data.hpp)
  set(cpp ${dir}/${target}_data.cpp)
  set(pairs ${ARGN})
  set(files "")
  list(LENGTH pairs n)
  math(EXPR last "${n} - 1")
  foreach(i RANGE 1 ${last} 2)
    list(GET pairs ${i} file)
    list(APPEND files ${CMAKE_CURRENT_SOURCE_DIR}/${file})
  endforeach()
  string(REPLACE ";" "|" packed "${pairs}")
  add_custom_command(OUTPUT ${hpp} ${cpp}
    COMMAND ${CMAKE_COMMAND} -DPAIRS=${packed} -DROOT=${CMAKE_CURRENT_SOURCE_DIR} -DHPP=${hpp} -DCPP=${cpp}
      -DNAMESPACE=${namespace} -P ${PROJECT_SOURCE_DIR}/tools/cmake/embed.cmake
    DEPENDS ${files} ${PROJECT_SOURCE_DIR}/tools/cmake/embed.cmake VERBATIM)
  target_sources(${target} PRIVATE ${cpp} ${hpp})
  target_include_directories(${target} PRIVATE ${dir})
endfunction()

# vinv_test(name LABEL unit SOURCES ... LINKS ...): one GoogleTest executable; each of its tests is a ctest test.
function(vinv_test name)
  cmake_parse_arguments(ARG "" "LABEL;TIMEOUT" "SOURCES;LINKS" ${ARGN})
  if(NOT ARG_LABEL)
    set(ARG_LABEL unit)
  endif()
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 120)
  endif()
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE vinv_options ${ARG_LINKS} GTest::gtest GTest::gmock GTest::gtest_main)
  target_compile_definitions(${name} PRIVATE VINV_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  gtest_discover_tests(${name} DISCOVERY_TIMEOUT 60 PROPERTIES LABELS ${ARG_LABEL} TIMEOUT ${ARG_TIMEOUT})
endfunction()
