#pragma once

#include <iosfwd>
#include <string>

#include "Comparison.h"

namespace adaptiso::benchmarks {

/// What a comparison was made of and on: without it the numbers say nothing.
struct ComparisonContext {
    std::string input;   ///< the volume's file
    std::string commit;  ///< of this library; empty: not told
    std::string crop;    ///< i0:i1,j0:j1,k0:k1 of the file's samples; empty: all
    ComparisonOptions options;
    PixelType pixelType;
    ImageGeometry geometry;
};

/// A heading, the context in a line and a table with a row for each candidate.
void writeMarkdown(std::ostream& out, const Comparison& comparison,
                   const ComparisonContext& context);

/// The same as JSON, unrounded; bytes and seconds.
void writeJson(std::ostream& out, const Comparison& comparison, const ComparisonContext& context);

}  // namespace adaptiso::benchmarks
