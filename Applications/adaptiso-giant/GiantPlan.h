#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "adaptiso/Core/Volume.h"
#include "adaptiso/Core/Warning.h"
#include "adaptiso/Extraction/Extraction.h"
#include "adaptiso/Extraction/Tiles.h"
#include "adaptiso/ImageIO/ReadVolume.h"

namespace adaptiso::giant {

/// The plan that all steps of one surface share: the file plan.json of their folder.
struct GiantPlan {
    std::string version;          ///< of the program
    std::filesystem::path input;  ///< absolute
    ReadOptions read;             ///< which part of the image, and refusals
    std::string format;           ///< "OME-Zarr 0.4"
    ImageGeometry geometry;
    PixelType pixelType{};
    double isovalue = 0;
    Method method = Method::Adaptive;
    double maxErrorMm = 0;      ///< of Method::Adaptive
    bool leavesNoise = false;   ///< it is the default bound
    std::int64_t side = 0;      ///< of a tile, cells
    std::vector<Index3> tiles;  ///< that may hold surface, ascending as orderOf() has it
    std::vector<Warning> warnings;

    TileCut cut() const { return {geometry.size, side}; }
    bool isAdaptive() const { return method == Method::Adaptive; }
    /// The seam boxes that lie in these tiles; none but of Method::Adaptive.
    std::vector<Index3> seams() const;
    /// The pieces that form the surface: seam boxes, or tiles.
    std::vector<Index3> pieces() const { return isAdaptive() ? seams() : tiles; }

    /// All but the lists: plans with equal identity have equal pieces.
    std::string identity() const;

    static std::filesystem::path fileIn(const std::filesystem::path& work);
};

std::string encodePlan(const GiantPlan& plan);

/// \param name  for messages \throws FileError  it is no plan, or damaged
GiantPlan decodePlan(std::string_view text, const std::string& name);

/// z, y, x: the order in which pieces are listed, and joined.
std::array<std::int64_t, 3> orderOf(const Index3& place);

/// "3_0_12"
std::string idOf(const Index3& place);
/// Empty if the text is no such id.
std::optional<Index3> placeOf(std::string_view id);

}  // namespace adaptiso::giant
