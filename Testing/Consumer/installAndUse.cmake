# Installs the build tree BUILD into a fresh prefix, then configures, builds and runs the project
# SOURCE against it, all under WORK. Fails when any step does.
cmake_minimum_required(VERSION 3.25)

function(run)
    execute_process(COMMAND ${ARGN} COMMAND_ECHO STDOUT COMMAND_ERROR_IS_FATAL ANY)
endfunction()

file(REMOVE_RECURSE ${WORK})
run(${CMAKE_COMMAND} --install ${BUILD} --config ${CONFIG} --prefix ${WORK}/prefix)
cmake_path(GET SOURCE FILENAME name)
set(options "")
if(name STREQUAL sphere)
    # it asks for no adaptor: finding ITK and VTK is forbidden, and REQUIRED ones then fail
    set(options -DCMAKE_DISABLE_FIND_PACKAGE_ITK=ON -DCMAKE_DISABLE_FIND_PACKAGE_VTK=ON)
endif()
run(${CMAKE_COMMAND} -S ${SOURCE} -B ${WORK}/build -G ${GENERATOR}
    -DCMAKE_PREFIX_PATH=${WORK}/prefix -DCMAKE_BUILD_TYPE=${CONFIG} -DCMAKE_CXX_COMPILER=${COMPILER}
    ${options})
run(${CMAKE_COMMAND} --build ${WORK}/build --config ${CONFIG})
if(name STREQUAL sphere)
    run(${WORK}/build/sphere ${WORK}/build)
    return()
elseif(name STREQUAL vtkFirst)
    run(${WORK}/build/vtkFirst)
    return()
endif()

# a cube of 4 voxels a side in 8: what the pipeline writes is what adaptiso-mesh writes
set(samples "")
foreach(k RANGE 7)
    foreach(j RANGE 7)
        foreach(i RANGE 7)
            set(sample 100)
            foreach(index i j k)
                if(${${index}} LESS 2 OR ${${index}} GREATER 5)
                    set(sample 0)
                endif()
            endforeach()
            string(APPEND samples " ${sample}")
        endforeach()
    endforeach()
endforeach()
file(WRITE ${WORK}/cube.nrrd "NRRD0004\ntype: short\ndimension: 3\nsizes: 8 8 8\nencoding: ascii\n\
space: left-posterior-superior\nspace directions: (1,0,0) (0,2,0) (0,0,3)\nspace origin: (10,20,30)\n\
\n${samples}\n")
run(${WORK}/build/${name} ${WORK}/cube.nrrd 50 ${WORK}/itk.vtk)
run(${WORK}/prefix/bin/adaptiso-mesh ${WORK}/cube.nrrd --iso 50 --coordinates lps -o ${WORK}/program.vtk)
# ITK's file does not say its frame
run(${WORK}/prefix/bin/adaptiso-compare ${WORK}/itk.vtk ${WORK}/program.vtk --input-coordinates lps
    --max-hausdorff 1e-4)
