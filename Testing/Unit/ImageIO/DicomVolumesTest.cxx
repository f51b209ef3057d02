#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <tuple>

#include "DicomBuilder.h"
#include "Fixtures.h"
#include "adaptiso/ImageIO/ListSeries.h"
#include "adaptiso/ImageIO/ReadVolume.h"

namespace adaptiso::testing {
namespace {

constexpr int kVolumeSlices = 3;

double fieldOfVolume(const Vec3& point, int volume) {
    return tellTale(point) + 100 * volume;
}

/// `volumes` volumes of 3 slices; `label` marks each slice with its volume. Names and instance
/// numbers are in no order, unless `label` sets one.
using Label = std::function<void(DicomBuilder&, int volume, int slice)>;
void writeVolumes(const TempFolder& folder, int volumes, const Label& label) {
    for (int v = 0; v < volumes; ++v) {
        for (int k = 0; k < kVolumeSlices; ++k) {
            DicomBuilder image =
                fieldSlice([v](const Vec3& p) { return fieldOfVolume(p, v); }, {1, 2, 3.0 + 2 * k});
            image.text(0x00200013, "IS", std::to_string((v * kVolumeSlices + k) * 5 % 7));
            label(image, v, k);
            writeFile(folder / std::to_string((v * kVolumeSlices + k) * 7 % 37), image.file());
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
        EXPECT_EQ(read.volume.view().geometry().size[2], kVolumeSlices);
        expectField(read.volume, [v](const Vec3& p) { return fieldOfVolume(p, v); });
    }
    for (const int none : {volumes, -1}) {
        expectRefusal(folder.path(), "there is no volume " + std::to_string(none) + ": it holds",
                      {.volumeIndex = none});
    }
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
            const int number = isInterleaved ? 3 * k + v : kVolumeSlices * v + k;
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
    EXPECT_NE(message.find("2: CT, 3 slices"), std::string::npos) << message;
    const ReadVolume magnitude = readVolume(folder.path(), {.series = "1"});
    expectField(magnitude.volume, [](const Vec3& p) { return fieldOfVolume(p, 0); });
    const ReadVolume phase = readVolume(folder.path(), {.series = "2"});
    expectField(phase.volume, [](const Vec3& p) { return fieldOfVolume(p, 1); });
}

TEST(DicomVolumes, OneVolumeIsVolumeZero) {
    const TempFolder folder;
    writeVolumes(folder, 1, [](DicomBuilder&, int, int) {});
    EXPECT_NO_THROW(readVolume(folder.path(), {.volumeIndex = 0}));
    expectRefusal(folder.path(), "there is no volume 1: it holds 1; leave --volume-index out",
                  {.volumeIndex = 1});
}

TEST(DicomVolumes, ImageTypesMayDifferWithinOneVolume) {
    const TempFolder folder;
    writeVolumes(folder, 1, [](DicomBuilder& image, int, int k) {
        image.text(0x00080008, "CS", k ? "ORIGINAL\\PRIMARY\\AXIAL" : "ORIGINAL\\PRIMARY\\OTHER");
    });
    EXPECT_EQ(readVolume(folder.path()).volume.view().geometry().size[2], kVolumeSlices);
}

// ---- passes over the same places in one series, with numbers and times as scanners leave them

constexpr int kPlaces = 6;

void writePasses(const TempFolder& folder, int passes, const Label& label) {
    for (int v = 0; v < passes; ++v) {
        for (int k = 0; k < kPlaces; ++k) {
            DicomBuilder image =
                fieldSlice([v](const Vec3& p) { return fieldOfVolume(p, v); }, {1, 2, 3.0 + 2 * k});
            label(image, v, k);
            writeFile(folder / std::to_string(v * kPlaces + k), image.file());
        }
    }
}

void number(DicomBuilder& image, int value) {
    image.text(0x00200013, "IS", std::to_string(value));
}

void time(DicomBuilder& image, int minute, int second) {
    char text[20];
    std::snprintf(text, sizeof text, "12%02d%02d.5", minute, second);
    image.text(0x00080032, "TM", text);
}

void expectPasses(int passes, std::string_view kind, const Label& label) {
    const TempFolder folder;
    writePasses(folder, passes, label);
    const std::string message = refusalOf(folder.path());
    EXPECT_NE(message.find(kind), std::string::npos) << message;
    for (int v = 0; v < passes; ++v) {
        const ReadVolume read = readVolume(folder.path(), {.volumeIndex = v});
        ASSERT_EQ(read.volume.view().geometry().size[2], kPlaces);
        expectField(read.volume, [v](const Vec3& p) { return fieldOfVolume(p, v); });
    }
}

void expectRefusedPasses(int passes, const Label& label) {
    const TempFolder folder;
    writePasses(folder, passes, label);
    for (std::int64_t v = 0; v < passes; ++v) {
        expectRefusal(folder.path(), "at the same position", {.volumeIndex = v});
        expectRefusal(folder.path(), "at the same position",
                      {.volumeIndex = v, .resampleSlices = true});
    }
    EXPECT_FALSE(listSeries(folder.path()).series.at(0).isReadable());
}

/// The second pass goes on for half its way and then backwards, below all others.
int turnedNumber(int v, int k) {
    return v == 0 ? k + 1 : k < kPlaces / 2 ? kPlaces + k + 1 : -k;
}

TEST(DicomPasses, ThatMixedNumbersWouldMixAreRefused) {
    expectRefusedPasses(2, [](DicomBuilder& image, int v, int k) {
        number(image, v == 0 ? k + 1 : kPlaces - k);  // restarted and reversed
    });
    expectRefusedPasses(
        2, [](DicomBuilder& image, int v, int k) { number(image, turnedNumber(v, k)); });
    expectRefusedPasses(2, [](DicomBuilder& image, int v, int k) {
        number(image, v == 0 || k < kPlaces / 2 ? v * kPlaces + k + 1 : k - 2 * kPlaces);
    });
    expectRefusedPasses(2, [](DicomBuilder& image, int v, int k) {
        number(image, v == 0 ? 2 * k + 1 : 2 * (kPlaces - k));  // odd up, even down
    });
    expectRefusedPasses(3, [](DicomBuilder& image, int v, int k) {
        number(image, v == 2 ? kPlaces - k : v * kPlaces + k + 1);
    });
    expectRefusedPasses(2, [](DicomBuilder& image, int, int k) { number(image, k + 1); });
    expectRefusedPasses(2, [](DicomBuilder&, int, int) {});
}

TEST(DicomPasses, WhoseNumbersOnlyLookLikePassesAreRefused) {
    // the second is 6 ahead at first and 6 behind then: halves of both run alike
    expectRefusedPasses(2, [](DicomBuilder& image, int v, int k) {
        number(image, k + (v == 0 ? 0 : k < 3 ? 6 : -6));
    });
    expectRefusedPasses(2, [](DicomBuilder& image, int v, int k) {
        number(image, 2 * k + (v == 0 ? 0 : k < 3 ? 1 : -1));
    });
}

TEST(DicomPasses, AreToldApartByTheirTimes) {
    expectPasses(2, "acquisition times", [](DicomBuilder& image, int v, int k) {
        number(image, turnedNumber(v, k));
        time(image, 0, 30 * v);
    });
    expectPasses(3, "acquisition times", [](DicomBuilder& image, int v, int k) {
        number(image, k + 1);
        time(image, v, v == 1 ? 50 - k : k);  // the second backwards
    });
    expectRefusedPasses(2, [](DicomBuilder& image, int v, int k) {
        time(image, v == 0 ? 1 : k < kPlaces / 2 ? 2 : 0, k);  // neither is the earlier one
    });
}

TEST(DicomPasses, AreToldApartByNumbersThatGoOn) {
    expectPasses(2, "images at every position", [](DicomBuilder& image, int v, int k) {
        number(image, v == 0 ? k + 1 : 2 * kPlaces - k);  // the second backwards
    });
    for (const bool isInterleaved : {false, true}) {
        expectPasses(3, "images at every position", [=](DicomBuilder& image, int v, int k) {
            number(image, isInterleaved ? 3 * k + v : v * kPlaces + k);
        });
    }
}

TEST(DicomPasses, WhoseHeadersContradictAreRefused) {
    expectRefusedPasses(2, [](DicomBuilder& image, int v, int k) {
        number(image, v * kPlaces + k + 1);
        image.text(0x00200012, "IS", std::to_string((v + (k < 2)) % 2));
    });
    expectRefusedPasses(2, [](DicomBuilder& image, int v, int k) {
        time(image, v, 0);
        image.text(0x00200012, "IS", std::to_string((v + (k < 2)) % 2));
    });
    expectRefusedPasses(2, [](DicomBuilder& image, int v, int k) {
        number(image, v * kPlaces + k * 2 % kPlaces + k * 2 / kPlaces);
        image.text(0x00200012, "IS", std::to_string((v + (k < 2)) % 2));
    });
}

TEST(DicomPasses, PartlyRepeatedOnesAreRefused) {
    for (const int missing : {1, 4}) {
        const TempFolder folder;
        writePasses(folder, 2, [](DicomBuilder& image, int v, int k) {
            number(image, v * kPlaces + k + 1);
            time(image, v, k);
        });
        for (int n = 0; n < missing; ++n) {
            std::filesystem::remove(folder / std::to_string(2 * kPlaces - 1 - n));
        }
        expectRefusal(folder.path(), "same position", {.volumeIndex = 0});
    }
}

TEST(DicomPasses, NearlyAtTheSamePlacesAreNotBlended) {
    const TempFolder folder;
    for (int k = 0; k < kPlaces; ++k) {
        writeFile(folder / std::to_string(k), fieldSlice(tellTale, {0, 0, 2.0 * k}).file());
    }
    writeFile(folder / "again", fieldSlice(tellTale, {0, 0, 4.02}).file());
    expectRefusal(folder.path(), "nearly the same position", {.resampleSlices = true});
}

/// Every other slice with `tag` replaced.
void writeInterleaved(const TempFolder& folder, std::uint32_t tag, const char* vr) {
    for (int k = 0; k < 2 * kPlaces; ++k) {
        DicomBuilder image = fieldSlice(tellTale, {1, 2, 3.0 + 2 * k});
        image.text(0x0020000D, "UI", "1.2.77").text(0x00200052, "UI", "1.2.88");
        image.text(0x00100020, "LO", "Secret1");
        if (k % 2) image.text(tag, vr, vr == std::string("DA") ? "19700102" : "1.2.Secret2");
        writeFile(folder / std::to_string(k), image.file());
    }
}

TEST(DicomSubjects, InterleavedInOneSeriesAreGroups) {
    const std::vector<std::tuple<std::uint32_t, const char*, std::string>> kinds{
        {0x00100020, "LO", "Patient"},
        {0x00100010, "PN", "Patient"},
        {0x00100030, "DA", "Patient"},
        {0x0020000D, "UI", "Study"},
        {0x00200052, "UI", "FrameOfReference"}};
    for (const auto& [tag, vr, keyword] : kinds) {
        const TempFolder folder;
        writeInterleaved(folder, tag, vr);
        const std::string message = refusalOf(folder.path());
        EXPECT_NE(message.find("2 groups of slices that differ"), std::string::npos) << message;
        EXPECT_NE(message.find(", " + keyword + " 1; 2: "), std::string::npos) << message;
        EXPECT_NE(message.find(", " + keyword + " 2)"), std::string::npos) << message;
        for (const char* secret : {"Secret", "1.2.77", "1.2.88", "1970"}) {
            EXPECT_EQ(message.find(secret), std::string::npos) << message;
        }
        for (const char* series : {"1", "2"}) {
            const ReadVolume read = readVolume(folder.path(), {.series = series});
            EXPECT_EQ(read.volume.view().geometry().size[2], kPlaces);
            expectField(read.volume, tellTale);
        }
        const DicomListing listing = listSeries(folder.path());
        ASSERT_EQ(listing.series.size(), 2U);
        EXPECT_EQ(listing.series[1].details,
                  (std::vector<std::pair<std::string, std::string>>{{keyword, "2"}}));
    }
}

TEST(DicomSubjects, OneSliceOfAnotherPatientIsNotLeftAside) {
    const TempFolder folder;
    for (int k = 0; k < kPlaces; ++k) {
        DicomBuilder image = fieldSlice(tellTale, {1, 2, 3.0 + 2 * k});
        image.text(0x00100020, "LO", k == kPlaces - 1 ? "B" : "A");
        writeFile(folder / std::to_string(k), image.file());
    }
    expectRefusal(folder.path(), "patient");
}

TEST(DicomGroups, OfSeveralKernelsAreListedWithThem) {
    const TempFolder folder;
    writeVolumes(folder, 2, [](DicomBuilder& image, int v, int) {
        image.text(0x00181210, "SH", v ? "B70s" : "B30f").text(0x00200011, "IS", v ? "5" : "4");
        image.text(0x00180081, "DS", v ? "10" : "2.5");
    });
    const DicomListing listing = listSeries(folder.path());
    ASSERT_EQ(listing.series.size(), 2U);
    EXPECT_EQ(listing.series[0].details,
              (std::vector<std::pair<std::string, std::string>>{
                  {"SeriesNumber", "4"}, {"ConvolutionKernel", "B30f"}, {"EchoTime", "2.5"}}));
    const std::string message = refusalOf(folder.path());
    EXPECT_NE(message.find("SeriesNumber 5, ConvolutionKernel B70s, EchoTime 10"),
              std::string::npos)
        << message;
    expectField(readVolume(folder.path(), {.series = "2"}).volume,
                [](const Vec3& p) { return fieldOfVolume(p, 1); });
}

/// Slices that each have a series UID of their own.
void writeLoneSlices(const TempFolder& folder,
                     const std::function<void(DicomBuilder&, int)>& change) {
    for (int k = 0; k < kPlaces; ++k) {
        DicomBuilder image = fieldSlice(tellTale, {1, 2, 3.0 + 2 * k});
        number(image, k + 1);
        image.text(0x0020000E, "UI", "1.2.3." + std::to_string(k))
            .text(0x00200011, "IS", "4")
            .text(0x0020000D, "UI", "1.2.77")
            .text(0x00200052, "UI", "1.2.88");
        change(image, k);
        writeFile(folder / std::to_string(k), image.file());
    }
}

TEST(DicomLoneSlices, AreOneSeriesWhereAllElseAgrees) {
    const TempFolder folder;
    writeLoneSlices(folder, [](DicomBuilder&, int) {});
    const ReadVolume read = readVolume(folder.path());
    EXPECT_EQ(read.volume.view().geometry().size[2], kPlaces);
    expectField(read.volume, tellTale);
    ASSERT_EQ(read.warnings.size(), 1U);
    EXPECT_NE(read.warnings[0].text.find("each of its 6 slices has a SeriesInstanceUID of its own"),
              std::string::npos);
    EXPECT_EQ(listSeries(folder.path()).series.size(), 1U);
}

TEST(DicomLoneSlices, OfOneSeriesMayHaveStudiesAndFramesOfTheirOwn) {
    for (const std::uint32_t tag : {0x0020000D, 0x00200052}) {
        const TempFolder folder;
        writeLoneSlices(folder, [&](DicomBuilder& image, int k) {
            image.text(0x0020000E, "UI", "1.2.3").text(tag, "UI", "1.2.6." + std::to_string(k));
        });
        const ReadVolume read = readVolume(folder.path());
        expectField(read.volume, tellTale);
        EXPECT_EQ(read.warnings.size(), 1U);
    }
}

TEST(DicomLoneSlices, AreRefusedInOneLineWhereMoreDiffers) {
    const std::vector<std::function<void(DicomBuilder&, int)>> changes{
        [](DicomBuilder& image, int k) {
            image.text(0x0020000D, "UI", "1.2.77." + std::to_string(k));
        },
        [](DicomBuilder& image, int k) { image.text(0x00200011, "IS", std::to_string(k)); },
        [](DicomBuilder& image, int) { image.without(0x00200052); },
        [](DicomBuilder& image, int) { image.without(0x00200011); },
        [](DicomBuilder& image, int) { number(image, 1); }};
    for (const auto& change : changes) {
        const TempFolder folder;
        writeLoneSlices(folder, change);
        expectRefusal(folder.path(), "each of its 6 slices has a SeriesInstanceUID of its own");
    }
}

TEST(DicomRepeats, ACopiedSliceIsRefusedAndNamed) {
    const TempFolder folder;
    writeVolumes(folder, 1, [](DicomBuilder&, int, int) {});
    std::filesystem::copy_file(folder / "7", folder / "copy of 7");
    const std::string message = refusalOf(folder.path());
    EXPECT_NE(
        message.find("1 of 3 positions; first: position 2, file 3 (by name) and file 4 (by name)"),
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

TEST(DicomRepeats, ExactCopiesOfFilesAreLeftOut) {
    const TempFolder folder;
    writeVolumes(folder, 1, [](DicomBuilder& image, int, int k) {
        image.text(0x00080018, "UI", "1.2.9." + std::to_string(k));
    });
    std::filesystem::create_directory(folder / "copy");
    for (const char* name : {"0", "7"}) {
        std::filesystem::copy_file(folder / name, folder / (std::string("copy/") + name));
    }
    const ReadVolume read = readVolume(folder.path());
    expectField(read.volume, tellTale);
    EXPECT_EQ(linesOf(read.warnings),
              std::vector<std::string>{"left out 2 files that are exact copies of "
                                       "others"});
    // the same instance with other pixels is no copy
    DicomBuilder image = fieldSlice(tellTale, {1, 2, 5});
    image.text(0x00080018, "UI", "1.2.9.1").pixels(std::vector<std::uint16_t>(12, 9));
    writeFile(folder / "copy/7", image.file());
    expectRefusal(folder.path(), "1 of 3 positions");
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
    EXPECT_EQ(listing.series[0].slices, kVolumeSlices);
    EXPECT_TRUE(listing.series[0].isReadable());
}

}  // namespace
}  // namespace adaptiso::testing
