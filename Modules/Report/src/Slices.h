#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "Canvas.h"
#include "Scene.h"
#include "adaptiso/Core/Volume.h"
#include "adaptiso/Report/Page.h"

namespace adaptiso {

/// The values that become black and white: between them lie all but the darkest 1 % and the
/// brightest 0.5 % of the finite samples, or those of a sample of them that has a million.
ValueRange greyWindow(const VolumeView& volume);

/// Black (0) to white (255); what is not a number is black.
std::uint8_t greyOf(double value, const ValueRange& window);

/// A slice across axis 0 (sagittal), 1 (coronal) or 2 (axial) of RAS space, as pictures show it:
/// the first of the other two axes runs to the right, the second up.
struct SlicePlane {
    int axis = 2;
    double atMm = 0;    ///< RAS
    double leftMm = 0;  ///< RAS, left edge of the picture
    double topMm = 0;   ///< upper edge
    double mmPerPixel = 1;
    int width = 0, height = 0;  ///< pixels

    int across() const { return axis == 0 ? 1 : 0; }
    int up() const { return axis == 2 ? 1 : 2; }
    Pixel toPixel(const Vec3& rasMm) const {
        return {(rasMm[across()] - leftMm) / mmPerPixel, (topMm - rasMm[up()]) / mmPerPixel};
    }
};

/// "axial", "coronal", "sagittal"
const char* sliceName(int axis);
/// Sides at the left, right, top and bottom of such a slice: "L", "R", "A", "P"...
struct SliceSides {
    const char *left, *right, *top, *bottom;
};
SliceSides sidesOf(int axis);

/// The image on the plane, row by row: by trilinear interpolation, black outside and where `face`
/// (if not null) hides it.
std::vector<std::uint8_t> sampleSlice(const VolumeView& volume, const ValueRange& window,
                                      const SlicePlane& plane, const FaceCut* face = nullptr);

/// Draws the slice with its upper left corner at `corner`: the image, if there is one, and where
/// the surfaces cut the plane.
void drawSlice(Canvas& canvas, Pixel corner, const SlicePlane& plane, const Scene& scene,
               const VolumeView* volume, const ValueRange& window, double lineWidth);

/// Twelve slices across the axis through all surfaces, with their contours.
Picture contourPicture(const Report& report, const Scene& scene, int axis);

/// Three slices through each of the first spots, with the spot ringed. None without spots.
std::optional<Picture> spotPicture(const Report& report, const Scene& scene);

/// The picture of Report::histogram.
Picture histogramPicture(const ReportHistogram& histogram);

}  // namespace adaptiso
