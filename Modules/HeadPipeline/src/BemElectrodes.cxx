#include "adaptiso/HeadPipeline/BemElectrodes.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "ElectrodeSides.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"

namespace adaptiso {
namespace {

constexpr double kMostMovedMm = 60, kMuchMovedMm = 10;
constexpr std::ptrdiff_t kLeastHeadPoints = 20;  ///< that are fitted to the skin

std::vector<Vec3> placesOf(const std::vector<NamedPoint>& points) {
    std::vector<Vec3> places;
    for (const NamedPoint& p : points) places.push_back(p.point);
    return places;
}

void removePlacesOfTheHead(std::vector<NamedPoint>& points) {
    std::erase_if(points, [](const NamedPoint& p) { return p.kind != PointKind::Electrode; });
}

/// Adds what guessed landmarks mean for the electrodes to the warning of them.
/// \param positions  of the electrodes, by landmarks
void carryUncertainty(const Landmarks& landmarks,
                      const std::function<std::vector<Vec3>(const Landmarks&)>& positions,
                      const std::vector<NamedPoint>& electrodes, BemModel& model,
                      BemElectrodes& placed) {
    if (!landmarks.areGuessed() && landmarks.inionUncertaintyMm == 0) return;
    std::vector<double>& mm = placed.uncertaintyMm;
    mm = carriedUncertaintyMm(model.meshes.back(), landmarks, positions);
    double sum = 0;
    for (const double value : mm) sum += value;
    const auto farthest = std::ranges::max_element(mm);
    const std::string text =
        "; electrodes may be off by " + formatFixed(sum / static_cast<double>(mm.size()), 0) +
        " mm on average, " +
        visibleAscii(electrodes[static_cast<std::size_t>(farthest - mm.begin())].name) + " by " +
        formatFixed(*farthest, 0) + " mm";
    const auto told = std::ranges::find(model.warnings, "guessed-landmarks", &Warning::code);
    if (told != model.warnings.end()) {
        told->text += text;
    } else {
        model.warnings.push_back(
            {"guessed-landmarks", "the inion was guessed by nasion and ears, to " +
                                      formatShort(landmarks.inionUncertaintyMm) +
                                      " mm; give it where that matters" + text});
    }
}

/// The three landmarks among a file's points, if it has them all.
std::optional<Landmarks> landmarksOf(const std::vector<NamedPoint>& points) {
    Landmarks landmarks;
    int found = 0;
    for (const auto& [kind, place] : {std::pair{PointKind::Nasion, &landmarks.nasionMm},
                                      std::pair{PointKind::LeftEar, &landmarks.leftEarMm},
                                      std::pair{PointKind::RightEar, &landmarks.rightEarMm}}) {
        const auto point = std::find_if(points.begin(), points.end(),
                                        [k = kind](const NamedPoint& p) { return p.kind == k; });
        if (point == points.end()) continue;
        *place = point->point;
        ++found;
    }
    return found == 3 ? std::optional(landmarks) : std::nullopt;
}

void warnOfPlaceless(const PointFile& file, const std::string& name, BemModel& model) {
    const std::vector<std::string>& without = file.placeless;
    if (without.empty()) return;
    constexpr std::size_t kMost = 5;
    std::string names;
    for (std::size_t n = 0; n < std::min(kMost, without.size()); ++n) {
        names += (n == 0 ? "" : ", ") + visibleAscii(without[n]);
    }
    if (without.size() > kMost) {
        names += " and " + std::to_string(without.size() - kMost) + " more";
    }
    model.warnings.push_back({"electrodes-left-out",
                              std::to_string(without.size()) + " of its " +
                                  std::to_string(without.size() + file.points.size()) +
                                  " points have no place and were left out: " + names,
                              name});
}

/// Heads have a radius of some 90 mm: that says what unit numbers are in, or that they are on a
/// sphere of radius 1.
void guessUnit(PointFile& file, const std::string& name, BemModel& model) {
    if (file.saysUnit) return;
    Vec3 middle;
    for (const NamedPoint& p : file.points) {
        middle += (1 / static_cast<double>(file.points.size())) * p.point;
    }
    double radius = 0;
    for (const NamedPoint& p : file.points) radius = std::max(radius, norm(p.point - middle));
    constexpr double kMostMetres = 0.5, kMostDirections = 2, kMostCentimetres = 30, kSphereMm = 95;
    const bool areDirections = radius > kMostMetres && radius <= kMostDirections;
    const double mm = radius <= kMostMetres        ? 1000
                      : areDirections              ? kSphereMm
                      : radius <= kMostCentimetres ? 10
                                                   : 1;
    for (NamedPoint& p : file.points) p.point = mm * p.point;
    file.saysUnit = true;
    if (areDirections) {
        model.warnings.push_back({"guessed-unit",
                                  "gives directions, not places; taken for a sphere of " +
                                      formatShort(kSphereMm) + " mm",
                                  name});
        return;
    }
    const std::string unit = mm == 1000 ? "m" : mm == 10 ? "cm" : "mm";
    model.warnings.push_back({"guessed-unit", "does not say its unit; taken for " + unit, name});
}

/// tkRAS refers to the volume whose FreeSurfer files are written; without one it is scanner RAS.
AffineTransform toLps(CoordinateFrame frame, const BemModel& model) {
    if (frame == CoordinateFrame::TkRas && !model.tkRasVolume) frame = CoordinateFrame::Ras;
    return inverse(lpsToFrame(frame, model.tkRasVolume));
}

void guess(BemModel& model, BemElectrodes& placed) {
    const std::size_t innerSkull = model.options.boundaries.innerSurfaces;
    const GuessedLandmarks guessed = guessLandmarks(model.meshes[innerSkull], model.meshes.back());
    placed.landmarks = guessed.landmarks;
    if (!placed.landmarks) {
        model.warnings.push_back(
            {"landmarks-unknown", "nasion and ears can't be guessed: " + guessed.reason});
        return;
    }
    placed.landmarkOrigin = "guessed";
    model.warnings.push_back(
        {"guessed-landmarks", "nasion and ears were guessed by the shape of the head: nasion to " +
                                  formatShort(placed.landmarks->nasionUncertaintyMm) +
                                  " mm, ears to " +
                                  formatShort(placed.landmarks->earUncertaintyMm) +
                                  " mm; give them where that matters"});
}

/// How far the file's nasion and ears, brought to the head, lie from those given.
std::string offGiven(const Landmarks& given, const Landmarks& moved) {
    const auto off = [](const Vec3& a, const Vec3& b) {
        return formatFixed(norm(b - a), 1) + " mm";
    };
    return "nasion by " + off(given.nasionMm, moved.nasionMm) + ", left ear by " +
           off(given.leftEarMm, moved.leftEarMm) + ", right ear by " +
           off(given.rightEarMm, moved.rightEarMm);
}

/// Head points, where the file has enough, say better than nasion and ears where the head is;
/// these are then the file's own.
void fitHeadPoints(const std::vector<NamedPoint>& points, const Landmarks& own,
                   AffineTransform& move, BemModel& model, BemElectrodes& placed) {
    constexpr double kOffMm = 5;
    std::vector<Vec3> headPoints;
    for (const NamedPoint& p : points) {
        if (p.kind == PointKind::Other) headPoints.push_back(p.point);
    }
    if (std::ssize(headPoints) < kLeastHeadPoints) return;
    const SkinFit fit = fitToSkin(headPoints, model.meshes.back(), own, *placed.landmarks);
    move = fit.move;
    placed.headPoints = HeadPoints{std::ssize(headPoints), fit};
    const Landmarks fitted{move(own.nasionMm), move(own.leftEarMm), move(own.rightEarMm)};
    if (const auto& given = model.givenElectrodes.landmarks) {
        model.notes.push_back("landmarks: the head points moved those given: " +
                              offGiven(*given, fitted));
    }
    placed.landmarks = fitted;
    placed.landmarkOrigin = "file";
    std::erase_if(model.warnings, [](const Warning& w) { return w.code == "guessed-landmarks"; });
    const std::string off =
        formatFixed(fit.meanMm, 1) + " mm from the skin on average, 95 % within " +
        formatFixed(fit.p95Mm, 1) + " mm, the farthest " + formatFixed(fit.largestMm, 1) + " mm";
    model.notes.push_back("electrodes: fitted to the skin by " +
                          formatCount(std::ssize(headPoints)) + " head points, " + off);
    if (fit.meanMm <= kOffMm) return;
    model.warnings.push_back({"head-points-off", "the head points lie " + off +
                                                     ": are they of this head, and are nasion and "
                                                     "ears right?"});
}

/// The frame that is stated, or that the file says.
std::optional<CoordinateFrame> frameOf(const BemModel& model) {
    const std::optional<CoordinateFrame>& stated = model.options.electrodes.frame;
    return stated ? stated : model.givenElectrodes.file->frame;
}

/// The file's points in the model's space.
std::vector<NamedPoint> inModelSpace(BemModel& model, BemElectrodes& placed) {
    const std::string& name = model.givenElectrodes.fileName;
    PointFile file = *model.givenElectrodes.file;
    addWarnings(model.warnings, file.warnings, name);
    warnOfPlaceless(file, name, model);
    guessUnit(file, name, model);
    const std::optional<Landmarks> own = landmarksOf(file.points);
    AffineTransform move;
    const auto tellOfOwn = [&] {
        const auto& given = model.givenElectrodes.landmarks;
        if (!given || !own || placed.headPoints) return;
        const Landmarks moved{move(own->nasionMm), move(own->leftEarMm), move(own->rightEarMm)};
        model.notes.push_back("landmarks: those given are kept; the file's lie off: " +
                              offGiven(*given, moved));
    };
    if (const auto frame = frameOf(model)) {
        move = toLps(*frame, model);
        tellOfOwn();
        if (own && !placed.landmarks) {
            placed.landmarks =
                Landmarks{move(own->nasionMm), move(own->leftEarMm), move(own->rightEarMm)};
            placed.landmarkOrigin = "file";
        }
    } else {
        if (!placed.landmarks) guess(model, placed);
        if (!placed.landmarks) {
            throw InvalidInput(
                "the file's frame follows from nasion and ears, which are not known; "
                "give them");
        }
        move = byLandmarks(*own, *placed.landmarks);
        std::vector<NamedPoint> electrodes = file.points;
        removePlacesOfTheHead(electrodes);
        model.notes.push_back("electrodes: brought to the head by nasion and ears" +
                              (file.frameName.empty() ? "" : " (frame " + file.frameName + ")"));
        fitHeadPoints(file.points, *own, move, model, placed);
        tellOfOwn();
        if (!electrodes.empty()) {
            const auto moved = [&](const Landmarks& head) {
                const AffineTransform by = byLandmarks(*own, head);
                std::vector<Vec3> places = placesOf(electrodes);
                for (Vec3& p : places) p = by(p);
                return places;
            };
            carryUncertainty(*placed.landmarks, moved, electrodes, model, placed);
        }
    }
    for (NamedPoint& p : file.points) p.point = move(p.point);
    return file.points;
}

/// Caps and inner skulls lie above the plane of nasion and ears, some 45 mm on average.
/// \param what  the places' name in the refusal
void requireAbove(const Landmarks& landmarks, const std::vector<Vec3>& places,
                  const std::string& what) {
    constexpr double kFarBelowMm = 20;
    const Vec3 ears = 0.5 * (landmarks.leftEarMm + landmarks.rightEarMm);
    const Vec3 up = cross(landmarks.rightEarMm - landmarks.leftEarMm, landmarks.nasionMm - ears);
    double sum = 0;
    for (const Vec3& place : places) sum += dot(place - ears, up) / norm(up);
    const double aboveMm = sum / static_cast<double>(places.size());
    if (!(aboveMm < -kFarBelowMm)) return;
    throw InvalidInput(
        what + " lie " + formatFixed(-aboveMm, 0) +
        " mm below nasion and ears on average: are the ears exchanged, or is an axis "
        "mirrored?");
}

void project(std::vector<NamedPoint> points, BemModel& model, BemElectrodes& placed) {
    removePlacesOfTheHead(points);
    if (points.empty()) return;
    const std::vector<Vec3> places = placesOf(points);
    if (placed.landmarks) requireAbove(*placed.landmarks, places, "the electrodes");
    const TriangleMesh& skin = model.meshes.back();
    if (auto warning = doubtfulSides(points, placed.landmarks, skin)) {
        model.warnings.push_back(*std::move(warning));
    }
    const OntoSkin onto = projectedOntoSkin(places, skin);
    placed.meanMovedMm = onto.meanMm;
    placed.farthestMovedMm = onto.farthestMm;
    placed.farthestName = points[onto.farthest].name;
    if (onto.farthestMm > kMostMovedMm) {
        throw InvalidInput(
            "the electrode " + placed.farthestName + " lies " + formatFixed(onto.farthestMm, 0) +
            " mm from the skin, must be at most 60; is it in another frame or unit?");
    }
    if (onto.meanMm > kMuchMovedMm) {
        model.warnings.push_back(
            {"cap-moved-far", "the electrodes lie " + formatFixed(onto.meanMm, 1) +
                                  " mm from the skin on average and were moved onto it: is the cap "
                                  "of this head, and are nasion and ears right?"});
    }
    for (std::size_t n = 0; n < points.size(); ++n) points[n].point = onto.pointsMm[n];
    placed.points = std::move(points);
    model.notes.push_back("electrodes: " + formatCount(std::ssize(placed.points)) +
                          " moved onto the skin, by " + formatFixed(onto.meanMm, 1) +
                          " mm on average, the farthest (" + placed.farthestName + ") by " +
                          formatFixed(onto.farthestMm, 1) + " mm");
}

void place(BemModel& model, BemElectrodes& placed) {
    const ElectrodeOptions& options = model.options.electrodes;
    if (model.givenElectrodes.landmarks) {
        placed.landmarks = model.givenElectrodes.landmarks;
        placed.landmarkOrigin = "given";
    }
    if (model.givenElectrodes.file) project(inModelSpace(model, placed), model, placed);
    const bool needsLandmarks = !options.montage.empty() || options.wantsLandmarks;
    if (!placed.landmarks && needsLandmarks) guess(model, placed);
    if (placed.landmarks) {
        const std::size_t innerSkull = model.options.boundaries.innerSurfaces;
        requireAbove(*placed.landmarks, model.meshes[innerSkull].points,
                     "the inner skull's vertices");
        if (auto warning = doubtfulSides(*placed.landmarks)) {
            model.warnings.push_back(*std::move(warning));
        }
    }
    if (options.montage.empty()) return;
    if (!placed.landmarks) throw InvalidInput("positions need nasion and ears; give them");
    const TriangleMesh& skin = model.meshes.back();
    placed.points = standardPositions(skin, *placed.landmarks, options.montage);
    placed.areComputed = true;
    carryUncertainty(
        withInion(skin, *placed.landmarks),
        [&](const Landmarks& landmarks) {
            return placesOf(standardPositions(skin, landmarks, options.montage));
        },
        placed.points, model, placed);
    model.notes.push_back("electrodes: " + formatCount(std::ssize(placed.points)) +
                          " positions computed on the skin");
}

}  // namespace

std::vector<NamedPoint> BemElectrodes::all() const {
    std::vector<NamedPoint> list = points;
    if (!landmarks) return list;
    list.push_back({"Nasion", PointKind::Nasion, landmarks->nasionMm});
    list.push_back({"LPA", PointKind::LeftEar, landmarks->leftEarMm});
    list.push_back({"RPA", PointKind::RightEar, landmarks->rightEarMm});
    return list;
}

void checkElectrodes(const BemModel& model) {
    if (!model.givenElectrodes.file) return;
    const std::vector<NamedPoint>& points = model.givenElectrodes.file->points;
    const auto count = [&](PointKind kind) {
        return std::ranges::count(points, kind, &NamedPoint::kind);
    };
    const bool hasFrame = frameOf(model).has_value();
    if (!hasFrame && !landmarksOf(points)) {
        throw InvalidInput(
            "the file says no coordinate frame, and has no nasion and ears to find it by; state it "
            "by --electrodes-in ras, lps or tkras (electrodes_in in Python), or of a template "
            "take --montage (montage)");
    }
    const bool hasHeadPoints = !hasFrame && count(PointKind::Other) >= kLeastHeadPoints;
    if (count(PointKind::Electrode) == 0 && (!hasHeadPoints || !model.options.leadField.empty())) {
        throw InvalidInput("the file holds no electrode");
    }
}

void placeElectrodes(BemModel& model, const BemHooks& hooks) {
    hooks.stage("electrodes", [&] {
        BemElectrodes placed;
        place(model, placed);
        model.electrodes = std::move(placed);
    });
}

}  // namespace adaptiso
