#include "adaptiso/Tetrahedra/TetrahedraFiles.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>
#include <map>

#include "adaptiso/Core/Errors.h"

namespace adaptiso {
namespace {

/// Text in large pieces; numbers as short as they are exact to nine digits, the same everywhere.
class TextFile {
public:
    explicit TextFile(const std::filesystem::path& path)
        : path_(path), stream_(path, std::ios::binary | std::ios::trunc) {}

    TextFile& operator<<(std::string_view text) {
        buffer_ += text;
        if (buffer_.size() > kPiece) flush();
        return *this;
    }
    TextFile& operator<<(std::int64_t number) {
        std::array<char, 24> digits;
        return *this << std::string_view(
                   digits.data(),
                   std::to_chars(digits.data(), digits.data() + digits.size(), number).ptr);
    }
    TextFile& operator<<(const Vec3& p) {
        for (int a = 0; a < 3; ++a) {
            std::array<char, 40> digits;
            const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), p[a] + 0.0,
                                           std::chars_format::general, 9)
                                 .ptr;
            *this << (a == 0 ? "" : " ") << std::string_view(digits.data(), end);
        }
        return *this;
    }
    void finish() {
        flush();
        stream_.close();
        if (!stream_)
            throw FileError(path_.string() + ": can't be written: " + std::strerror(errno));
    }

private:
    static constexpr std::size_t kPiece = std::size_t{1} << 20;
    void flush() {
        stream_.write(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
        buffer_.clear();
    }

    std::filesystem::path path_;
    std::ofstream stream_;
    std::string buffer_;
};

/// Names stand in quotes.
std::string quotable(std::string name) {
    for (char& c : name) {
        if (c == '"' || c == '\n' || c == '\r') c = ' ';
    }
    return name;
}

void writeNames(TextFile& file, std::span<const TetrahedraRegion> regions) {
    file << "$PhysicalNames\n" << std::ssize(regions) << "\n";
    for (const TetrahedraRegion& region : regions) {
        file << "3 " << std::int64_t{region.label} << " \"" << quotable(region.name) << "\"\n";
    }
    file << "$EndPhysicalNames\n";
}

/// The place of each label in a list.
std::map<std::int32_t, std::int64_t> placesOf(std::span<const TetrahedraRegion> regions) {
    std::map<std::int32_t, std::int64_t> places;
    for (const TetrahedraRegion& region : regions) {
        places.emplace(region.label, std::ssize(places));
    }
    return places;
}

}  // namespace

void writeMsh22(const TetrahedralMesh& mesh, std::span<const TetrahedraRegion> regions,
                const std::filesystem::path& path) {
    TextFile file(path);
    file << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n";
    writeNames(file, regions);
    file << "$Nodes\n" << std::ssize(mesh.points) << "\n";
    std::int64_t number = 0;
    for (const Vec3& p : mesh.points) file << ++number << " " << p << "\n";
    file << "$EndNodes\n$Elements\n" << std::ssize(mesh.tetrahedra) << "\n";
    for (std::size_t n = 0; n < mesh.tetrahedra.size(); ++n) {
        const auto& [a, b, c, d] = mesh.tetrahedra[n];
        const std::int64_t tissue = mesh.labels[n];
        file << static_cast<std::int64_t>(n + 1) << " 4 2 " << tissue << " " << tissue << " "
             << a + 1 << " " << b + 1 << " " << c + 1 << " " << d + 1 << "\n";
    }
    file << "$EndElements\n";
    file.finish();
}

