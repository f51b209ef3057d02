#pragma once

#include <cstdint>
#include <string_view>

#include "adaptiso/MeshIO/PointFiles.h"

// What the decoders of electrodes' files share; PointFiles.cxx lists the formats.
namespace adaptiso::meshio {

inline constexpr std::size_t kMostPoints = 100'000;
inline constexpr double kMetreMm = 1000;

/// A landmark by its name (NAS, Nz, FidNz, LPA, ...), or an electrode.
PointKind kindOf(std::string_view name);

/// Adds a point; one without a place (NaN) is one of file.placeless.
void addPoint(PointFile& file, std::string_view name, const Vec3& point, PointKind kind);
/// Adds a point of the head's shape: "extra7".
void addShapePoint(PointFile& file, const Vec3& point);

/// Of "mm", "cm" or "m".
double unitMm(std::string_view word);
/// The points times `mm`: then in millimetres.
void scalePoints(PointFile& file, double mm);

/// The number of a word or cell; NaN where it is missing. Refuses others: "line 7: the coordinate x
/// of 'Cz' is 'left'; it must be a number, or n/a". \param separator  of cells; ',' for words
double coordinate(std::string_view cell, std::string_view axis, std::string_view name,
                  std::int64_t line, char separator = ',');

/// The direction at an angle from the vertex, towards an azimuth from the right ear to the nasion
/// (degrees): x to the right, y to the nasion, z up. Negative angles lead the opposite way.
Vec3 sphericalPlace(double fromVertex, double azimuth);
/// EEGLAB's: an angle from the nasion to the right (degrees), 0.5 from the vertex to the ears.
Vec3 polarPlace(double angle, double radius);

// text -> points; BrainVision's XML as it is, all else as UTF-8
PointFile decodePointTable(std::string_view bytes);
PointFile decodeXyz(std::string_view bytes);
PointFile decodeLoc(std::string_view bytes);
PointFile decodeCsd(std::string_view bytes);
PointFile decodeHpts(std::string_view bytes);
PointFile decodePos(std::string_view bytes);
PointFile decodeElp(std::string_view bytes);  ///< and .hsp
PointFile decodeSfp(std::string_view bytes);
PointFile decodePointText(std::string_view bytes);
PointFile decodeBrainVision(std::string_view bytes);

}  // namespace adaptiso::meshio
