#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <string>
#include <utility>

#include "FinishBoundaries.h"
#include "MontageTable.h"
#include "SkinArcs.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/HeadModel/Landmarks.h"

namespace adaptiso {

using namespace headmodel;

namespace {

Arc requireArc(const TriangleMesh& skin, const Vec3& from, const Vec3& by, const Vec3& to) {
    std::optional<Arc> arc = arcThrough(skin, from, by, to);
    if (!arc) {
        throw InvalidInput(
            "no arc of the skin leads through the landmarks; are nasion and ears right?");
    }
    return *std::move(arc);
}

/// The arcs that all positions follow from.
struct Frame {
    Vec3 nasion, inion, leftEar, rightEar, vertex;

    Arc midline(const TriangleMesh& skin) const { return requireArc(skin, nasion, vertex, inion); }
    Arc across(const TriangleMesh& skin) const {
        return requireArc(skin, leftEar, vertex, rightEar);
    }
    /// From Fpz past T7, and past T8, to Oz.
    std::pair<Arc, Arc> ring(const TriangleMesh& skin) const {
        const Arc along = midline(skin), over = across(skin);
        const Vec3 front = along.at(0.1), back = along.at(0.9);
        return {requireArc(skin, front, over.at(0.1), back),
                requireArc(skin, front, over.at(0.9), back)};
    }
    /// From the nasion past the left ear, and past the right one, to the inion.
    std::pair<Arc, Arc> lowerRing(const TriangleMesh& skin) const {
        return {requireArc(skin, nasion, leftEar, inion),
                requireArc(skin, nasion, rightEar, inion)};
    }
};

/// What lies between nasion and ears.
struct Base {
    Vec3 nasion, leftEar, rightEar, middle, up;
};

Base baseOf(const TriangleMesh& skin, const Landmarks& landmarks) {
    constexpr double kMostMm = 30;
    std::vector<Vec3> places{landmarks.nasionMm, landmarks.leftEarMm, landmarks.rightEarMm};
    if (landmarks.inionMm) places.push_back(*landmarks.inionMm);
    const OntoSkin onto = projectedOntoSkin(places, skin);
    if (onto.farthestMm > kMostMm) {
        constexpr double kMostMetres = 1;
        const bool areMetres =
            std::ranges::all_of(places, [](const Vec3& p) { return norm(p) < kMostMetres; });
        throw InvalidInput("a landmark lies " + shortNumber(onto.farthestMm) +
                           " mm from the skin, must be at most 30; " +
                           (areMetres ? "it is less than 1 mm from the origin: is it in metres?"
                                      : "is it of this head, in the same space?"));
    }
    Base base{onto.pointsMm[0], onto.pointsMm[1], onto.pointsMm[2], {}, {}};
    base.middle = 0.5 * (base.leftEar + base.rightEar);
    base.up = normalized(cross(base.rightEar - base.leftEar, base.nasion - base.middle));
    return base;
}

/// The skin farthest from between the ears, in a direction.
Vec3 farthestOn(const TriangleMesh& skin, const Base& base, const Vec3& direction) {
    const RayHits hits = rayHits(skin, base.middle, direction);
    if (hits.mm.empty()) {
        throw InvalidInput("nasion and ears do not lie round the head; are left and right right?");
    }
    return base.middle + hits.mm.back() * direction;
}

Vec3 guessedInion(const TriangleMesh& skin, const Base& base) {
    // 18 degrees of Colin's head, 15 of FreeSurfer's average; of EGI's average caps about 7
    constexpr double kElevation = 13 * std::numbers::pi / 180;
    const Vec3 back = normalized(base.middle - base.nasion);
    return farthestOn(skin, base, std::cos(kElevation) * back + std::sin(kElevation) * base.up);
}

Frame frameOf(const TriangleMesh& skin, const Landmarks& landmarks) {
    const Base base = baseOf(skin, landmarks);
    Frame frame{base.nasion, {}, base.leftEar, base.rightEar, farthestOn(skin, base, base.up)};
    frame.inion = landmarks.inionMm ? projectedOntoSkin({*landmarks.inionMm}, skin).pointsMm[0]
                                    : guessedInion(skin, base);
    constexpr int kMostRounds = 20;
    constexpr double kEnoughMm = 0.01;
    for (int round = 0; round < kMostRounds; ++round) {
        const Vec3 before = frame.vertex;
        frame.vertex = frame.midline(skin).at(0.5);
        frame.vertex = frame.across(skin).at(0.5);
        if (norm(frame.vertex - before) < kEnoughMm) break;
    }
    return frame;
}

/// A row from ear to ear, at a share of the way from front to back.
struct Row {
    int percent;
    const char* lateral;  ///< of 7 and 8
    const char* medial;   ///< of the rest
};
constexpr std::array<Row, 15> kRows{{{15, "AFp", "AFp"},
                                     {20, "AF", "AF"},
                                     {25, "AFF", "AFF"},
                                     {30, "F", "F"},
                                     {35, "FFT", "FFC"},
                                     {40, "FT", "FC"},
                                     {45, "FTT", "FCC"},
                                     {50, "T", "C"},
                                     {55, "TTP", "CCP"},
                                     {60, "TP", "CP"},
                                     {65, "TPP", "CPP"},
                                     {70, "P", "P"},
                                     {75, "PPO", "PPO"},
                                     {80, "PO", "PO"},
                                     {85, "POO", "POO"}}};

enum class PositionSystem { TenTwenty, TenTen, TenFive };

const std::set<std::string>& tenTwenty() {
    static const std::set<std::string> names{"Fp1", "Fpz", "Fp2", "F7", "F3", "Fz", "F4",
                                             "F8",  "T7",  "C3",  "Cz", "C4", "T8", "P7",
                                             "P3",  "Pz",  "P4",  "P8", "O1", "Oz", "O2"};
    return names;
}

bool isIn(PositionSystem system, const std::string& name, bool isTenFive) {
    if (system == PositionSystem::TenFive) return true;
    if (system == PositionSystem::TenTwenty) return tenTwenty().contains(name);
    if (isTenFive) return false;
    // of the rows AF and PO the 10-10 system has every other position
    static const std::set<std::string> left{"AF1", "AF2", "AF5", "AF6", "PO1", "PO2", "PO5", "PO6"};
    return !left.contains(name);
}

class Positions {
public:
    Positions(const TriangleMesh& skin, const Landmarks& landmarks, PositionSystem system)
        : skin_(skin), system_(system), frame_(frameOf(skin, landmarks)) {}

