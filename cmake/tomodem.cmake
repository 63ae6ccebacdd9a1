add_library(tomodem_warnings INTERFACE)
target_compile_options(tomodem_warnings INTERFACE -Wall -Wextra)
target_link_options(tomodem_warnings INTERFACE -Wl,--as-needed)

include(${CMAKE_CURRENT_LIST_DIR}/precompiled.cmake)

# tomodem_library(NAME SOURCES ... LIBS ...): static library tomodem_NAME, headers found from the repository's root.
function(tomodem_library name)
    cmake_parse_arguments(arg "" "" "SOURCES;LIBS;PRIVATE_LIBS" ${ARGN})
    add_library(tomodem_${name} STATIC ${arg_SOURCES})
    target_include_directories(tomodem_${name} PUBLIC ${PROJECT_SOURCE_DIR})
    target_link_libraries(tomodem_${name} PUBLIC ${arg_LIBS} PRIVATE ${arg_PRIVATE_LIBS} tomodem_warnings)
    if(CGAL::CGAL IN_LIST arg_PRIVATE_LIBS)
        target_precompile_headers(tomodem_${name} REUSE_FROM tomodem_cgal_headers)
    else()
        target_precompile_headers(tomodem_${name} REUSE_FROM tomodem_library_headers)
    endif()
endfunction()

