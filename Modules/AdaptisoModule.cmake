# adaptiso_module(): one call declares one module, the layer it stands on and what it may use.
#
#   adaptiso_module(<Name> LAYER <n> [ON_DEMAND] [DEPENDS <Module>...]
#                   [MAY_INCLUDE itk|vtk|gdcm...] [PUBLIC <target>...] [PRIVATE <target>...]
#                   [PACKAGES <find_package line>...])
#
# Makes the library adaptiso<Name> (alias adaptiso::<Name>) of Modules/<Name>, whose own
# CMakeLists.txt lists the sources. Configuring fails when
#   - a module rests on one of its own or a higher layer;
#   - a source includes a header of a module that it does not name under DEPENDS;
#   - it compiles or sees a source or private header of another module: a file or an include
#     directory outside Modules/<Name> and the build folder, or an include with "..";
#   - a source includes ITK, VTK, GDCM or CLI11 without naming it under MAY_INCLUDE.
# PACKAGES are what a consumer of this module has to find, each as one string with the arguments
# of find_package(): "VTK 9.1 COMPONENTS CommonCore". What is ON_DEMAND is left out of
# find_package(adaptiso) without COMPONENTS.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(ADAPTISO_WARNINGS -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion)
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    # false alarms at "text" + std::string() in GCC 12 (its bugs 105329, 105651)
    list(APPEND ADAPTISO_WARNINGS -Wno-restrict)
endif()

# What keeps a damaged file from becoming more than a crash; the linker's part is where programs and
# libraries are linked (-z relro -z now). Sanitizers watch over the same.
set(ADAPTISO_HARDENING "")
if(NOT EMSCRIPTEN AND NOT ADAPTISO_SANITIZE)
    include(CheckCXXCompilerFlag)
    foreach(flag -fstack-protector-strong -fstack-clash-protection -fcf-protection)
        string(MAKE_C_IDENTIFIER ADAPTISO${flag} known)
        check_cxx_compiler_flag(${flag} ${known})
        if(${known})
            list(APPEND ADAPTISO_HARDENING ${flag})
        endif()
    endforeach()
    # needs an optimizing compiler
    list(APPEND ADAPTISO_HARDENING
         $<$<AND:$<NOT:$<CONFIG:Debug>>,$<NOT:$<BOOL:${ADAPTISO_COVERAGE}>>>:-D_FORTIFY_SOURCE=2>)
endif()

# find_package() with the arguments in one string, as adaptiso_module(PACKAGES) takes them.
macro(adaptiso_find_package arguments)
    separate_arguments(_adaptiso_arguments UNIX_COMMAND "${arguments}")
    find_package(${_adaptiso_arguments} REQUIRED)
endmacro()

function(adaptiso_compile_options target)
    if(EMSCRIPTEN)
        target_precompile_headers(${target} PRIVATE
            ${PROJECT_SOURCE_DIR}/Applications/web/LibraryGaps.h <array> <cmath> <cstdint> <filesystem>
            <functional> <map> <optional> <sstream> <string> <vector>)
    endif()
    target_compile_options(${target} PRIVATE ${ADAPTISO_WARNINGS} ${ADAPTISO_HARDENING}
                           $<$<BOOL:${ADAPTISO_WARNINGS_AS_ERRORS}>:-Werror>)
    if(ADAPTISO_SANITIZE)
        target_compile_definitions(${target} PRIVATE _GLIBCXX_ASSERTIONS)  # vectors' bounds
        target_compile_options(${target} PRIVATE -fsanitize=${ADAPTISO_SANITIZE}
                               -fno-omit-frame-pointer -fno-sanitize-recover=all)
        target_link_options(${target} PUBLIC -fsanitize=${ADAPTISO_SANITIZE})
    endif()
    if(ADAPTISO_COVERAGE)
        target_compile_options(${target} PRIVATE --coverage -O0 -g)
        target_link_options(${target} PUBLIC --coverage)
    endif()
endfunction()

# adaptiso_cold(<Module> [HOT <source>...]): the module is compiled at -O1, but for these sources, which walk
# over samples or triangles; -O3 takes the compiler up to twice as long.
function(adaptiso_cold name)
    cmake_parse_arguments(A "" "" "HOT" ${ARGN})
    target_compile_options(adaptiso${name} PRIVATE $<$<CONFIG:Release>:-O1>)
    # in a unity build each of them is compiled alone, as it has options of its own
    set_property(SOURCE ${A_HOT} TARGET_DIRECTORY adaptiso${name} APPEND PROPERTY
                 COMPILE_OPTIONS $<$<CONFIG:Release>:-O3>)
endfunction()

