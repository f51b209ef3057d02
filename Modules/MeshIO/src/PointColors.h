#pragma once

#include <vector>

#include "ByteSource.h"
#include "adaptiso/MeshIO/MeshFile.h"

namespace adaptiso::meshio {

/// What is a full shade where a number has no decimal point: OBJ's 1, OFF's 255.
enum class ColorScale { One, Byte };

/// Colours that follow the coordinates of points in a line of text.
class PointColors {
public:
    /// \param areWanted  else nothing is read
    explicit PointColors(bool areWanted) : areWanted_(areWanted) {}

    /// The next three words, of each point in turn. Where they are no numbers it has no colour.
    void add(ByteSource& line, ColorScale scale);

    /// "RGB" where each point has one; else nothing.
    std::vector<PointArray> take(std::size_t points);

private:
    bool areWanted_;
    std::vector<Color> colors_;
};

/// The colours that a format which holds nothing else is to write; null: none.
const std::vector<Color>* colorsOf(const MeshWriteOptions& options);

}  // namespace adaptiso::meshio
