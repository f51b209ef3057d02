#include "PointCodec.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "Bytes.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/Core/TextCells.h"
#include "adaptiso/Core/TextLines.h"

namespace adaptiso::meshio {
namespace {

void requireFinite(std::string_view name, const Vec3& point) {
    if (!std::isfinite(squaredNorm(point))) {
        damaged("the place of " + printable(name) + " is not finite");
    }
}

double radians(double degrees) {
    return degrees * std::numbers::pi / 180;
}

}  // namespace

PointKind kindOf(std::string_view name) {
    constexpr std::array kNasion{"nas", "nasion", "nz", "fidnz", "fidn"};
    constexpr std::array kLeft{"lpa", "fidt9", "fidl", "leftear"};
    constexpr std::array kRight{"rpa", "fidt10", "fidr", "rightear"};
    std::string plain;
    for (const char c : lowerCase(name)) {
        if (c != '_' && c != ' ' && c != '-') plain += c;
    }
    const auto isIn = [&](const auto& names) {
        return std::find(names.begin(), names.end(), plain) != names.end();
    };
    return isIn(kNasion)  ? PointKind::Nasion
           : isIn(kLeft)  ? PointKind::LeftEar
           : isIn(kRight) ? PointKind::RightEar
                          : PointKind::Electrode;
}

void addPoint(PointFile& file, std::string_view name, const Vec3& point, PointKind kind) {
    if (file.points.size() + file.placeless.size() == kMostPoints) {
        damaged("it holds more than 100,000 points");
    }
    const bool isPlain = std::all_of(name.begin(), name.end(), [](char c) {
        return static_cast<unsigned char>(c) >= ' ' && c != '\x7f';
    });
    if (name.empty() || name.size() > 100 || !isPlain) {
        unsupported("a point has the name " + printable(name),
                    "give each a name of 1 to 100 characters");
    }
    if (std::isnan(point.x) || std::isnan(point.y) || std::isnan(point.z)) {
        file.placeless.push_back(withoutControls(name));
        return;
    }
    requireFinite(name, point);
    file.points.push_back({withoutControls(name), kind, point});
}

void addShapePoint(PointFile& file, const Vec3& point) {
    const std::size_t number = file.points.size() + file.placeless.size() + 1;
    addPoint(file, "extra" + std::to_string(number), point, PointKind::Other);
}

double unitMm(std::string_view word) {
    const std::string unit = lowerCase(word);
    if (unit == "mm") return 1;
    if (unit == "cm") return 10;
    if (unit == "m") return kMetreMm;
    unsupported("its unit is " + printable(word), "it must be mm, cm or m");
}

void scalePoints(PointFile& file, double mm) {
    file.saysUnit = true;
    for (NamedPoint& point : file.points) {
        point.point = mm * point.point;
        requireFinite(point.name, point.point);
    }
}

double coordinate(std::string_view cell, std::string_view axis, std::string_view name,
                  std::int64_t line, char separator) {
    if (const auto value = cellNumber(cell, separator)) return *value;
    const std::string met = linePlace(line) + "the coordinate " + std::string(axis) + " of " +
                            printable(name) + " is " + printable(cell);
    const bool hasComma = cell.find(',') != std::string_view::npos;
    unsupported(met + (hasComma ? ", with a comma" : ""),
                hasComma ? "save it with decimal points" : "it must be a number, or n/a");
}

Vec3 sphericalPlace(double fromVertex, double azimuth) {
    const double t = radians(fromVertex), a = radians(azimuth);
    return {std::sin(t) * std::cos(a), std::sin(t) * std::sin(a), std::cos(t)};
}

Vec3 polarPlace(double angle, double radius) {
    return sphericalPlace(180 * radius, 90 - angle);
}

}  // namespace adaptiso::meshio