# tomodem_tool(NAME SOURCE LIBS ...): executable build/bin/NAME, installed. Its own source is compiled with -O2: what takes
# time when a tool runs is in the libraries, with -O3.
function(tomodem_tool name source)
    cmake_parse_arguments(arg "" "" "LIBS" ${ARGN})
    add_executable(${name} ${source})
    target_link_libraries(${name} PRIVATE ${arg_LIBS} tomodem_cli tomodem_core tomodem_warnings)
    target_compile_options(${name} PRIVATE $<$<CONFIG:Release>:-O2>)
    target_precompile_headers(${name} REUSE_FROM tomodem_tool_headers)
    install(TARGETS ${name} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
    set_property(GLOBAL APPEND PROPERTY TOMODEM_TOOLS ${name})
endfunction()

# tomodem_measures(FOLDER LIBS ...): every FOLDER/NAME.cpp is a measure of a run, called as NAME RUN TABLE, with a main of its
# own: executable build/bin/NAME, installed. A new source is found by the next build. With DESTINATION, it is built there
# and not installed.
function(tomodem_measures folder)
    cmake_parse_arguments(arg "" "DESTINATION" "LIBS" ${ARGN})
    file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${folder}/*.cpp)
    foreach(source ${sources})
        cmake_path(GET source STEM name)
        if(arg_DESTINATION)
            tomodem_test_executable(${name} SOURCES ${source} LIBS ${arg_LIBS} tomodem_cli)
            set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${arg_DESTINATION})
        else()
            tomodem_tool(${name} ${source} LIBS ${arg_LIBS})
        endif()
    endforeach()
endfunction()

# tomodem_python_tool(NAME): the Python files and assets/ of this folder as one executable archive build/bin/NAME, installed.
function(tomodem_python_tool name)
    file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.py ${CMAKE_CURRENT_SOURCE_DIR}/assets/*)
    set(staged ${CMAKE_CURRENT_BINARY_DIR}/${name})
    set(executable ${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/${name})
    add_custom_command(OUTPUT ${executable} DEPENDS ${sources} VERBATIM
        COMMAND ${CMAKE_COMMAND} -E rm -rf ${staged}
        COMMAND ${CMAKE_COMMAND} -E copy_directory ${CMAKE_CURRENT_SOURCE_DIR} ${staged}
        COMMAND ${CMAKE_COMMAND} -E echo "VERSION = \"${PROJECT_VERSION}\"" > ${staged}/version.py
        COMMAND /usr/bin/python3 -m zipapp ${staged} --python /usr/bin/python3 --compress --output ${executable}
        COMMAND chmod a+rx ${executable})
    add_custom_target(${name} ALL DEPENDS ${executable})
    install(PROGRAMS ${executable} DESTINATION ${CMAKE_INSTALL_BINDIR})
    set_property(GLOBAL APPEND PROPERTY TOMODEM_TOOLS ${name})
endfunction()

# tomodem_test_executable(NAME SOURCES ... LIBS ...): executable build/tests/NAME that tests run.
function(tomodem_test_executable name)
    cmake_parse_arguments(arg "" "" "SOURCES;LIBS" ${ARGN})
    add_executable(${name} ${arg_SOURCES})
    target_link_libraries(${name} PRIVATE ${arg_LIBS} tomodem_core tomodem_warnings)
    set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
    add_dependencies(tests ${name})
endfunction()

# tomodem_gtest_executable(NAME SOURCES ... LIBS ...): the same with GoogleTest and a main.
function(tomodem_gtest_executable name)
    cmake_parse_arguments(arg "" "" "SOURCES;LIBS" ${ARGN})
    tomodem_test_executable(${name} SOURCES ${arg_SOURCES} LIBS ${arg_LIBS} GTest::gmock_main)
    if(NOT CGAL::CGAL IN_LIST arg_LIBS)
        target_precompile_headers(${name} REUSE_FROM tomodem_test_headers)
    endif()
endfunction()

# tomodem_unit_test(NAME SOURCES ... LIBS ...): GoogleTest executable; each test is a ctest of label "unit".
function(tomodem_unit_test name)
    cmake_parse_arguments(arg "" "" "SOURCES;LIBS" ${ARGN})
    tomodem_gtest_executable(test_${name} SOURCES ${arg_SOURCES} LIBS ${arg_LIBS})
    include(GoogleTest)
    gtest_discover_tests(test_${name} DISCOVERY_MODE PRE_TEST PROPERTIES LABELS unit)
endfunction()

# tomodem_parallel_test(NAME PROCESSES 1 2 ... SOURCES ... LIBS ...): GoogleTest executable that runs as a whole under
# mpirun, once for each number of processes, as the ctest unit/NAME/COUNT.
function(tomodem_parallel_test name)
    cmake_parse_arguments(arg "" "" "PROCESSES;SOURCES;LIBS" ${ARGN})
    tomodem_gtest_executable(test_${name} SOURCES ${arg_SOURCES} LIBS ${arg_LIBS})
    foreach(count ${arg_PROCESSES})
        add_test(NAME unit/${name}/${count}
                 COMMAND ${MPIEXEC_EXECUTABLE} --oversubscribe ${MPIEXEC_NUMPROC_FLAG} ${count} $<TARGET_FILE:test_${name}>)
        set_tests_properties(unit/${name}/${count} PROPERTIES LABELS unit TIMEOUT 300
            ENVIRONMENT "OMPI_ALLOW_RUN_AS_ROOT=1;OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1")
    endforeach()
endfunction()

# tomodem_bench_executable(NAME SOURCES ... LIBS ...): executable build/bench/NAME that measures.
function(tomodem_bench_executable name)
    cmake_parse_arguments(arg "" "" "SOURCES;LIBS" ${ARGN})
    add_executable(${name} ${arg_SOURCES})
    target_link_libraries(${name} PRIVATE ${arg_LIBS} tomodem_core tomodem_warnings)
    set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bench)
    add_dependencies(benches ${name})
endfunction()

# tomodem_script_test(FILE LABEL ...): a bats file, run through the built executables.
# TOMODEM_BIN is the folder of the executables, TOMODEM_SOURCE the repository. The user's cache is out of reach: no folder
# can be made there.
function(tomodem_script_test file label)
    cmake_path(GET file STEM stem)
    cmake_path(GET CMAKE_CURRENT_SOURCE_DIR FILENAME folder)
    set(test_name ${label}/${folder}/${stem})
    add_test(NAME ${test_name} COMMAND bats ${CMAKE_CURRENT_SOURCE_DIR}/${file})
    set_tests_properties(${test_name} PROPERTIES LABELS ${label} TIMEOUT 3600
        ENVIRONMENT "TOMODEM_BIN=${CMAKE_BINARY_DIR}/bin;TOMODEM_LIB=${CMAKE_BINARY_DIR}/lib;TOMODEM_SOURCE=${PROJECT_SOURCE_DIR};XDG_CACHE_HOME=/dev/null/none;OMPI_ALLOW_RUN_AS_ROOT=1;OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1")
endfunction()
