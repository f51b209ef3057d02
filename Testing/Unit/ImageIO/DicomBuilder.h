#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "adaptiso/Core/Volume.h"

namespace adaptiso::testing {

inline constexpr const char* kExplicitLittleEndian = "1.2.840.10008.1.2.1";
inline constexpr const char* kImplicitLittleEndian = "1.2.840.10008.1.2";
inline constexpr const char* kExplicitBigEndian = "1.2.840.10008.1.2.2";
inline constexpr const char* kDeflatedLittleEndian = "1.2.840.10008.1.2.1.99";
inline constexpr const char* kRleLossless = "1.2.840.10008.1.2.5";

/// Size of most test slices, pixels.
inline constexpr int kColumns = 4, kRows = 3;

/// A DICOM data set made element by element: (group << 16 | element) -> value. Setting an element
/// again replaces it; an empty text leaves it out.
class DicomBuilder {
public:
    /// \param vr  of text; two capitals
    DicomBuilder& text(std::uint32_t tag, const char* vr, const std::string& value);
    DicomBuilder& us(std::uint32_t tag, std::uint16_t value);
    DicomBuilder& ul(std::uint32_t tag, std::uint32_t value);
    DicomBuilder& fd(std::uint32_t tag, double value);
    DicomBuilder& sequence(std::uint32_t tag, std::vector<DicomBuilder> items);
    DicomBuilder& pixels(const std::vector<std::uint16_t>& samples);
    DicomBuilder& bytes(std::uint32_t tag, const char* vr, const std::string& value);
    /// Compressed pixel data. \param offsets  the basic offset table, may be empty
    DicomBuilder& fragments(const std::vector<std::string>& fragments,
                            const std::vector<std::uint32_t>& offsets = {});
    DicomBuilder& without(std::uint32_t tag);

    /// The whole file. \param transferSyntax  also decides how the data set is written
    std::string file(const std::string& transferSyntax = kExplicitLittleEndian) const;

private:
    struct Element {
        std::string vr;
        std::string bytes;  ///< of text and little-endian numbers
        std::size_t wordBytes = 1;
        std::vector<DicomBuilder> items;
        std::vector<std::string> fragments;
    };
    std::string dataset(const std::string& transferSyntax) const;

    std::map<std::uint32_t, Element> elements_;
};

/// An image without pixels or place: CT, 16 bits, series 1.2.3.4, `columns` x `rows`, with a
/// patient's name.
DicomBuilder dicomImage(int columns, int rows);

/// Sets position and orientation. Pixels are 0.5 mm between columns, 0.75 mm between rows.
void placeDicom(DicomBuilder& image, const Vec3& position, const Vec3& alongRow = {1, 0, 0},
                const Vec3& alongColumn = {0, 1, 0});

/// "1\2\3"
std::string dicomText(const Vec3& v);

/// Samples of a field at every pixel of a slice that placeDicom has placed.
using Field = std::function<double(const Vec3& pointMm)>;
std::vector<std::uint16_t> sampleSlice(const Field& field, int columns, int rows,
                                       const Vec3& position, const Vec3& alongRow = {1, 0, 0},
                                       const Vec3& alongColumn = {0, 1, 0});

/// One whole slice of the field, 4 x 3 pixels.
DicomBuilder fieldSlice(const Field& field, const Vec3& position, const Vec3& alongRow = {1, 0, 0},
                        const Vec3& alongColumn = {0, 1, 0});

/// A field that tells every place from every other; whole numbers at multiples of 0.25 mm.
double tellTale(const Vec3& pointMm);

/// Expects the field at every voxel's physical place: geometry and samples fit together.
/// \param tolerance  of the values
void expectField(const VolumeView& volume, const Field& field, double tolerance = 0);

}  // namespace adaptiso::testing
