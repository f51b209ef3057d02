#include "Common/PrintScale.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>
#include <variant>

#include "Common/RunApp.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Text.h"

namespace adaptiso {
namespace {

constexpr NumberRule kFactors{.least = 1e-3, .most = 1e3};
constexpr NumberRule kLengths{.least = 0, .isAbove = true, .unit = "mm"};

std::optional<double> parseAllowed(std::string_view text, const NumberRule& rule) {
    const std::optional<double> value = parseFiniteNumber(text);
    return value && rule.allows(*value) ? value : std::nullopt;
}

/// "220,220,250"
std::optional<Vec3> parseBed(std::string_view text) {
    Vec3 bed;
    for (int axis = 0; axis < 3; ++axis) {
        const std::size_t comma = text.find(',');
        if ((comma == std::string_view::npos) != (axis == 2)) return std::nullopt;
        const auto length = parseAllowed(text.substr(0, comma), kLengths);
        if (!length) return std::nullopt;
        bed[axis] = *length;
        text.remove_prefix(axis == 2 ? 0 : comma + 1);
    }
    return bed;
}

std::string textOf(const Vec3& lengths, const char* between,
                   std::string (*format)(double) = formatShort) {
    return format(lengths.x) + between + format(lengths.y) + between + format(lengths.z);
}

OptionValue factorValue(const PrintScale& asked, const OptionFacts&) {
    if (asked.isAutomatic) return std::string("auto");
    if (!asked.factor) return {};
    return *asked.factor;
}

void setFactor(PrintScale& asked, const OptionValue& value, const OptionFacts&) {
    const auto& text = std::get<std::string>(value);
    asked.isAutomatic = text == "auto";
    asked.factor = parseFiniteNumber(text);
}

OptionValue bedValue(const PrintScale& asked, const OptionFacts&) {
    if (!asked.bedMm) return {};
    return textOf(*asked.bedMm, ",", formatNumber);
}

void setBed(PrintScale& asked, const OptionValue& value, const OptionFacts&) {
    asked.bedMm = parseBed(std::get<std::string>(value));
}

/// To three digits.
double roundedDown(double factor) {
    const double unit = std::pow(10, 2 - std::floor(std::log10(factor)));
    return std::floor(factor * unit) / unit;
}

}  // namespace

const Options<PrintScale>& scaleOptions() {
    static const Options<PrintScale> kRows{
        {{.name = "scale",
          .key = "scale",
          .label = "Scale",
          .valueName = "FACTOR|auto",
          .help = "Multiply the file's coordinates by this, about the origin: the file then names "
                  "no frame of the scan. auto: as small as --fit needs, never larger",
          .isUsable =
              [](std::string_view text) {
                  return text == "auto" || parseAllowed(text, kFactors).has_value();
              },
          .textRule = "a number from 0.001 to 1000, or auto"},
         OptionKind::Text,
         true,
         factorValue,
         setFactor},
        {{.name = "fit",
          .key = "fitMm",
          .label = "Printer's bed, mm",
          .valueName = "X,Y,Z",
          .help = "Refuse a surface that, as it lies, is larger than this printer's bed, in mm",
          .isUsable = [](std::string_view text) { return parseBed(text).has_value(); },
          .textRule = "three lengths in mm above 0, as in 220,220,250"},
         OptionKind::Text,
         true,
         bedValue,
         setBed}};
    return kRows;
}

void checkScale(const PrintScale& asked, const MeshFormat& format,
                std::optional<CoordinateFrame> frame) {
    if (asked.isAutomatic && !asked.bedMm) {
        throw UsageError("--scale auto: needs --fit X,Y,Z, the printer's bed in mm");
    }
    if (!asked.isWanted()) return;
    if (frame == CoordinateFrame::Voxel) {
        throw UsageError("--scale, --fit: are for coordinates in mm, not voxel indices");
    }
    if (format.defaultFrame != CoordinateFrame::TkRas) return;
    throw UsageError("--scale, --fit: " + std::string(format.name) +
                     "'s surfaces lie in an image; write .stl, .3mf, .ply or .obj");
}

double chooseScale(const PrintScale& asked, const TriangleMesh& mesh, const AffineTransform& toFile,
                   const std::string& file) {
    const double factor = asked.factor.value_or(1);
    if (!asked.bedMm || mesh.points.empty()) return factor;
    const Vec3 size = boundingBox(transformed(mesh, toFile)).size();
    double most = std::numeric_limits<double>::max();
    for (int axis = 0; axis < 3; ++axis) {
        if (size[axis] > 0) most = std::min(most, (*asked.bedMm)[axis] / size[axis]);
    }
    if (asked.isAutomatic) return most >= 1 ? 1 : roundedDown(most);
    if (factor <= most) return factor;
    throw InvalidInput("--fit " + textOf(*asked.bedMm, ",") + ": " + file + " would be " +
                       textOf(factor * size, " x ") + " mm; --scale " +
                       formatNumber(roundedDown(most)) + " fits, or --scale auto");
}

AffineTransform scaled(const AffineTransform& toFile, double factor) {
    if (factor == 1) return toFile;
    return AffineTransform{Mat3::diagonal(factor, factor, factor), {}} * toFile;
}

void noteScale(double factor, const std::string& file, std::vector<Warning>& warnings) {
    if (factor == 1) return;
    warnings.push_back({"surface-scaled",
                        "scaled by " + formatNumber(factor) +
                            " about the origin, so that it does not lie on the scan; its areas, "
                            "volumes and distances are those of the file",
                        file});
}

}  // namespace adaptiso
