#pragma once

#include <vector>

#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/Extraction/Simplify.h"
#include "adaptiso/MeshIO/MeshFile.h"
#include "adaptiso/MeshIO/PointData.h"

namespace adaptiso::simplifier {

/// Takes values at the points of a surface to those of another that lies near it.
///
/// Numbers and colours are mixed of the values at the corners of the nearest triangle, by the
/// barycentric weights of the nearest place on it; a value that is not a number counts only where
/// its corner has a weight. Whole numbers, which may be labels, are those of the nearest corner of
/// that triangle.
class PointTransfer {
public:
    /// Both must outlive it. \pre as nearestPoints()
    PointTransfer(const TriangleMesh& from, const TriangleMesh& to);

    PointArray operator()(const PointArray& array) const;
    PointData operator()(const PointData& data) const;

private:
    template <class T>
    std::vector<T> mixed(const std::vector<T>& values, std::size_t columns) const;
    template <class T>
    std::vector<T> nearest(const std::vector<T>& values, std::size_t columns) const;
    std::vector<Color> mixed(const std::vector<Color>& colors) const;
    VertexId nearestCorner(std::size_t point) const;

    const TriangleMesh& from_;
    const TriangleMesh& to_;
    std::vector<SurfacePoint> places_;  ///< of the points of `to` on `from`
};

}  // namespace adaptiso::simplifier