void writeMsh41(const TetrahedralMesh& mesh, std::span<const TetrahedraRegion> regions,
                const std::filesystem::path& path) {
    std::map<std::int32_t, std::int64_t> counts;
    for (const std::int32_t label : mesh.labels) ++counts[label];
    const std::int64_t points = std::ssize(mesh.points), elements = std::ssize(mesh.tetrahedra);
    Vec3 low = mesh.points.front(), high = low;
    for (const Vec3& p : mesh.points) {
        for (int a = 0; a < 3; ++a) {
            low[a] = std::min(low[a], p[a]);
            high[a] = std::max(high[a], p[a]);
        }
    }
    TextFile file(path);
    file << "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n";
    writeNames(file, regions);
    file << "$Entities\n0 0 0 " << std::ssize(regions) << "\n";
    for (const TetrahedraRegion& region : regions) {
        const std::int64_t tissue = region.label;
        file << tissue << " " << low << " " << high << " 1 " << tissue << " 0\n";
    }
    file << "$EndEntities\n$Nodes\n1 " << points << " 1 " << points << "\n3 "
         << std::int64_t{regions.front().label} << " 0 " << points << "\n";
    for (std::int64_t n = 1; n <= points; ++n) file << n << "\n";
    for (const Vec3& p : mesh.points) file << p << "\n";
    file << "$EndNodes\n$Elements\n"
         << std::ssize(regions) << " " << elements << " 1 " << elements << "\n";
    std::int64_t number = 0;
    for (const TetrahedraRegion& region : regions) {
        const std::int32_t tissue = region.label;
        file << "3 " << std::int64_t{tissue} << " 4 " << counts[tissue] << "\n";
        for (std::size_t n = 0; n < mesh.tetrahedra.size(); ++n) {
            if (mesh.labels[n] != tissue) continue;
            const auto& [a, b, c, d] = mesh.tetrahedra[n];
            file << ++number << " " << a + 1 << " " << b + 1 << " " << c + 1 << " " << d + 1
                 << "\n";
        }
    }
    file << "$EndElements\n";
    file.finish();
}

void writeVtu(const TetrahedralMesh& mesh, const std::filesystem::path& path) {
    const std::int64_t elements = std::ssize(mesh.tetrahedra);
    TextFile file(path);
    file << "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" "
            "byte_order=\"LittleEndian\">\n<UnstructuredGrid>\n<Piece NumberOfPoints=\""
         << std::ssize(mesh.points) << "\" NumberOfCells=\"" << elements
         << "\">\n<CellData Scalars=\"tissue\">\n<DataArray type=\"Int32\" Name=\"tissue\" "
            "format=\"ascii\">\n";
    for (const std::int64_t tissue : mesh.labels) file << tissue << "\n";
    file << "</DataArray>\n</CellData>\n<Points>\n<DataArray type=\"Float64\" "
            "NumberOfComponents=\"3\" format=\"ascii\">\n";
    for (const Vec3& p : mesh.points) file << p << "\n";
    file << "</DataArray>\n</Points>\n<Cells>\n<DataArray type=\"Int64\" Name=\"connectivity\" "
            "format=\"ascii\">\n";
    for (const auto& [a, b, c, d] : mesh.tetrahedra) {
        file << a << " " << b << " " << c << " " << d << "\n";
    }
    file << "</DataArray>\n<DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">\n";
    for (std::int64_t n = 1; n <= elements; ++n) file << 4 * n << "\n";
    file << "</DataArray>\n<DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">\n";
    for (std::int64_t n = 0; n < elements; ++n) file << "10\n";
    file << "</DataArray>\n</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
    file.finish();
}

void writeDgf(const TetrahedralMesh& mesh, std::span<const TetrahedraRegion> regions,
              const std::filesystem::path& path) {
    const std::map<std::int32_t, std::int64_t> places = placesOf(regions);
    TextFile file(path);
    file << "DGF\nVertex\n";
    for (const Vec3& p : mesh.points) file << p << "\n";
    file << "#\nSimplex\nparameters 1\n";
    for (std::size_t n = 0; n < mesh.tetrahedra.size(); ++n) {
        const auto& [a, b, c, d] = mesh.tetrahedra[n];
        file << a << " " << b << " " << c << " " << d << " " << places.at(mesh.labels[n]) << "\n";
    }
    file << "#\nBoundaryDomain\ndefault 1\n#\n";
    file.finish();
}

}  // namespace adaptiso
