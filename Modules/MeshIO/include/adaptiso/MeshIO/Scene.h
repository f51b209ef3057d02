#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/MeshIO/MeshFile.h"

namespace adaptiso {

/// One of several surfaces of a file.
struct ScenePart {
    std::string name;  ///< UTF-8
    std::optional<Color> color;
    TriangleMesh mesh;  ///< LPS mm
};

/// True for GLB and 3MF, which hold several surfaces with their names and colours.
bool holdsScene(const MeshFormat& format);

/// Writes surfaces into one file: a node each in GLB, an object each in 3MF, in other formats as
/// one surface without names and colours, which is what readMesh() reads of all. \param options  as
/// writeMesh() takes them, without arrays \throws InvalidInput, FileError  as writeMesh()
void writeScene(std::vector<ScenePart> parts, const std::filesystem::path& path,
                const MeshWriteOptions& options = {});

}  // namespace adaptiso
