#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>

#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/MeshIO/MeshFile.h"

namespace adaptiso {

/// A PLY file that is written piece by piece, for surfaces that memory does not hold: first all
/// points, then all triangles. What comes out is what writeMesh() writes of the whole.
class PlyStream {
public:
    /// \param options  frame alone counts: the mesh is in it already
    /// \throws InvalidInput  more points or triangles than PLY's 32 bits can number
    /// \throws FileError     the file can't be written
    PlyStream(const std::filesystem::path& path, const MeshWriteOptions& options,
              std::int64_t points, std::int64_t triangles, bool hasNormals);
    ~PlyStream();
    PlyStream(const PlyStream&) = delete;
    PlyStream& operator=(const PlyStream&) = delete;

    /// \param normal  passed over where there are none
    void addPoint(const Vec3& point, const Normal& normal);
    void addTriangle(const Triangle& triangle);

    /// \pre all that was announced was added \throws InternalError otherwise, FileError
    void finish();

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace adaptiso
