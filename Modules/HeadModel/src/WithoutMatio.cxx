#include "adaptiso/Core/Errors.h"
#include "adaptiso/HeadModel/ExportMatlab.h"

/// A build without libmatio: MATLAB files are neither read nor written.
namespace adaptiso {
namespace {

[[noreturn]] void refuse(const std::filesystem::path& path) {
    throw InvalidInput(path.string() + ": this build has no MATLAB files; use the programs");
}

}  // namespace

std::string fieldTripCoordsys(CoordinateFrame) {
    return "";
}

void writeFieldTripModel(std::span<const HeadLayer>, const std::filesystem::path& path,
                         CoordinateFrame) {
    refuse(path);
}

std::vector<HeadLayer> readFieldTripModel(const std::filesystem::path& path) {
    refuse(path);
}

void writeBrainstormSurface(const TriangleMesh&, const std::filesystem::path& path,
                            const std::string&) {
    refuse(path);
}

TriangleMesh readBrainstormSurface(const std::filesystem::path& path) {
    refuse(path);
}

void writeLeadField(const LeadField&, const std::filesystem::path& path, CoordinateFrame) {
    refuse(path);
}

std::vector<double> readLeadFieldGain(const std::filesystem::path& path) {
    refuse(path);
}

}  // namespace adaptiso
