# The headers of libraries that most of our units include, compiled once: a third of the time of a build. Only headers that
# never change; every file still includes what it uses, since `make lint` reads it without these. To build without them:
# -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON (a compiler cache then works across folders).
set(tomodem_precompiled_headers
    <algorithm> <array> <chrono> <cmath> <cstdint> <filesystem> <fstream> <functional> <map> <memory> <numeric> <optional>
    <ranges> <set> <span> <sstream> <string> <unordered_map> <utility> <vector>
    <Eigen/Core> <Eigen/Geometry> <fmt/format.h> <nlohmann/json.hpp> <oneapi/tbb/parallel_for.h>)

# tomodem_precompile(NAME LIBRARY|EXECUTABLE LIBS ... HEADERS ...): what targets of this kind name in REUSE_FROM. Code of
# libraries (-fPIC), of executables (-fPIE) and of what links CGAL (-frounding-math) cannot share them.
function(tomodem_precompile name kind)
    cmake_parse_arguments(arg "" "" "LIBS;HEADERS" ${ARGN})
    set(source ${CMAKE_BINARY_DIR}/generated/${name}.cpp)
    file(CONFIGURE OUTPUT ${source} CONTENT "int main() { return 0; }\n")
    if(kind STREQUAL LIBRARY)
        add_library(${name} OBJECT ${source})
    else()
        add_executable(${name} ${source})
    endif()
    set_target_properties(${name} PROPERTIES EXCLUDE_FROM_ALL TRUE RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/generated)
    target_link_libraries(${name} PRIVATE Eigen3::Eigen fmt::fmt nlohmann_json::nlohmann_json TBB::tbb tomodem_warnings ${arg_LIBS})
    target_precompile_headers(${name} PRIVATE ${tomodem_precompiled_headers} ${arg_HEADERS})
endfunction()

tomodem_precompile(tomodem_library_headers LIBRARY)
tomodem_precompile(tomodem_tool_headers EXECUTABLE)
target_compile_options(tomodem_tool_headers PRIVATE $<$<CONFIG:Release>:-O2>)
tomodem_precompile(tomodem_cgal_headers LIBRARY LIBS CGAL::CGAL
    HEADERS <CGAL/Delaunay_triangulation_3.h> <CGAL/Delaunay_triangulation_cell_base_3.h>
            <CGAL/Exact_predicates_inexact_constructions_kernel.h> <CGAL/Triangulation_cell_base_with_info_3.h>
            <CGAL/Triangulation_vertex_base_with_info_3.h>)
