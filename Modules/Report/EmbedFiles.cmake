# cmake -DOUTPUT=<.cxx> -DFILES=<name=path|name=path...> -P EmbedFiles.cmake
# Writes a C++ file with the bytes of every file: adaptiso::embedded::<name>(), a std::string_view.
# A path that is empty gives an empty one.
string(REPLACE "|" ";" files "${FILES}")
set(text "// made by EmbedFiles.cmake\n#include \"PageFiles.h\"\n\nnamespace adaptiso::embedded {\n")
foreach(file IN LISTS files)
    string(REGEX MATCH "^([^=]+)=(.*)$" _ "${file}")
    set(name ${CMAKE_MATCH_1})
    set(bytes "")
    set(size 0)
    if(CMAKE_MATCH_2)
        file(READ "${CMAKE_MATCH_2}" hex HEX)
        string(REGEX REPLACE "(..)" "\\\\x\\1" bytes "${hex}")
        string(LENGTH "${hex}" size)
        math(EXPR size "${size} / 2")
    endif()
    string(APPEND text "std::string_view ${name}() {\n    return {\"${bytes}\", ${size}};\n}\n")
endforeach()
file(WRITE "${OUTPUT}" "${text}}  // namespace adaptiso::embedded\n")
