#pragma once

#include <bit>
#include <optional>
#include <string>

#include "DicomHeader.h"

namespace adaptiso::detail {

/// How a value stands in the file; not every transfer syntax says so.
enum class DicomValueKind { Text, UInt16, UInt32, Float64, Digest };

/// The kind of a value that DicomDataset keeps; nothing for all others.
std::optional<DicomValueKind> wantedDicomValue(DicomTag tag);
bool isWantedDicomSequence(DicomTag tag);

/// A value's bytes as text: binary numbers as "1\\2.5".
std::string dicomText(std::string bytes, DicomValueKind kind, std::endian order);

}  // namespace adaptiso::detail
