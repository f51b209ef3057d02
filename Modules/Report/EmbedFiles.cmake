# cmake -DOUTPUT=<.cxx> -DFILES=<name=path|name=path...> -P EmbedFiles.cmake
# Writes a C++ file with the bytes of every file: adaptiso::embedded::<name>(), a std::string_view,
# and <name>Sha256(), its bytes' SHA-256 in hexadecimal. A path that is empty gives empty ones.
string(REPLACE "|" ";" files "${FILES}")
set(text "// made by EmbedFiles.cmake\n#include \"PageFiles.h\"\n\nnamespace adaptiso::embedded {\n")
foreach(file IN LISTS files)
    string(REGEX MATCH "^([^=]+)=(.*)$" _ "${file}")
    set(name ${CMAKE_MATCH_1})
    set(bytes "")
    set(size 0)
    set(sha256 "")
    if(CMAKE_MATCH_2)
        file(READ "${CMAKE_MATCH_2}" hex HEX)
        file(SHA256 "${CMAKE_MATCH_2}" sha256)
        string(REGEX REPLACE "(..)" "\\\\x\\1" bytes "${hex}")
        string(LENGTH "${hex}" size)
        math(EXPR size "${size} / 2")
    endif()
    string(APPEND text "std::string_view ${name}() {\n    return {\"${bytes}\", ${size}};\n}\n"
           "std::string_view ${name}Sha256() {\n    return \"${sha256}\";\n}\n")
endforeach()
file(WRITE "${OUTPUT}" "${text}}  // namespace adaptiso::embedded\n")
