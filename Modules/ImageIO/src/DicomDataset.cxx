#include <fmt/core.h>

#include <cmath>

#include "DicomHeader.h"
#include "FileFault.h"
#include "HeaderText.h"

namespace adaptiso::detail {
namespace fs = std::filesystem;

namespace {

/// \return false when a part is no finite number
bool parseNumbers(std::string_view text, std::vector<double>& numbers) {
    for (;;) {
        const std::size_t cut = text.find('\\');
        const auto value = parseNumber(text.substr(0, cut));
        if (!value || !std::isfinite(*value)) return false;
        numbers.push_back(*value);
        if (cut == std::string_view::npos) return true;
        text.remove_prefix(cut + 1);
    }
}

std::string_view nameOf(DicomTag tag) {
    constexpr std::pair<DicomTag, std::string_view> kNames[] = {
        {tag::kPixelSpacing, "PixelSpacing"},
        {tag::kImagePosition, "ImagePositionPatient"},
        {tag::kImageOrientation, "ImageOrientationPatient"},
        {tag::kRescaleSlope, "RescaleSlope"},
        {tag::kRescaleIntercept, "RescaleIntercept"},
        {tag::kSpacingBetweenSlices, "SpacingBetweenSlices"}};
    for (const auto& [known, name] : kNames) {
        if (known == tag) return name;
    }
    return "a value";
}

}  // namespace

std::string plainDicomText(std::string_view text) {
    std::string plain(trimmed(text.substr(0, text.find('\0'))));
    for (char& c : plain) {
        if (c < 0x20 || c == 0x7f) c = '?';
    }
    return plain;
}

std::optional<std::string_view> DicomDataset::text(DicomTag tag) const {
    const auto it = values.find(tag);
    if (it == values.end()) return std::nullopt;
    std::string_view value = it->second;
    value = value.substr(0, value.find('\0'));
    value = trimmed(value);
    if (value.empty()) return std::nullopt;
    return value;
}

std::vector<double> DicomDataset::numbers(const fs::path& file, DicomTag tag) const {
    std::vector<double> found;
    const auto whole = text(tag);
    if (whole && !parseNumbers(*whole, found)) {
        refuse(file, fmt::format("damaged DICOM header: {} is not a finite number", nameOf(tag)),
               "get the file again");
    }
    return found;
}

std::vector<double> DicomDataset::numbersIfAny(DicomTag tag) const {
    std::vector<double> found;
    const auto whole = text(tag);
    if (!whole || !parseNumbers(*whole, found)) return {};
    return found;
}

std::optional<std::int64_t> DicomDataset::integer(DicomTag tag) const {
    const auto whole = text(tag);
    return whole ? parseInteger(*whole) : std::nullopt;
}

const DicomDataset* DicomDataset::item(DicomTag sequence) const {
    const auto it = sequences.find(sequence);
    return it == sequences.end() || it->second.empty() ? nullptr : &it->second.front();
}

}  // namespace adaptiso::detail
