#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "SceneMesh.h"
#include "adaptiso/Report/Report.h"

namespace adaptiso {

/// What lies inside closed surfaces, in cells of 1 mm.
class Inside {
public:
    /// \param surface  fills where a line along z enters and leaves it; lines that meet it an odd
    ///                 number of times fill nothing
    explicit Inside(const SceneMesh& surface);
    bool holds(const Vec3& rasMm) const;

private:
    BoundingBox box_;
    Index3 size_{0, 0, 0};
    std::vector<bool> cells_;
};

/// The part of space that is left out of a page so that no face is seen.
///
/// It lies below a plane across the head that begins 45 mm below its top at the forehead, half way
/// to the brows, and falls backwards by 42 degrees; for heads of another length than 180 mm, as
/// measured in the upper 50 mm, in proportion. Heads that look up or down by 20 degrees keep their
/// brows, eyes, nose, mouth and chin below it. No part of the face lies in the upper 50 mm, so
/// nothing of the face tells where the plane is.
class FaceCut {
public:
    /// Finds the head in the image, else in the surfaces. What lies inside a surface that
    /// holds no face (ReportSurface::isWithinSkull) stays.
    FaceCut(const Report& report, const std::vector<SceneMesh>& surfaces);

    bool hides(const Vec3& rasMm) const;

    /// Where the head lies could not be told, so everything is hidden but what stays.
    bool hidesAll() const { return !plane_; }
    const std::string& reason() const { return reason_; }  ///< of hidesAll()
    double belowTopMm() const;                             ///< where the plane begins

private:
    /// Hidden where z < topMm - scale * (kBelowTopMm + kFall * (frontMm - y)).
    struct Plane {
        double topMm, frontMm, scale;
    };
    /// What the upper part of a head tells, RAS.
    struct Vault {
        double topMm, frontMm, backMm;
    };
    void take(const Vault& vault);
    void findIn(const VolumeView& volume);
    void findIn(const std::vector<SceneMesh>& surfaces);

    std::optional<Plane> plane_;
    std::vector<Inside> staying_;
    std::string reason_;
};

}  // namespace adaptiso