    std::vector<NamedPoint> all() && {
        const Arc midline = frame_.midline(skin_), across = frame_.across(skin_);
        const Vec3 front = midline.at(0.1), back = midline.at(0.9);
        const auto [left, right] = frame_.ring(skin_);
        add("Fpz", front);
        addRing("Fp", 0.1, left, right);
        for (const Row& row : kRows) {
            const double share = row.percent / 100.0;
            addRow(row, row.percent == 50 ? across.at(0.1) : left.at(share),
                   row.percent == 50 ? across.at(0.9) : right.at(share), midline.at(share));
        }
        addRing("O", 0.9, left, right);
        add("Oz", back);
        addLowerRing();
        return std::move(positions_);
    }

private:
    void add(const std::string& name, const Vec3& point, bool isTenFive = false) {
        if (isIn(system_, name, isTenFive)) {
            positions_.push_back({name, PointKind::Electrode, point});
        }
    }

    void addRing(const std::string& name, double share, const Arc& left, const Arc& right) {
        add(name + "1", left.at(share));
        add(name + "2", right.at(share));
        add(name + "1h", left.at(share < 0.5 ? share / 2 : (1 + share) / 2), true);
        add(name + "2h", right.at(share < 0.5 ? share / 2 : (1 + share) / 2), true);
    }

    void addRow(const Row& row, const Vec3& left, const Vec3& right, const Vec3& middle) {
        const bool isTenFive = row.percent % 10 != 0;
        const Arc arc = requireArc(skin_, left, middle, right);
        const Arc toMiddle[2] = {requireArc(skin_, left, arc.at(0.25), middle),
                                 requireArc(skin_, right, arc.at(0.75), middle)};
        add(std::string(row.medial) + "z", middle, isTenFive);
        for (int step = 0; step < 8; ++step) {
            // 7, 7h, 5, 5h, 3, 3h, 1, 1h from the side to the middle
            const int number = 7 - 2 * (step / 2);
            const char* const prefix = number == 7 ? row.lateral : row.medial;
            for (int side = 0; side < 2; ++side) {
                add(prefix + std::to_string(number + side) + (step % 2 != 0 ? "h" : ""),
                    toMiddle[side].at(step / 8.0), isTenFive || step % 2 != 0);
            }
        }
    }

    /// Through nasion, ears and inion.
    void addLowerRing() {
        const auto [left, right] = frame_.lowerRing(skin_);
        constexpr std::array<std::pair<int, const char*>, 5> kNames{
            {{30, "F"}, {40, "FT"}, {50, "T"}, {60, "TP"}, {70, "P"}}};
        for (const auto& [percent, name] : kNames) {
            const double share = percent / 100.0;
            add(std::string(name) + "9", percent == 50 ? frame_.leftEar : left.at(share));
            add(std::string(name) + "10", percent == 50 ? frame_.rightEar : right.at(share));
        }
        add("Nz", frame_.nasion);
        add("Iz", frame_.inion);
    }

