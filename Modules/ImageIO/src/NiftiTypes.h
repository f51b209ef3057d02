#pragma once

#include "adaptiso/Core/Volume.h"

namespace adaptiso::detail {

/// NIfTI's numbers of sample types.
struct NiftiType {
    int code;
    PixelType type;
};
inline constexpr NiftiType kNiftiTypes[] = {{2, PixelType::UInt8},    {256, PixelType::Int8},
                                            {4, PixelType::Int16},    {512, PixelType::UInt16},
                                            {8, PixelType::Int32},    {768, PixelType::UInt32},
                                            {1024, PixelType::Int64}, {1280, PixelType::UInt64},
                                            {16, PixelType::Float32}, {64, PixelType::Float64}};

}  // namespace adaptiso::detail
