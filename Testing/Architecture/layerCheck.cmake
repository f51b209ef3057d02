# Configures small projects made with adaptiso_module(): a lawful one passes, and each that breaks
# one rule of the architecture is refused with a message that names the rule.
cmake_minimum_required(VERSION 3.25)

# configureProject(<case> DECLARES <text of Modules/CMakeLists.txt> [INCLUDES <file> <include>...]
#                  [APPENDS <file> <text>])
# Modules Low, Peer and High exist, each with a public header and a source; INCLUDES adds a line
# to a file, APPENDS any text. Sets exitCode and output in the caller.
function(configureProject case)
    cmake_parse_arguments(A "" "DECLARES" "INCLUDES;APPENDS" ${ARGN})
    set(top ${WORK}/${case})
    file(WRITE ${top}/CMakeLists.txt
        "cmake_minimum_required(VERSION 3.25)\nproject(${case} LANGUAGES CXX)\n"
        "include(${MODULE_FILE})\nadd_subdirectory(Modules)\n")
    file(WRITE ${top}/Modules/CMakeLists.txt "${A_DECLARES}")
    foreach(module Low Peer High)
        set(folder ${top}/Modules/${module})
        file(WRITE ${folder}/CMakeLists.txt
            "target_sources(adaptiso${module} PRIVATE src/${module}.cxx)\n")
        file(WRITE ${folder}/include/adaptiso/${module}/${module}.h "#pragma once\n")
        file(WRITE ${folder}/src/${module}.cxx "#include \"adaptiso/${module}/${module}.h\"\n")
        file(WRITE ${folder}/src/Private.h "#pragma once\n")
    endforeach()
    while(A_INCLUDES)
        list(POP_FRONT A_INCLUDES file include)
        file(APPEND ${top}/Modules/${file} "#include ${include}\n")
    endwhile()
    if(A_APPENDS)
        list(POP_FRONT A_APPENDS file)
        file(APPEND ${top}/Modules/${file} "${A_APPENDS}")
    endif()
    execute_process(
        COMMAND ${CMAKE_COMMAND} -S ${top} -B ${top}/build -G ${GENERATOR}
                -DCMAKE_CXX_COMPILER=${COMPILER}
        OUTPUT_VARIABLE log ERROR_VARIABLE log RESULT_VARIABLE code)
    string(REGEX REPLACE "[ \t\r\n]+" " " log "${log}")
    set(exitCode ${code} PARENT_SCOPE)
    set(output "${log}" PARENT_SCOPE)
endfunction()

macro(expectAccepted case)
    configureProject(${case} ${ARGN})
    if(NOT exitCode EQUAL 0)
        message(FATAL_ERROR "${case}: a lawful project was refused: ${output}")
    endif()
    message(STATUS "${case}: accepted")
endmacro()

macro(expectRefused case rule)
    configureProject(${case} ${ARGN})
    if(exitCode EQUAL 0)
        message(FATAL_ERROR "${case}: configured, though it breaks a rule")
    elseif(NOT output MATCHES "${rule}")
        message(FATAL_ERROR "${case}: refused, but not for '${rule}': ${output}")
    endif()
    message(STATUS "${case}: refused")
endmacro()

file(REMOVE_RECURSE ${WORK})
set(lawful "adaptiso_module(Low LAYER 0)
adaptiso_module(Peer LAYER 0 MAY_INCLUDE itk)
adaptiso_module(High LAYER 1 DEPENDS Low)\n")

expectAccepted(dependsOnLowerLayer DECLARES "${lawful}" INCLUDES
    High/src/High.cxx "\"adaptiso/Low/Low.h\""
    Peer/src/Peer.cxx "<itkImage.h>")

expectRefused(restsOnItsOwnLayer "Peer .layer 0. may not rest on Low" DECLARES
    "adaptiso_module(Low LAYER 0)\nadaptiso_module(Peer LAYER 0 DEPENDS Low)\n")
expectRefused(restsOnAHigherLayer "Low .layer 0. may not rest on High" DECLARES
    "adaptiso_module(High LAYER 1)\nadaptiso_module(Low LAYER 0 DEPENDS High)\n")
expectRefused(restsOnALaterModule "High .layer 1. may not rest on Low" DECLARES
    "adaptiso_module(High LAYER 1 DEPENDS Low)\nadaptiso_module(Low LAYER 0)\n")

expectRefused(sourceIncludesUnlistedModule "High.cxx includes module Peer" DECLARES "${lawful}"
    INCLUDES High/src/High.cxx "\"adaptiso/Peer/Peer.h\"")
expectRefused(publicHeaderIncludesUnlistedModule "Low.h includes module High" DECLARES "${lawful}"
    INCLUDES Low/include/adaptiso/Low/Low.h "\"adaptiso/High/High.h\"")
expectRefused(privateHeaderIncludesUnlistedModule "Private.h includes module Peer" DECLARES
    "${lawful}" INCLUDES High/src/Private.h "<adaptiso/Peer/Peer.h>")

# the ways around a module's public headers
expectRefused(includesPrivatesOfAnother "High may not use .*Peer/src" DECLARES "${lawful}"
    APPENDS High/CMakeLists.txt
    "target_include_directories(adaptisoHigh PRIVATE ../Peer/src)\n")
expectRefused(compilesSourceOfAnother "High may not use .*Peer/src/Peer.cxx" DECLARES "${lawful}"
    APPENDS High/CMakeLists.txt "target_sources(adaptisoHigh PRIVATE ../Peer/src/Peer.cxx)\n")
expectRefused(includesByPath "High.cxx: an include may not lead out" DECLARES "${lawful}"
    INCLUDES High/src/High.cxx "\"../../Peer/src/Private.h\"")

expectRefused(includesItk "High may not include itk" DECLARES "${lawful}"
    INCLUDES High/src/High.cxx "<itkImage.h>")
expectRefused(includesVtk "High may not include vtk" DECLARES "${lawful}"
    INCLUDES High/src/High.cxx "\"vtkPolyData.h\"")
expectRefused(includesGdcm "Peer may not include gdcm" DECLARES "${lawful}"
    INCLUDES Peer/src/Peer.cxx "<gdcmReader.h>")
expectRefused(includesCli11 "Low may not include CLI" DECLARES "${lawful}"
    INCLUDES Low/src/Low.cxx "<CLI/CLI.hpp>")
