#pragma once

#include <optional>
#include <string>
#include <vector>

#include "adaptiso/Core/Options.h"
#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/Core/Warning.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"
#include "adaptiso/MeshIO/Formats.h"

namespace adaptiso {

/// How a file's coordinates are scaled, for a printer.
struct PrintScale {
    std::optional<double> factor{};  ///< empty: 1, or automatic
    bool isAutomatic = false;        ///< as small as the bed requires
    std::optional<Vec3> bedMm{};

    bool isWanted() const { return factor || isAutomatic || bedMm; }
};

/// --scale and --fit
const Options<PrintScale>& scaleOptions();

/// Checks the options and the file to write before anything is read.
/// \throws UsageError  no bed for the automatic factor; a format that lies in an image, a frame
///                     that is not in mm
void checkScale(const PrintScale& asked, const MeshFormat& format,
                std::optional<CoordinateFrame> frame);

/// The factor for a surface.
/// \param toFile  the frame of the file, not scaled
/// \param file    that is written, for the message
/// \throws InvalidInput  the surface is larger than the bed; names the factor that fits
double chooseScale(const PrintScale& asked, const TriangleMesh& mesh, const AffineTransform& toFile,
                   const std::string& file);

/// `toFile`, then `factor` about the origin; `toFile` itself to the bit where that is 1.
AffineTransform scaled(const AffineTransform& toFile, double factor);

/// Adds the note "surface-scaled", unless `factor` is 1.
void noteScale(double factor, const std::string& file, std::vector<Warning>& warnings);

}  // namespace adaptiso
