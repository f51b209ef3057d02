#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <string>

#include "Support/Meshes.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/HeadModel/Landmarks.h"

namespace adaptiso {
namespace {

using testing::icosphere;

constexpr Vec3 kCentre{3, -2, 5};
constexpr double kRadiusMm = 92;

/// Of a sphere, nasion and ears on its equator: everything is known on paper.
Landmarks onEquator() {
    Landmarks landmarks;
    landmarks.nasionMm = kCentre + Vec3{0, -kRadiusMm, 0};
    landmarks.leftEarMm = kCentre + Vec3{kRadiusMm, 0, 0};
    landmarks.rightEarMm = kCentre + Vec3{-kRadiusMm, 0, 0};
    landmarks.inionMm = kCentre + Vec3{0, kRadiusMm, 0};
    return landmarks;
}

std::map<std::string, Vec3> positionsOn(const TriangleMesh& skin, std::string_view montage) {
    std::map<std::string, Vec3> positions;
    for (const NamedPoint& point : standardPositions(skin, onEquator(), montage)) {
        positions[point.name] = point.point - kCentre;
    }
    return positions;
}

/// The direction at an angle from the vertex (degrees), towards an azimuth from the nasion to the
/// left.
Vec3 direction(double fromTop, double azimuth) {
    const double t = fromTop * std::numbers::pi / 180, a = azimuth * std::numbers::pi / 180;
    return {std::sin(t) * std::sin(a), -std::sin(t) * std::cos(a), std::cos(t)};
}

TEST(StandardPositions, OfASphereAreWhereAnglesSay) {
    const TriangleMesh skin = icosphere(5, kCentre, kRadiusMm);
    const auto positions = positionsOn(skin, "10-10");
    // arcs of 180 degrees: ten percent are 18 degrees; the ring through Fpz, T7, Oz lies 72 degrees
    // from the vertex, on which ten percent of a half are 18 degrees of azimuth
    const std::map<std::string, Vec3> expected{
        {"Cz", direction(0, 0)},    {"Fz", direction(36, 0)},    {"Fpz", direction(72, 0)},
        {"Pz", direction(36, 180)}, {"Oz", direction(72, 180)},  {"C3", direction(36, 90)},
        {"T7", direction(72, 90)},  {"T8", direction(72, -90)},  {"Fp1", direction(72, 18)},
        {"F7", direction(72, 54)},  {"F8", direction(72, -54)},  {"O2", direction(72, -162)},
        {"T9", direction(90, 90)},  {"F10", direction(90, -54)}, {"Iz", direction(90, 180)}};
    for (const auto& [name, at] : expected) {
        ASSERT_TRUE(positions.contains(name)) << name;
        // chords of 3 mm lie 0.01 mm inside of the sphere
        EXPECT_LE(norm(positions.at(name) - kRadiusMm * at), 0.2) << name;
    }
    // F3 lies on the arc F7 - Fz - F8, half way
    const Vec3 half = positions.at("F3");
    EXPECT_NEAR(norm(half - positions.at("F7")), norm(half - positions.at("Fz")), 0.3);
}

TEST(StandardPositions, TakeTheInionThatIsGiven) {
    Landmarks landmarks = onEquator();
    landmarks.inionMm = kCentre + kRadiusMm * direction(70, 180);
    for (const NamedPoint& point :
         standardPositions(icosphere(5, kCentre, kRadiusMm), landmarks, "10-10")) {
        const Vec3 at = point.point - kCentre;
        if (point.name == "Iz") {
            EXPECT_LE(norm(at - kRadiusMm * direction(70, 180)), 0.2);
        }
        // ten percent of an arc of 160 degrees from the nasion
        if (point.name == "Fpz") {
            EXPECT_LE(norm(at - kRadiusMm * direction(74, 0)), 0.2);
        }
    }
}

TEST(StandardPositions, GuessTheInionAboveTheLineFromTheNasionBetweenTheEars) {
    const TriangleMesh skin = icosphere(5, kCentre, kRadiusMm);
    Landmarks landmarks = onEquator();
    landmarks.inionMm.reset();
    const Landmarks guessed = withInion(skin, landmarks);
    EXPECT_LE(norm(*guessed.inionMm - kCentre - kRadiusMm * direction(77, 180)), 0.2);
    EXPECT_EQ(guessed.inionUncertaintyMm, 20);
    for (const NamedPoint& point : standardPositions(skin, landmarks, "10-10")) {
        if (point.name != "Iz") continue;
        EXPECT_LE(norm(point.point - *guessed.inionMm), 0.2);
    }
    EXPECT_EQ(withInion(skin, onEquator()).inionUncertaintyMm, 0);
}

TEST(StandardPositions, AreAsUncertainAsTheirLandmarks) {
    const TriangleMesh skin = icosphere(5, kCentre, kRadiusMm);
    const auto places = [&](const Landmarks& l) {
        std::vector<Vec3> fpzCzOz;
        for (const NamedPoint& p : standardPositions(skin, l, "10-20")) {
            if (p.name == "Cz" || p.name == "Fpz" || p.name == "Oz") fpzCzOz.push_back(p.point);
        }
        return fpzCzOz;
    };
    EXPECT_EQ(carriedUncertaintyMm(skin, onEquator(), places), (std::vector<double>{0, 0, 0}));
    Landmarks landmarks = onEquator();
    landmarks.inionMm.reset();
    landmarks = withInion(skin, landmarks);
    // 20 mm up or down the skin from the inion: Cz moves by half of it, Oz by 9 tenths, Fpz by one
    const double arcMm = kRadiusMm * std::atan(20 / kRadiusMm);
    const std::vector<double> of = carriedUncertaintyMm(skin, landmarks, places);
    EXPECT_NEAR(of[0], 0.1 * arcMm, 0.5);
    EXPECT_NEAR(of[1], 0.5 * arcMm, 0.5);
    EXPECT_NEAR(of[2], 0.9 * arcMm, 0.5);
    // the guessed inion follows the nasion, and Cz with both; squares add up
    landmarks.nasionUncertaintyMm = 20;
    EXPECT_NEAR(carriedUncertaintyMm(skin, landmarks, places)[1], std::sqrt(1.25) * arcMm, 0.5);
}

TEST(SideOfName, FollowsTheNumber) {
    for (const char* const name : {"Fp1", "FP1", "F7", "C3", "O1", "T3", "FT9", "CCP5h", "M1"}) {
        EXPECT_EQ(sideOfName(name), HeadSide::Left) << name;
    }
    for (const char* const name : {"Fp2", "F10", "C4", "PO8", "AFp2", "T6", "O2h", "A2"}) {
        EXPECT_EQ(sideOfName(name), HeadSide::Right) << name;
    }
    for (const char* const name : {"Cz", "FPZ", "Iz", "CPPz"}) {
        EXPECT_EQ(sideOfName(name), HeadSide::Middle) << name;
    }
    for (const char* const name : {"E1", "B12", "C32", "EEG001", "1", "", "F", "C0", "ECG", "Fh"}) {
        EXPECT_FALSE(sideOfName(name)) << name;
    }
}

TEST(StandardPositions, AreAsManyAsTheSystemsHaveAndNamedOnce) {
    const TriangleMesh skin = icosphere(4, kCentre, kRadiusMm);
    const std::map<std::string, std::size_t> counts{{"10-20", 21},
                                                    {"10-10", 73},
                                                    {"10-05", 277},
                                                    {"biosemi16", 16},
                                                    {"biosemi64", 64},
                                                    {"biosemi256", 256},
                                                    {"standard_1005", 343},
                                                    {"easycap-M10", 61},
                                                    {"GSN-HydroCel-64_1.0", 64},
                                                    {"GSN-HydroCel-129", 129},
                                                    {"EGI_256", 256},
                                                    {"mgh60", 60}};
    for (const auto& [montage, count] : counts) {
        EXPECT_EQ(standardPositions(skin, onEquator(), montage).size(), count);
        EXPECT_EQ(positionsOn(skin, montage).size(), count);
    }
}

TEST(StandardPositions, AreMirroredWhereTheHeadIs) {
    const auto positions = positionsOn(icosphere(5, kCentre, kRadiusMm), "10-05");
    for (const auto& [left, right] : {std::pair{"F5h", "F6h"}, std::pair{"CCP3", "CCP4"},
                                      std::pair{"FTT7h", "FTT8h"}, std::pair{"O1h", "O2h"}}) {
        const Vec3 a = positions.at(left), b = positions.at(right);
        EXPECT_LE(norm(a - Vec3{-b.x, b.y, b.z}), 0.2) << left;
    }
}

TEST(StandardPositions, OfCapsFollowNamesAndAngles) {
    const TriangleMesh skin = icosphere(5, kCentre, kRadiusMm);
    const auto tenFive = positionsOn(skin, "10-05"), sixtyFour = positionsOn(skin, "biosemi64");
    for (const auto& [name, at] : sixtyFour) EXPECT_LE(norm(at - tenFive.at(name)), 1e-6) << name;
    EXPECT_LE(norm(positionsOn(skin, "standard_1020").at("T3") - tenFive.at("T7")), 1e-6);
    EXPECT_LE(norm(positionsOn(skin, "mgh60").at("EEG001") - tenFive.at("Fp1")), 1e-6);
    // 92 degrees of a cap are 72 of this sphere, 115 are 90; azimuths from the nasion to the left
    const auto cap = positionsOn(skin, "biosemi128");
    const std::map<std::string, Vec3> expected{{"A1", direction(0, 0)},
                                               {"A2", direction(9, 180)},
                                               {"B20", direction(18, -90)},
                                               {"C16", direction(72, -18)},
                                               {"D32", direction(81, 126)}};
    for (const auto& [name, at] : expected) {
        EXPECT_LE(norm(cap.at(name) - kRadiusMm * at), 1) << name;
    }
}

TEST(StandardPositions, OfEveryMontageLieOnTheSkinInPairs) {
    const TriangleMesh skin = icosphere(5, kCentre, kRadiusMm);
    for (const std::string& montage : montageNames()) {
        const auto positions = positionsOn(skin, montage);
        EXPECT_GE(positions.size(), 16u) << montage;
        for (const auto& [name, at] : positions) {
            EXPECT_NEAR(norm(at), kRadiusMm, 0.2) << montage << " " << name;
            // 65 of EGI's nets are not even themselves
            double mirrored = kRadiusMm;
            for (const auto& [other, there] : positions) {
                mirrored = std::min(mirrored, norm(there - Vec3{-at.x, at.y, at.z}));
            }
            EXPECT_LE(mirrored, 8) << montage << " " << name;
        }
    }
    EXPECT_THROW(standardPositions(skin, onEquator(), "biosemi65"), InvalidInput);
}

TEST(StandardPositions, RefuseLandmarksOfAnotherHead) {
    const TriangleMesh skin = icosphere(3, kCentre + Vec3{0, 0, 120}, kRadiusMm);
    EXPECT_THROW(standardPositions(skin, onEquator(), "10-20"), InvalidInput);
}

TEST(Landmarks, TakeOneHeadToAnother) {
    const Landmarks from = onEquator();
    Landmarks to;
    const AffineTransform turn{{{{{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}}}}, {10, 20, 30}};
    to.nasionMm = turn(from.nasionMm);
    to.leftEarMm = turn(from.leftEarMm);
    to.rightEarMm = turn(from.rightEarMm);
    const AffineTransform found = byLandmarks(from, to);
    for (const Vec3& p : {Vec3{1, 2, 3}, Vec3{-40, 5, 60}}) {
        EXPECT_LE(norm(found(p) - turn(p)), 1e-9);
    }
    Landmarks flat = from;
    flat.nasionMm = kCentre;
    EXPECT_THROW(byLandmarks(flat, to), InvalidInput);
}

TEST(Landmarks, GiveBrainstormsAxes) {
    const AffineTransform scs = toBrainstorm(onEquator());
    EXPECT_LE(norm(scs(onEquator().nasionMm) - Vec3{kRadiusMm, 0, 0}), 1e-9);
    EXPECT_LE(norm(scs(onEquator().leftEarMm) - Vec3{0, kRadiusMm, 0}), 1e-9);
    EXPECT_LE(norm(scs(kCentre + Vec3{0, 0, 10}) - Vec3{0, 0, 10}), 1e-9);
}

TEST(OntoSkin, TellsTheFarthestMoved) {
    const TriangleMesh skin = icosphere(5, {}, 90);
    const OntoSkin onto = projectedOntoSkin({{0, 0, 95}, {0, -80, 0}, {90, 0, 0}}, skin);
    EXPECT_EQ(onto.farthest, 1u);
    EXPECT_NEAR(onto.farthestMm, 10, 0.1);  // chords
    EXPECT_NEAR(onto.meanMm, 5, 0.1);
    EXPECT_LE(norm(onto.pointsMm[0] - Vec3{0, 0, 90}), 0.1);
}

TEST(GuessedLandmarks, OfASphereAreToldToBeByProportion) {
    const TriangleMesh inner = icosphere(4, kCentre, 75), skin = icosphere(5, kCentre, 110);
    const GuessedLandmarks guess = guessLandmarks(inner, skin);
    ASSERT_TRUE(guess.landmarks);
    EXPECT_GE(guess.landmarks->nasionUncertaintyMm, 10);  // no nose
    EXPECT_GE(guess.landmarks->earUncertaintyMm, 10);
    EXPECT_GT(guess.landmarks->leftEarMm.x, kCentre.x);  // LPS
    EXPECT_LT(guess.landmarks->nasionMm.y, kCentre.y);
    // nothing below the vault
    const TriangleMesh shallow = icosphere(5, kCentre + Vec3{0, 0, 60}, 70);
    EXPECT_FALSE(guessLandmarks(inner, shallow).landmarks);
    EXPECT_FALSE(guessLandmarks(inner, shallow).reason.empty());
}

/// An ellipsoid with a nose: no turn leaves it as it is.
TriangleMesh noseHead() {
    TriangleMesh skin = icosphere(5, {}, 1);
    for (Vec3& p : skin.points) {
        const double nose = std::exp(-40 * squaredNorm(p - normalized(Vec3{0, -1, -0.4})));
        p = (1 + 0.25 * nose) * Vec3{75 * p.x, 95 * p.y, 85 * p.z};
    }
    return skin;
}

Landmarks movedBy(const AffineTransform& move, Landmarks landmarks) {
    for (Vec3* p : {&landmarks.nasionMm, &landmarks.leftEarMm, &landmarks.rightEarMm})
        *p = move(*p);
    return landmarks;
}

/// Turned about x, by radians, and shifted.
AffineTransform nodded(double angle, const Vec3& shift) {
    const double c = std::cos(angle), s = std::sin(angle);
    return {{{{{1, 0, 0}, {0, c, s}, {0, -s, c}}}}, shift};
}

TEST(SkinFit, HeadPointsMendLandmarksDespiteATenthOfStrays) {
    const TriangleMesh skin = noseHead();
    const Landmarks truth{{0, -95, -30}, {75, 10, -30}, {-75, 10, -30}};
    const AffineTransform away = nodded(0.35, {5, -10, 10});
    std::vector<Vec3> points, right;
    for (std::size_t n = 0; n < skin.points.size(); n += 53) right.push_back(skin.points[n]);
    for (std::size_t n = 0; n < right.size(); ++n) {
        points.push_back(away(n % 11 == 0 ? 1.3 * right[n] : right[n]));  // 20 mm and more off
    }
    // the head's landmarks are guessed, 20 mm off
    Landmarks guess = movedBy(nodded(0.1, {0, 5, 15}), truth);
    guess.nasionUncertaintyMm = guess.earUncertaintyMm = 20;
    const SkinFit fit = fitToSkin(points, skin, movedBy(away, truth), guess);
    for (std::size_t n = 0; n < points.size(); ++n) {
        if (n % 11 != 0) {
            EXPECT_LE(norm(fit.move(points[n]) - right[n]), 0.5) << n;
        }
    }
    EXPECT_NEAR(determinant(fit.move.linear), 1, 1e-9);
    EXPECT_GT(fit.largestMm, 15);
    EXPECT_LE(fit.p95Mm, fit.largestMm);
    EXPECT_NEAR(fit.meanMm, 2.3, 0.5);  // an eleventh of them, 25 mm off
}

TEST(SkinFit, LandmarksTurnTheHeadWhereASphereDoesNotSay) {
    const TriangleMesh skin = icosphere(5, kCentre, kRadiusMm);
    const std::vector<Vec3> points(skin.points.begin(), skin.points.begin() + 200);
    const AffineTransform turn = nodded(0.2, kCentre - nodded(0.2, {})(kCentre));
    const SkinFit fit = fitToSkin(points, skin, onEquator(), movedBy(turn, onEquator()));
    EXPECT_LE(norm(fit.move(points[0]) - turn(points[0])), 0.1);
}

}  // namespace
}  // namespace adaptiso
