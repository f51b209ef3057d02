#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "WallCollapser.h"
#include "WallProof.h"
#include "adaptiso/SurfaceProof/SurfaceMap.h"

namespace adaptiso::detail {

/// Maps triangles of the full walls continuously to the walls as they are, no point farther than a
/// limit: see SurfaceMap. Each wall is mapped to itself, and what ends it to what ends it: a
/// curve's points go to the edges that they are assigned to, its corners to themselves.
///
/// So what is mapped lies within the limit of the walls as they are, and so does each triangle of
/// these that is covered within the limit of the full ones.
class WallMap {
public:
    using Id = WallMesh::Id;

    /// Keeps references to both. \param to  of the collapser's mesh
    WallMap(const WallCollapser& collapser, const WallSurface& to);

    /// What was made of triangles of the full walls, in turn.
    struct Result {
        std::vector<std::uint8_t> isMapped;
        /// How many triangles of the mesh (numbers) each goes to, and these.
        std::vector<Id> witnessCounts, witnesses;
    };
    /// \param full  numbers \param areAll  all of a patch whose walls began as the full ones
    Result map(const std::vector<Id>& full, bool areAll, double limitMm);

    /// A triangle of the mesh (number) lies within the limit of what was mapped.
    bool covers(Id triangle) const {
        const Id place = places_[triangle];
        return place != WallMesh::kNone && cover_.covers(place);
    }

private:
    using Map = SurfaceMap<Id>;
    class Mapper;

    /// A vertex that no sample is assigned for: it has not moved.
    struct Still {
        Vec3 point;
        Id vertex;
    };
    Id stillAt(const Vec3& point) const;

    const WallCollapser& collapser_;
    const WallMesh& mesh_;
    const WallSurface& to_;
    std::vector<Id> places_;  ///< in `to`, of the mesh's triangles
    std::vector<Still> still_;
    SharedCover cover_;
};

}  // namespace adaptiso::detail
