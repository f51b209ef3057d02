#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"
#include "adaptiso/MeshIO/PointFiles.h"

namespace adaptiso {

/// Nasion and the points before the ears, LPS mm.
struct Landmarks {
    Vec3 nasionMm, leftEarMm, rightEarMm;
    /// How far off they may be, on 19 of 20 heads; 0 where they were given.
    double nasionUncertaintyMm = 0, earUncertaintyMm = 0;

    std::optional<Vec3> inionMm{};  ///< where given, or guessed by withInion()
    double inionUncertaintyMm = 0;

    bool areGuessed() const { return earUncertaintyMm > 0; }
};

/// Landmarks by the shape of a head that is upright in its image, or why there are none.
///
/// Nasion: in the middle plane, the deepest place of the profile between nose and forehead; where
/// no nose stands out by 5 mm (a defaced scan, a face cut off), by proportion. Ears: by proportion
/// to the inner skull (0.57 of its length behind its front, 0.69 of it below its top, as in
/// FreeSurfer's average head), where the skin is there: tragus and lobes are not looked for.
/// Uncertainties are of heads turned by up to 10 degrees. \param innerSkull, skin  closed, LPS mm
struct GuessedLandmarks {
    std::optional<Landmarks> landmarks;
    std::string reason;  ///< why there are none
};
GuessedLandmarks guessLandmarks(const TriangleMesh& innerSkull, const TriangleMesh& skin);

/// The rigid move that takes one head's landmarks to another's: the axes that they span (from ear
/// to ear, to the nasion, up), their origin on the line between the ears below the nasion. \throws
/// InvalidInput  landmarks that span no plane
AffineTransform byLandmarks(const Landmarks& from, const Landmarks& to);

/// LPS mm -> MNE's and Neuromag's head coordinates, mm: x to the right ear, y to the nasion, z up,
/// from the line between the ears below the nasion. \throws InvalidInput  as above
AffineTransform toNeuromag(const Landmarks& landmarks);

/// LPS mm -> Brainstorm's coordinates (SCS), mm: x from the middle between the ears to the nasion,
/// y to the left in the plane of the three, z up. \throws InvalidInput  as above
AffineTransform toBrainstorm(const Landmarks& landmarks);

/// "10-20", "10-10", "10-05" (21, 73 and 277 positions), and caps by their names in MNE-Python:
/// "biosemi64", "GSN-HydroCel-128", ...
std::vector<std::string> montageNames();

/// The positions of the 10-20 system and its extensions [Jurcak2007, Oostenveld2001] on a skin:
/// shares of arcs in planes through landmarks. Cz halves both the arc from nasion to inion and that
/// from ear to ear. An inion that is not given is guessed by withInion().
///
/// An electrode of a cap is where the 10-05 system has its name; one that has none there is at a
/// share of the arc from Cz to the ring through Fpz, T7 and Oz, or of the way from there to the
/// arcs through nasion, ears and inion and as far beyond, by its angles on a sphere. \param skin
/// closed, LPS mm \param montage  one of montageNames() \throws InvalidInput  landmarks farther
/// than 30 mm from the skin, a plane that does not cut it, or a montage of another name
std::vector<NamedPoint> standardPositions(const TriangleMesh& skin, const Landmarks& landmarks,
                                          std::string_view montage);

/// The landmarks with an inion. One that is not given is guessed, to 20 mm: in the middle plane,
/// seen from between the ears 13 degrees above the line from the nasion through there. \throws
/// InvalidInput  as standardPositions()
Landmarks withInion(const TriangleMesh& skin, Landmarks landmarks);

/// How far each of positions(landmarks) may be off (mm) because landmarks are uncertain: each
/// uncertain landmark moves over the skin by its uncertainty, in four directions (the inion up and
/// down); the largest moves that each makes are added as squares. A move after which there are no
/// positions does not count. \param positions  as many points each time; may throw InvalidInput
std::vector<double> carriedUncertaintyMm(
    const TriangleMesh& skin, const Landmarks& landmarks,
    const std::function<std::vector<Vec3>(const Landmarks&)>& positions);

/// The side of the head that a name of the 10-05 system or its older forms (T3, A1) belongs to, in
/// whatever case: odd numbers left, even ones right. Empty for other names.
enum class HeadSide { Left, Middle, Right };
std::optional<HeadSide> sideOfName(std::string_view name);

/// The rigid move that brings digitized head points to the skin, and how far off they then lie.
struct SkinFit {
    AffineTransform move;
    double meanMm = 0, p95Mm = 0, largestMm = 0;  ///< of all points
};
/// Iterated closest points [Besl1992], each along the line to its nearest place, from where `own`
/// lands on `head`. The tenth of the points that lies farthest off (on ears, hair, or by mistake)
/// does not count. Heads are nearly round: landmarks pull too, as exact as 5 mm or as their
/// uncertainty, beside points to 2 mm. Of three starts, as given and nodded by 12 degrees either
/// way, the best is taken.
/// \param points, own  head points and landmarks in one frame, mm
/// \param skin, head   closed; LPS mm
/// \throws InvalidInput  no point; as byLandmarks()
SkinFit fitToSkin(const std::vector<Vec3>& points, const TriangleMesh& skin, const Landmarks& own,
                  const Landmarks& head);

/// Points on the nearest place of the skin, in their order.
struct OntoSkin {
    std::vector<Vec3> pointsMm;
    double meanMm = 0, farthestMm = 0;  ///< moved
    std::size_t farthest = 0;           ///< which
};
/// \pre points is not empty
OntoSkin projectedOntoSkin(const std::vector<Vec3>& pointsMm, const TriangleMesh& skin);

}  // namespace adaptiso
