# What the build for the browser takes in the place of Debian's libraries, which are for the machine:
# headers alone (CLI11, fmt, nlohmann_json) through links, so that no other header of /usr/include is
# seen; expat and zlib from the sources of Debian's packages, whose compressed bytes are the programs'.
# -fno-slp-vectorize: Clang 14 pairs the lines of a matrix in loops over points, and the last of an odd
# number of points came out wrong (Tiles.SimplifiedAreSoundAndWithinTheBound shows it).
add_compile_options(-msimd128 -fno-slp-vectorize -fwasm-exceptions -w)
add_link_options(-fwasm-exceptions)
# No signal and no second thread interrupts a run.
set(CMAKE_POSITION_INDEPENDENT_CODE OFF)

# what this file defines is found
set(CMAKE_MODULE_PATH ${PROJECT_BINARY_DIR}/found)
foreach(package CLI11 EXPAT ZLIB fmt nlohmann_json GTest)
    file(WRITE ${CMAKE_MODULE_PATH}/Find${package}.cmake "set(${package}_FOUND TRUE)\n")
endforeach()

set(headers ${PROJECT_BINARY_DIR}/headers)
file(MAKE_DIRECTORY ${headers})
foreach(library CLI fmt nlohmann)
    if(NOT EXISTS /usr/include/${library})
        message(FATAL_ERROR "/usr/include/${library} is missing; Applications/web/run.sh installs it")
    endif()
    file(CREATE_LINK /usr/include/${library} ${headers}/${library} SYMBOLIC)
endforeach()
include_directories(SYSTEM ${headers})
foreach(target CLI11::CLI11 fmt::fmt nlohmann_json::nlohmann_json)
    add_library(${target} INTERFACE IMPORTED GLOBAL)
    target_include_directories(${target} INTERFACE ${headers})
endforeach()
target_compile_definitions(fmt::fmt INTERFACE FMT_HEADER_ONLY)
add_library(libraryGaps STATIC ${PROJECT_SOURCE_DIR}/Applications/web/LibraryGaps.cxx)
target_link_libraries(libraryGaps PRIVATE fmt::fmt)
target_compile_options(libraryGaps PRIVATE -std=c++20)
link_libraries(libraryGaps)

# adaptiso_debian_source(<archive> <its folder> <address> <SHA-256>)
function(adaptiso_debian_source archive folder address sha256)
    set(sources ${PROJECT_BINARY_DIR}/sources)
    if(NOT EXISTS ${sources}/${folder})
        file(DOWNLOAD http://deb.debian.org/debian/pool/main/${address}/${archive} ${sources}/${archive}
             EXPECTED_HASH SHA256=${sha256} TIMEOUT 120)
        file(ARCHIVE_EXTRACT INPUT ${sources}/${archive} DESTINATION ${sources})
    endif()
    set(source ${sources}/${folder} PARENT_SCOPE)
endfunction()

adaptiso_debian_source(zlib_1.2.13.dfsg.orig.tar.bz2 zlib-1.2.13.dfsg z/zlib
    71feb7947e3c00ef125f83b79a4e529bde31171e5babe48b391f06758d1ab0a1)
set(names adler32 compress crc32 deflate gzclose gzlib gzread gzwrite infback inffast inflate inftrees
    trees uncompr zutil)
list(TRANSFORM names REPLACE ".+" "${source}/\\0.c" OUTPUT_VARIABLE files)
add_library(zlib STATIC ${files})
target_include_directories(zlib SYSTEM PUBLIC ${source})
target_compile_options(zlib PRIVATE -w -DHAVE_UNISTD_H)
add_library(ZLIB::ZLIB ALIAS zlib)

adaptiso_debian_source(expat_2.5.0.orig.tar.gz libexpat-R_2_5_0/expat e/expat
    ab00ee05c7067fd10a35c5d2a4922ebba746ddd50ff83b79c828da17bbdf1757)
add_library(expat STATIC ${source}/lib/xmlparse.c ${source}/lib/xmlrole.c ${source}/lib/xmltok.c)
target_include_directories(expat SYSTEM PUBLIC ${source}/lib)
# as Debian's: UTF-8, namespaces, the context of errors; entropy for its hash tables
target_compile_definitions(expat PRIVATE XML_NS XML_DTD XML_CONTEXT_BYTES=1024 BYTEORDER=1234
    XML_DEV_URANDOM)
target_compile_options(expat PRIVATE -w)
file(WRITE ${PROJECT_BINARY_DIR}/sources/expat_config.h "")
target_include_directories(expat PRIVATE ${PROJECT_BINARY_DIR}/sources)
add_library(EXPAT::EXPAT ALIAS expat)

# The tests run under Node, on its files. --no-experimental-fetch: Emscripten 3.1.6 would fetch the
# program's own file.
set(CMAKE_CROSSCOMPILING_EMULATOR node --no-experimental-fetch)
set(googletest /usr/src/googletest/googletest)
add_library(gtest STATIC EXCLUDE_FROM_ALL ${googletest}/src/gtest-all.cc)
add_library(gtest_main STATIC EXCLUDE_FROM_ALL ${googletest}/src/gtest_main.cc)
target_include_directories(gtest SYSTEM PUBLIC ${googletest}/include PRIVATE ${googletest})
target_compile_definitions(gtest PUBLIC GTEST_HAS_PTHREAD=0)
target_link_libraries(gtest_main PUBLIC gtest)
add_library(GTest::gtest ALIAS gtest)
add_library(GTest::gtest_main ALIAS gtest_main)
# others' sources are not written to be one
set_target_properties(libraryGaps zlib expat gtest gtest_main PROPERTIES UNITY_BUILD OFF)
