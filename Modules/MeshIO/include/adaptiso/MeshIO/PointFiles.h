#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "adaptiso/Core/Geometry.h"
#include "adaptiso/Core/Warning.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"

namespace adaptiso {

/// Kind of a digitized point.
enum class PointKind { Nasion, LeftEar, RightEar, Electrode, Other };

struct NamedPoint {
    std::string name;  ///< UTF-8 without control characters; never empty
    PointKind kind = PointKind::Electrode;
    Vec3 point;
};

/// Points of a head as a file has them.
struct PointFile {
    std::vector<NamedPoint> points;        ///< in mm where the unit is known
    std::vector<std::string> placeless;    ///< names of those without a place; no part of points
    std::string format;                    ///< "BIDS electrodes", "ASA .elc", ...
    bool saysUnit = false;                 ///< else the numbers are as stored
    std::optional<CoordinateFrame> frame;  ///< empty: unknown, or one of its own (frameName)
    std::string frameName;                 ///< as the file calls it; may be empty
    std::vector<Warning> warnings;
};

/// Reads electrodes, landmarks and head points, by the file's ending:
///   .tsv .csv .ced   tables: columns name (label, labels, site, id) and x, y, z, or angles theta
///                    and phi, or EEGLAB's theta and radius. Of BIDS unit, frame and landmarks come
///                    from the _coordsystem.json beside it: EEGCoordinateSystem,
///                    EEGCoordinateUnits, AnatomicalLandmarkCoordinates (NAS, LPA, RPA)
///   .elc             of ASA and EETrak: UnitPosition, Positions, Labels
///   .sfp             of BESA and EGI: name x y z, without a unit
///   .fif             FIFF's digitizer block: metres, in head or MRI coordinates; names from its
///                    list of names, or of the channels that lie there
///   .loc .locs .eloc of EEGLAB: number, theta, radius, name;  .xyz  number, x, y, z, name
///   .elp             of Polhemus (%F, %N), or BESA's angles;  .hsp  of Polhemus
///   .pos             of Polhemus and CTF;  .hpts  of MNE;  .csd  of the CSD Toolbox
///   .txt             a table, Polhemus FastSCAN's places, or name x y z
///   .bvef .bvct      of BrainVision: angles, or CapTrak's places
/// A point with a coordinate that is "n/a", NaN or empty has no place. Numbers of a .tsv may have
/// decimal commas. Landmarks are recognised by name (NAS, Nz, fidNz, LPA, fidT9, ...), upper case
/// or lower. Angles give directions of unit length: x to the right, y to the nasion.
/// Files are taken for hostile: at most 100,000 points, finite, each name once.
/// \throws FileError  "<file>: what is wrong; what to do"
PointFile readPoints(const std::filesystem::path& path);

/// The same from bytes in memory; for BIDS with the bytes of _coordsystem.json, if any.
/// \param extension  ".tsv", ".elc", ...
PointFile decodePoints(std::string_view bytes, std::string_view extension, std::string_view name,
                       const std::optional<std::string>& coordinateSystem = std::nullopt);

/// The endings of these files, for messages: ".tsv, .csv, ...".
std::string pointExtensions();

/// Writes points (mm, in `frame`) in all of these formats but for the folder's names:
/// electrodes.tsv and coordsystem.json hold electrodes and landmarks, .elc electrodes and landmarks
/// by name, .sfp all, .fif all, in metres, in MRI coordinates: its points are to be in tkRAS.
/// \throws FileError  the file can't be written
void writeBidsElectrodes(std::span<const NamedPoint> points, const std::filesystem::path& tsv,
                         const std::filesystem::path& json, CoordinateFrame frame);
void writeElc(std::span<const NamedPoint> points, const std::filesystem::path& path);
void writeSfp(std::span<const NamedPoint> points, const std::filesystem::path& path);
void writeFiffPoints(std::span<const NamedPoint> points, const std::filesystem::path& path);

}  // namespace adaptiso