function(adaptiso_check_layers name layer)
    cmake_parse_arguments(A "" "" "DEPENDS;MAY_INCLUDE" ${ARGN})
    foreach(dependency IN LISTS A_DEPENDS)
        get_property(below GLOBAL PROPERTY ADAPTISO_LAYER_${dependency})
        if(below STREQUAL "" OR NOT below LESS layer)
            message(FATAL_ERROR "Module ${name} (layer ${layer}) may not rest on ${dependency} "
                                "(layer '${below}'): only lower layers, declared before it.")
        endif()
    endforeach()
    get_target_property(sources adaptiso${name} SOURCES)
    file(GLOB_RECURSE headers "${CMAKE_CURRENT_SOURCE_DIR}/${name}/*.h")
    list(TRANSFORM sources PREPEND "${CMAKE_CURRENT_SOURCE_DIR}/${name}/" REGEX "^[^/]")
    get_target_property(directories adaptiso${name} INCLUDE_DIRECTORIES)
    foreach(path IN LISTS sources directories)
        cmake_path(ABSOLUTE_PATH path BASE_DIRECTORY "${CMAKE_CURRENT_SOURCE_DIR}/${name}" NORMALIZE)
        cmake_path(IS_PREFIX CMAKE_CURRENT_SOURCE_DIR "${path}" isOurs)
        cmake_path(IS_PREFIX PROJECT_BINARY_DIR "${path}" isMade)
        string(FIND "${path}/" "${CMAKE_CURRENT_SOURCE_DIR}/${name}/" position)
        if(isOurs AND NOT isMade AND NOT position EQUAL 0)
            message(FATAL_ERROR "Module ${name} may not use ${path}, which is private to another module")
        endif()
    endforeach()
    foreach(source IN LISTS sources headers)
        if(NOT EXISTS "${source}")
            continue()
        endif()
        file(STRINGS "${source}" includes REGEX "^[ \t]*#[ \t]*include")
        foreach(line IN LISTS includes)
            if(line MATCHES "adaptiso/([A-Za-z]+)/" AND NOT CMAKE_MATCH_1 STREQUAL name
               AND NOT CMAKE_MATCH_1 IN_LIST A_DEPENDS)
                message(FATAL_ERROR "${source} includes module ${CMAKE_MATCH_1}, which "
                                    "Modules/CMakeLists.txt does not list for ${name}: ${line}")
            endif()
            if(line MATCHES "\\.\\./")
                message(FATAL_ERROR "${source}: an include may not lead out of its folder: ${line}")
            endif()
            foreach(library itk vtk gdcm CLI)
                if(line MATCHES "[<\"]${library}[A-Z/]" AND NOT library IN_LIST A_MAY_INCLUDE)
                    message(FATAL_ERROR "${source}: ${name} may not include ${library}: ${line}")
                endif()
            endforeach()
        endforeach()
    endforeach()
endfunction()

function(adaptiso_module name)
    cmake_parse_arguments(A "ON_DEMAND" "LAYER" "DEPENDS;MAY_INCLUDE;PUBLIC;PRIVATE;PACKAGES" ${ARGN})
    set(target adaptiso${name})
    add_library(${target})
    add_library(adaptiso::${name} ALIAS ${target})
    set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
    target_compile_features(${target} PUBLIC cxx_std_20)
    target_include_directories(${target} PUBLIC
        $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/${name}/include>
        $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
    target_include_directories(${target} PRIVATE ${CMAKE_CURRENT_SOURCE_DIR}/${name}/src)
    foreach(dependency IN LISTS A_DEPENDS)
        target_link_libraries(${target} PUBLIC adaptiso${dependency})
    endforeach()
    target_link_libraries(${target} PUBLIC ${A_PUBLIC} PRIVATE ${A_PRIVATE})
    adaptiso_compile_options(${target})
    add_subdirectory(${name})

    adaptiso_check_layers(${name} ${A_LAYER} DEPENDS ${A_DEPENDS} MAY_INCLUDE ${A_MAY_INCLUDE})
    set_property(GLOBAL PROPERTY ADAPTISO_LAYER_${name} ${A_LAYER})
    set_property(GLOBAL APPEND PROPERTY ADAPTISO_MODULES ${name})
    if(NOT A_ON_DEMAND)
        set_property(GLOBAL APPEND PROPERTY ADAPTISO_USUAL_MODULES ${name})
    endif()

    if(EMSCRIPTEN)
        return()  # a page is no library to install
    endif()
    install(TARGETS ${target} EXPORT adaptiso-${name} ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
            LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
    install(DIRECTORY ${name}/include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
    install(EXPORT adaptiso-${name} NAMESPACE adaptiso:: FILE adaptiso-${name}.cmake
            DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/adaptiso)
    set_property(GLOBAL APPEND_STRING PROPERTY ADAPTISO_CONFIG_MODULES
        "set(_adaptiso_${name}_DEPENDS ${A_DEPENDS})\nset(_adaptiso_${name}_PACKAGES \"${A_PACKAGES}\")\n")
endfunction()

function(adaptiso_install_package)
    get_property(ADAPTISO_MODULES GLOBAL PROPERTY ADAPTISO_MODULES)
    get_property(ADAPTISO_USUAL_MODULES GLOBAL PROPERTY ADAPTISO_USUAL_MODULES)
    get_property(ADAPTISO_CONFIG_MODULES GLOBAL PROPERTY ADAPTISO_CONFIG_MODULES)
    configure_package_config_file(${PROJECT_SOURCE_DIR}/Modules/adaptisoConfig.cmake.in
        ${PROJECT_BINARY_DIR}/adaptisoConfig.cmake
        INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/adaptiso)
    write_basic_package_version_file(${PROJECT_BINARY_DIR}/adaptisoConfigVersion.cmake
        COMPATIBILITY SameMinorVersion)
    install(FILES ${PROJECT_BINARY_DIR}/adaptisoConfig.cmake
            ${PROJECT_BINARY_DIR}/adaptisoConfigVersion.cmake
            DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/adaptiso)
endfunction()
