#include "PeerFiles.h"

#include <array>
#include <cstdint>
#include <fstream>
#include <memory>
#include <vector>

#include "adaptiso/Core/Errors.h"

namespace adaptiso::benchmarks {
namespace {

using Tag = std::array<char, 8>;
constexpr Tag kVolumeTag{'p', 'e', 'e', 'r', 'v', 'o', 'l', '1'};
constexpr Tag kMeshTag{'p', 'e', 'e', 'r', 'm', 's', 'h', '1'};

class Writer {
public:
    Writer(const std::filesystem::path& path, const Tag& tag)
        : path_(path), file_(path, std::ios::binary) {
        write(&tag, 1);
    }
    template <class T>
    void write(const T* items, std::size_t count) {
        file_.write(reinterpret_cast<const char*>(items),
                    static_cast<std::streamsize>(count * sizeof(T)));
    }
    void close() {
        file_.close();
        if (!file_) throw FileError(path_.string() + ": can't be written");
    }

private:
    std::filesystem::path path_;
    std::ofstream file_;
};

class Reader {
public:
    Reader(const std::filesystem::path& path, const Tag& tag)
        : path_(path), file_(path, std::ios::binary) {
        Tag found{};
        read(&found, 1);
        if (found != tag) throw FileError(path_.string() + ": not a file of this benchmark");
    }
    template <class T>
    void read(T* items, std::size_t count) {
        file_.read(reinterpret_cast<char*>(items), static_cast<std::streamsize>(count * sizeof(T)));
        if (!file_) throw FileError(path_.string() + ": can't be read whole");
    }

private:
    std::filesystem::path path_;
    std::ifstream file_;
};

}  // namespace

void writeVolumeFile(const std::filesystem::path& path, const VolumeView& volume) {
    Writer file(path, kVolumeTag);
    const PixelType type = volume.pixelType();
    file.write(&type, 1);
    file.write(&volume.geometry(), 1);
    file.write(static_cast<const std::byte*>(volume.samples()), volume.byteCount());
    file.close();
}

Volume readVolumeFile(const std::filesystem::path& path) {
    Reader file(path, kVolumeTag);
    PixelType type{};
    ImageGeometry geometry;
    file.read(&type, 1);
    file.read(&geometry, 1);
    const std::size_t bytes = static_cast<std::size_t>(geometry.voxelCount()) * bytesPerPixel(type);
    const auto samples = std::make_shared_for_overwrite<std::byte[]>(bytes);
    file.read(samples.get(), bytes);
    return {VolumeView(samples.get(), type, geometry), samples};
}

void writeMeshFile(const std::filesystem::path& path, const TriangleMesh& mesh) {
    Writer file(path, kMeshTag);
    const std::uint64_t counts[2] = {mesh.points.size(), mesh.triangles.size()};
    file.write(counts, 2);
    file.write(mesh.points.data(), mesh.points.size());
    file.write(mesh.triangles.data(), mesh.triangles.size());
    file.close();
}

TriangleMesh readMeshFile(const std::filesystem::path& path) {
    Reader file(path, kMeshTag);
    std::uint64_t counts[2];
    file.read(counts, 2);
    TriangleMesh mesh;
    mesh.points.resize(counts[0]);
    mesh.triangles.resize(counts[1]);
    file.read(mesh.points.data(), mesh.points.size());
    file.read(mesh.triangles.data(), mesh.triangles.size());
    return mesh;
}

}  // namespace adaptiso::benchmarks
