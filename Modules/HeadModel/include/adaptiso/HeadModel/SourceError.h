#pragma once

#include <string>

#include "adaptiso/Core/Errors.h"

namespace adaptiso {

/// An input that helps to find boundaries in a head's image.
enum class BoundarySource { BrainMask, HeadMask, Pial, White, Lesion };

/// A fault of such an input, not of the image itself.
class SourceError : public InvalidInput {
public:
    SourceError(BoundarySource source, const std::string& what)
        : InvalidInput(what), source_(source) {}
    BoundarySource source() const { return source_; }

private:
    BoundarySource source_;
};

}  // namespace adaptiso