    const TriangleMesh& skin_;
    PositionSystem system_;
    Frame frame_;
    std::vector<NamedPoint> positions_;
};

/// Places by angles on a sphere whose rings are those of the 10-05 system.
class ByAngles {
public:
    ByAngles(const TriangleMesh& skin, const Landmarks& landmarks)
        : skin_(skin),
          frame_(frameOf(skin, landmarks)),
          ring_(frame_.ring(skin)),
          lower_(frame_.lowerRing(skin)) {}

    Vec3 at(const CapPlace& place) const {
        constexpr double kRingDeg = 92, kLowerDeg = 115;
        const Vec3 onRing = on(ring_, place.azimuthDeg);
        if (place.polarDeg > kRingDeg) {
            const double beyond = (place.polarDeg - kRingDeg) / (kLowerDeg - kRingDeg);
            return onRing + beyond * (on(lower_, place.azimuthDeg) - onRing);
        }
        const Arc arc = requireArc(skin_, on(ring_, place.azimuthDeg + 180), frame_.vertex, onRing);
        const double top = arc.shareNear(frame_.vertex);
        return arc.at(top + (1 - top) * place.polarDeg / kRingDeg);
    }

private:
    /// \param azimuthDeg  from the right ear to the nasion
    static Vec3 on(const std::pair<Arc, Arc>& leftAndRight, double azimuthDeg) {
        const double fromNasion = std::remainder(azimuthDeg - 90, 360);
        return (fromNasion > 0 ? leftAndRight.first : leftAndRight.second)
            .at(std::abs(fromNasion) / 180);
    }

    const TriangleMesh& skin_;
    Frame frame_;
    std::pair<Arc, Arc> ring_, lower_;
};

std::vector<NamedPoint> capPositions(const TriangleMesh& skin, const Landmarks& landmarks,
                                     std::string_view montage) {
    std::map<std::string, Vec3> standard;
    for (NamedPoint& p : Positions(skin, landmarks, PositionSystem::TenFive).all()) {
        standard[std::move(p.name)] = p.point;
    }
    const ByAngles byAngles(skin, landmarks);
    std::vector<NamedPoint> positions;
    std::vector<Vec3> places;
    for (const CapPlace& place : capPlaces(montage)) {
        positions.push_back({place.name, PointKind::Electrode, {}});
        places.push_back(place.standardName.empty() ? byAngles.at(place)
                                                    : standard.at(place.standardName));
    }
    const OntoSkin onto = projectedOntoSkin(places, skin);
    for (std::size_t n = 0; n < positions.size(); ++n) positions[n].point = onto.pointsMm[n];
    return positions;
}

}  // namespace

std::vector<NamedPoint> standardPositions(const TriangleMesh& skin, const Landmarks& landmarks,
                                          std::string_view montage) {
    static const std::map<std::string_view, PositionSystem> systems{
        {"10-20", PositionSystem::TenTwenty},
        {"10-10", PositionSystem::TenTen},
        {"10-05", PositionSystem::TenFive}};
    const auto system = systems.find(montage);
    if (system != systems.end()) return Positions(skin, landmarks, system->second).all();
    const std::vector<std::string> names = montageNames();
    if (std::ranges::find(names, montage) == names.end()) {
        throw InvalidInput("no montage has the name " + std::string(montage));
    }
    return capPositions(skin, landmarks, montage);
}

Landmarks withInion(const TriangleMesh& skin, Landmarks landmarks) {
    if (landmarks.inionMm) return landmarks;
    constexpr double kInionMm = 20;
    landmarks.inionMm = guessedInion(skin, baseOf(skin, landmarks));
    landmarks.inionUncertaintyMm = kInionMm;
    return landmarks;
}

std::optional<HeadSide> sideOfName(std::string_view name) {
    static const std::set<std::string> prefixes = [] {
        std::set<std::string> all{"fp", "o", "a", "m"};
        for (const Row& row : kRows) {
            all.insert({lowerCase(row.lateral), lowerCase(row.medial)});
        }
        return all;
    }();
    std::string plain = lowerCase(name);
    if (plain == "iz" || plain == "nz") return HeadSide::Middle;
    if (plain.ends_with('h')) plain.pop_back();
    const std::size_t end = std::min(plain.find_first_of("z0123456789"), plain.size());
    if (!prefixes.contains(plain.substr(0, end))) return std::nullopt;
    const std::string rest = plain.substr(end);
    if (rest == "z") return HeadSide::Middle;
    if (rest == "10") return HeadSide::Right;
    if (rest.size() != 1 || rest.front() == '0') return std::nullopt;
    return (rest.front() - '0') % 2 != 0 ? HeadSide::Left : HeadSide::Right;
}

}  // namespace adaptiso
