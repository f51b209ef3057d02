#include <gtest/gtest.h>

#include <algorithm>

#include "DicomBuilder.h"
#include "Fixtures.h"
#include "adaptiso/ImageIO/ListSeries.h"
#include "adaptiso/ImageIO/ReadVolume.h"

namespace adaptiso::testing {
namespace {

constexpr int kSlices = 3;

double fieldOfVolume(const Vec3& point, int volume) {
    return tellTale(point) + 100 * volume;
}

/// `volumes` volumes of 3 slices; `label` marks each slice with its volume. Names and instance
/// numbers are in no order, unless `label` sets one.
using Label = std::function<void(DicomBuilder&, int volume, int slice)>;
void writeVolumes(const TempFolder& folder, int volumes, const Label& label) {
    for (int v = 0; v < volumes; ++v) {
        for (int k = 0; k < kSlices; ++k) {
            DicomBuilder image =
                fieldSlice([v](const Vec3& p) { return fieldOfVolume(p, v); }, {1, 2, 3.0 + 2 * k});
            image.text(0x00200013, "IS", std::to_string((v * kSlices + k) * 5 % 7));
            label(image, v, k);
            writeFile(folder / std::to_string((v * kSlices + k) * 7 % 37), image.file());
        }
    }
}

void expectVolumes(const TempFolder& folder, int volumes, std::string_view kind) {
    const std::string message = refusalOf(folder.path());
    EXPECT_NE(message.find("4-D image: " + std::to_string(volumes) + " volumes"), std::string::npos)
        << message;
    EXPECT_NE(message.find(kind), std::string::npos) << message;
    EXPECT_NE(message.find("--volume-index 0 to " + std::to_string(volumes - 1)), std::string::npos)
        << message;
    for (int v = 0; v < volumes; ++v) {
        const ReadVolume read = readVolume(folder.path(), {.volumeIndex = v});
        EXPECT_EQ(read.volume.view().geometry().size[2], kSlices);
        expectField(read.volume, [v](const Vec3& p) { return fieldOfVolume(p, v); });
    }
    expectRefusal(folder.path(), "4-D", {.volumeIndex = volumes});
    expectRefusal(folder.path(), "4-D", {.volumeIndex = -1});
}

TEST(DicomVolumes, AreToldApartByEcho) {
    const TempFolder folder;
    writeVolumes(folder, 3, [](DicomBuilder& image, int v, int) {
        image.text(0x00180086, "IS", std::to_string(v + 1));
        image.text(0x00180081, "DS", std::to_string(2 + 8 * v));  // 10 comes after 2, as a number
    });
    expectVolumes(folder, 3, "echoes");
}

TEST(DicomVolumes, AreToldApartByTemporalPosition) {
    const TempFolder folder;
    writeVolumes(folder, 12, [](DicomBuilder& image, int v, int) {
        image.text(0x00200100, "IS", std::to_string(v + 1));
    });
    expectVolumes(folder, 12, "time points");
}

TEST(DicomVolumes, AreToldApartByAcquisition) {
    const TempFolder folder;
    writeVolumes(folder, 2, [](DicomBuilder& image, int v, int) {
        image.text(0x00200012, "IS", std::to_string(v + 1));
    });
    expectVolumes(folder, 2, "acquisitions");
}

TEST(DicomVolumes, AreToldApartByDiffusionWeighting) {
    const TempFolder folder;
    writeVolumes(folder, 2,
                 [](DicomBuilder& image, int v, int) { image.fd(0x00189087, 1000.0 * v); });
    expectVolumes(folder, 2, "diffusion weightings");
}

TEST(DicomVolumes, AreToldApartByTwoAttributesTogether) {
    const TempFolder folder;
    writeVolumes(folder, 4, [](DicomBuilder& image, int v, int) {
        image.text(0x00180086, "IS", std::to_string(v / 2 + 1));
        image.text(0x00200100, "IS", std::to_string(v % 2 + 1));
    });
    expectVolumes(folder, 4, "volumes");
}

TEST(DicomVolumes, AreToldApartByInstanceNumbersWhenNothingElseDoes) {
    for (const bool isInterleaved : {false, true}) {
        const TempFolder folder;
        writeVolumes(folder, 3, [&](DicomBuilder& image, int v, int k) {
            const int number = isInterleaved ? 3 * k + v : kSlices * v + k;
            image.text(0x00200013, "IS", std::to_string(number + 1));
        });
        expectVolumes(folder, 3, "volumes");
    }
}

TEST(DicomVolumes, MagnitudeAndPhaseAreTwoSeriesOfTheList) {
    const TempFolder folder;
    writeVolumes(folder, 2, [](DicomBuilder& image, int v, int) {
        image.text(0x00080008, "CS", v ? "ORIGINAL\\PRIMARY\\P\\ND" : "ORIGINAL\\PRIMARY\\M\\ND");
    });
    const std::string message = refusalOf(folder.path());
    EXPECT_NE(message.find("2: 3 slices"), std::string::npos) << message;
    const ReadVolume magnitude = readVolume(folder.path(), {.series = "1"});
    expectField(magnitude.volume, [](const Vec3& p) { return fieldOfVolume(p, 0); });
    const ReadVolume phase = readVolume(folder.path(), {.series = "2"});
    expectField(phase.volume, [](const Vec3& p) { return fieldOfVolume(p, 1); });
}

TEST(DicomVolumes, OneVolumeIsVolumeZero) {
    const TempFolder folder;
    writeVolumes(folder, 1, [](DicomBuilder&, int, int) {});
    EXPECT_NO_THROW(readVolume(folder.path(), {.volumeIndex = 0}));
    expectRefusal(folder.path(), "holds one volume", {.volumeIndex = 1});
}

TEST(DicomVolumes, ImageTypesMayDifferWithinOneVolume) {
    const TempFolder folder;
    writeVolumes(folder, 1, [](DicomBuilder& image, int, int k) {
        image.text(0x00080008, "CS", k ? "ORIGINAL\\PRIMARY\\AXIAL" : "ORIGINAL\\PRIMARY\\OTHER");
    });
    EXPECT_EQ(readVolume(folder.path()).volume.view().geometry().size[2], kSlices);
}

TEST(DicomRepeats, ACopiedSliceIsRefusedAndNamed) {
    const TempFolder folder;
    writeVolumes(folder, 1, [](DicomBuilder&, int, int) {});
    std::filesystem::copy_file(folder / "7", folder / "copy of 7");
    const std::string message = refusalOf(folder.path());
    EXPECT_NE(message.find("1 of 3 positions; first: position 2, 7 and copy of 7"),
              std::string::npos)
        << message;
}

TEST(DicomRepeats, ACopiedSeriesIsNotTakenForTwoVolumes) {
    const TempFolder folder;
    writeVolumes(folder, 1, [](DicomBuilder&, int, int) {});
    std::filesystem::create_directory(folder / "copy");
    for (const char* name : {"0", "7", "14"}) {
        std::filesystem::copy_file(folder / name, folder / (std::string("copy/") + name));
    }
    expectRefusal(folder.path(), "3 of 3 positions", {.volumeIndex = 0});
}

TEST(DicomRepeats, AnIncompleteLastVolumeIsRefused) {
    const TempFolder folder;
    writeVolumes(folder, 2, [](DicomBuilder& image, int v, int) {
        image.text(0x00200100, "IS", std::to_string(v + 1));
    });
    std::filesystem::remove(folder / std::to_string(5 * 7 % 37));  // volume 1, slice 2
    expectRefusal(folder.path(), "same position", {.volumeIndex = 0});
}

TEST(DicomRepeats, AllImagesAtOnePlaceAreNoVolume) {
    const TempFolder folder;
    for (int v = 0; v < 4; ++v) {
        DicomBuilder image = fieldSlice(tellTale, {0, 0, 0});
        image.text(0x00200013, "IS", std::to_string(v));
        writeFile(folder / std::to_string(v), image.file());
    }
    expectRefusal(folder.path(), "all of its 4 slices lie at the same position");
}

TEST(ListSeries, CountsVolumes) {
    const TempFolder folder;
    writeVolumes(folder, 3, [](DicomBuilder& image, int v, int) {
        image.text(0x00180086, "IS", std::to_string(v + 1));
    });
    const DicomListing listing = listSeries(folder.path());
    ASSERT_EQ(listing.series.size(), 1U);
    EXPECT_EQ(listing.series[0].volumes, 3);
    EXPECT_EQ(listing.series[0].slices, kSlices);
    EXPECT_TRUE(listing.series[0].isReadable());
}

}  // namespace
}  // namespace adaptiso::testing
