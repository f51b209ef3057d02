#include "adaptiso/HeadModel/ExportFreeSurfer.h"

#include "adaptiso/MeshIO/MeshFile.h"

namespace adaptiso {

std::string freeSurferName(HeadSurface surface) {
    return std::string(toString(surface)) + ".surf";
}

void writeFreeSurferSurface(const TriangleMesh& surface, const std::filesystem::path& path,
                            const std::optional<ImageGeometry>& volume,
                            const std::string& volumeName) {
    MeshWriteOptions options;
    options.frame = volume ? CoordinateFrame::TkRas : CoordinateFrame::Ras;
    options.volume = volume;
    options.volumeName = volumeName;
    writeMesh(surface, path, options);
}

}  // namespace adaptiso
