#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <utility>

#include "ZarrFolder.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;
using namespace testing;

/// time, channel, z, y, x of an OME-Zarr: two time points and channels of whole chunks.
class OmeZarrTest : public ZarrFolder {
protected:
    void putLevel(const std::string& path, int time, int channel) const {
        put(path + "/.zarray",
            R"({"zarr_format": 2, "shape": [2, 3, 5, 6, 7], "chunks": [1, 1, 4, 4, 4],
                "dtype": "<i2", "order": "C", "fill_value": 0, "filters": null,
                "compressor": null, "dimension_separator": "/"})");
        putChunks(path + "/" + std::to_string(time) + "/" + std::to_string(channel) + "/", "/",
                  same);
    }
    static Text multiscales(const std::string& version, const std::string& unit = "micrometer") {
        const std::string space = R"(, "type": "space", "unit": ")" + unit + R"("})";
        return R"([{)" + version + R"("axes": [{"name": "t", "type": "time"},
            {"name": "c", "type": "channel"}, {"name": "z")" +
               space + R"(, {"name": "y")" + space + R"(, {"name": "x")" + space + R"(],
            "datasets": [
              {"path": "0", "coordinateTransformations": [
                 {"type": "scale", "scale": [1, 1, 3, 2, 1]},
                 {"type": "translation", "translation": [0, 0, 30, 20, 10]}]},
              {"path": "deep/1", "coordinateTransformations": [
                 {"type": "scale", "scale": [1, 1, 6, 4, 2]}]}],
            "coordinateTransformations": [{"type": "scale", "scale": [1, 1, 10, 10, 10]}]}])";
    }
    static ReadOptions at(int time, int channel, std::optional<std::int64_t> level = {}) {
        ReadOptions options;
        options.timePoint = time;
        options.channel = channel;
        options.level = level;
        return options;
    }
};

TEST_F(OmeZarrTest, Version04HasItsLevelsChannelsTimesAndUnits) {
    put(".zattrs", R"({"multiscales": )" + multiscales(R"("version": "0.4", )") + "}");
    put(".zgroup", R"({"zarr_format": 2})");
    putLevel("0", 1, 2);
    putLevel("deep/1", 0, 1);
    const ReadVolume read = readVolume(root_, at(1, 2));
    expectValues(read, at(1, 2));
    EXPECT_EQ(read.format, "OME-Zarr 0.4");
    // micrometres: 10 times (3, 2, 1), and of the translation
    const ImageGeometry& geometry = read.volume.view().geometry();
    EXPECT_NEAR(geometry.spacingMm()[0], 0.01, 1e-15);
    EXPECT_NEAR(geometry.spacingMm()[2], 0.03, 1e-15);
    EXPECT_NEAR(geometry.originMm[0], 0.1, 1e-15);
    EXPECT_NEAR(geometry.originMm[2], 0.3, 1e-15);
    const ReadVolume coarse = readVolume(root_, at(0, 1, 1));
    expectValues(coarse, at(0, 1, 1));
    EXPECT_NEAR(coarse.volume.view().geometry().spacingMm()[1], 0.04, 1e-15);
    EXPECT_EQ(coarse.volume.view().geometry().originMm[0], 0);

    expectRefused("holds 2 time points; choose one, 0 to 1 (--time)");
    expectRefused("there is no channel 3: it holds 3; choose one, 0 to 2 (--channel)", at(0, 3));
    expectRefused("there is no level 2: it holds 2; choose one, 0 to 1 (--level)", at(0, 1, 2));
}

TEST_F(OmeZarrTest, Version05LiesInTheAttributes) {
    put("zarr.json", R"({"zarr_format": 3, "node_type": "group", "attributes": {"ome":
        {"version": "0.5", "multiscales": )" +
                         multiscales("") + "}}}");
    putLevel("0", 1, 2);
    const ReadVolume read = readVolume(root_, at(1, 2));
    expectValues(read, at(1, 2));
    EXPECT_EQ(read.format, "OME-Zarr 0.5");
}

TEST_F(OmeZarrTest, OtherVersionsUnitsAndPathsAreRefusedByName) {
    const std::pair<std::string, std::string> wrong[] = {
        {R"({"multiscales": )" + multiscales(R"("version": "0.3", )") + "}", "OME-Zarr 0.3"},
        {R"({"multiscales": )" + multiscales("", "furlong") + "}", "unit 'furlong'"},
        {R"({"bioformats2raw.layout": 3})", "holds several images"},
        {R"({"multiscales": []})", "multiscales is no list"},
        {R"({"multiscales": [{"axes": [{"name": "x", "type": "space"}],
             "datasets": [{"path": "../0"}]}]})",
         "leads out of it"},
        {R"({"multiscales": [{"axes": [{"name": "x", "type": "space"}], "datasets": [{"path": "0",
             "coordinateTransformations": [{"type": "affine"}]}]}]})",
         "transformation affine"},
        {R"({"x": 1})", "is a group of Zarr that is no image"}};
    for (const auto& [text, reason] : wrong) {
        SCOPED_TRACE(reason);
        put(".zattrs", text);
        expectRefused(reason);
    }
    fs::remove_all(root_);
    put("zarr.json", R"({"zarr_format": 3, "node_type": "group", "attributes": {"ome":
        {"version": "0.6.dev3", "multiscales": []}}})");
    expectRefused("OME-Zarr 0.6.dev3");
}

TEST_F(OmeZarrTest, UnitsOfSomeAxesOnlyAreRefused) {
    Text some = multiscales(R"("version": "0.4", )");
    some.replace(some.find(R"(, "unit": "micrometer")"), Text(R"(, "unit": "micrometer")").size(),
                 "");
    put(".zattrs", R"({"multiscales": )" + some + "}");
    put(".zgroup", R"({"zarr_format": 2})");
    putLevel("0", 1, 2);
    expectRefused("some of its axes in space have a unit, others none", at(1, 2));
}

TEST_F(OmeZarrTest, WithoutScaleOrUnitTheyAreGuessedWithAWarning) {
    const auto codes = [&] {
        std::vector<std::string> found;
        for (const Warning& warning : readVolume(root_, at(1, 2)).warnings) {
            found.push_back(warning.code);
        }
        return found;
    };
    putLevel("0", 1, 2);
    put(".zgroup", R"({"zarr_format": 2})");
    for (const char* const blank : {"", " ", "\\t ", "pixel"}) {
        put(".zattrs", R"({"multiscales": )" + multiscales(R"("version": "0.4", )", blank) + "}");
        EXPECT_EQ(codes(), (std::vector<std::string>{"guessed-unit", "guessed-orientation"}))
            << blank;
    }
    put(".zattrs", R"({"multiscales": [{"version": "0.4", "axes": [{"name": "t", "type": "time"},
        {"name": "c", "type": "channel"}, {"name": "z", "type": "space", "unit": "millimeter"},
        {"name": "y", "type": "space", "unit": "millimeter"},
        {"name": "x", "type": "space", "unit": "millimeter"}], "datasets": [{"path": "0"}]}]})");
    EXPECT_EQ(codes(), (std::vector<std::string>{"guessed-spacing", "guessed-orientation"}));
    ReadOptions ras = at(1, 2);
    ras.space = ImageSpace::Ras;
    const ReadVolume read = readVolume(root_, ras);
    EXPECT_EQ(read.volume.view().geometry().indexToPhysical, Mat3::diagonal(-1, -1, 1));
    ASSERT_EQ(read.warnings.size(), 1U);
    EXPECT_EQ(read.warnings[0].code, "guessed-spacing");
}

}  // namespace
}  // namespace adaptiso
