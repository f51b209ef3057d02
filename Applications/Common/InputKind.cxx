#include "Common/InputKind.h"

#include "Common/RunApp.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/MeshIO/MeshFile.h"

namespace adaptiso {
namespace fs = std::filesystem;

const MeshFormat& meshFormatOf(const fs::path& file) {
    try {
        return findMeshFormat(file);
    } catch (const InvalidInput& error) {
        throw UsageError(error.what());
    }
}

std::string surfaceHint(const fs::path& file) {
    try {
        readMesh(file, {.keepsFaults = true});
    } catch (const Error&) {
        return "";
    }
    return "this is a surface, not an image; adaptiso-check, adaptiso-compare and "
           "adaptiso-simplify take surfaces";
}

}  // namespace adaptiso
