#pragma once

#include <string>
#include <vector>

#include "adaptiso/Report/Report.h"

namespace adaptiso {

/// A PNG file.
struct Picture {
    std::string name;     ///< "contours-axial.png"
    std::string title;    ///< for people
    std::string altText;  ///< what is to be seen, for those who can't
    std::string png;      ///< the file's bytes
    int width = 0, height = 0;
};

/// Every picture that the report has the data for, in the order of the page:
///   contours-axial, -coronal, -sagittal  where the surfaces cut slices of the image, as MNE's
///                                        plot_bem shows them
///   spots                                three slices through each of the first spots
///   surface-N                            each surface from six sides, what faces away from the
///                                        viewer in red; values in colour, with a colour bar
///   regions                              in their stead, of regions: all together
///
/// Everything is drawn in memory: no display, no OpenGL. Left is left of the picture, and every
/// picture says which side is which. Triangles with a corner that is not there or not finite are
/// left out. The same report gives the same bytes, whatever the number of threads.
/// \pre spots are finite  \throws InternalError  Cairo refuses
std::vector<Picture> drawPictures(const Report& report);

}  // namespace adaptiso
