// `tessera batch --reference`: exit code 3, pictures of the differences, and a page for people that stands alone: read
// as text, and by a browser where there is one.
#include "cli/run_command.h"

#include <tessera/image.h>

#include <simdjson.h>
#include <sys/stat.h>

#include <cstring>
#include <span>

namespace {

namespace fs = std::filesystem;
using Strings = std::vector<std::string>;

Strings operator+(Strings a, const Strings& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

int count(const std::string& text, const std::string& part) {
    int found = 0;
    for (std::size_t at = 0; (at = text.find(part, at)) != std::string::npos; at += part.size()) ++found;
    return found;
}

class CliComparison : public CliTest {
  protected:
    void SetUp() override {
        CliTest::SetUp();
        if (IsSkipped()) return;
        ASSERT_EQ(batch(Strings{"-o", in_folder("ref/{model}.png")}).code, 0);
    }
    Outcome batch(const Strings& more) const {
        return run_command(Strings{"batch", scene("cornell-box.gltf"), scene("hierarchy.gltf"), scene("materials.gltf"),
                                   scene("spheres.gltf"), "-q", "-s", "64x48", "--samples", "1"} +
                           more);
    }
    Outcome compare(const Strings& more = {}) const {
        return batch(Strings{"-o", in_folder("out/{model}.png"), "--reference", in_folder("ref"), "--report",
                             in_folder("run.json")} +
                     more);
    }
    // Changes the first pixels of a reference by `step` levels of green.
    void change(const std::string& name, int pixels, int step) const {
        tessera::Image image = tessera::read_image(in_folder("ref/" + name));
        for (int i = 0; i < pixels; ++i) {
            std::uint8_t& green = image.data<std::uint8_t>()[4 * i + 1];
            green = static_cast<std::uint8_t>(green < 128 ? green + step : green - step);
        }
        tessera::write_image(in_folder("ref/" + name), image);
    }
    simdjson::dom::element picture(std::size_t scene) {
        report_ = parser_.load(in_folder("run.json"));
        return report_["scenes"].at(scene)["pictures"].at(0);
    }
    std::string page() const { return read_file(in_folder("out/comparison.html")); }
    // One of each kind of difference, in one page.
    void make_one_of_each() const {
        change("cornell-box.png", 30, 100);
        change("hierarchy.png", 300, 200);
        tessera::write_image(in_folder("ref/materials.png"), tessera::Image(8, 8, tessera::PixelFormat::kRgba8));
        fs::remove(folder_ / "ref/spheres.png");
    }

    simdjson::dom::parser parser_;
    simdjson::dom::element report_;
};

TEST_F(CliComparison, BEY1_EqualPicturesPass) {
    const Outcome run = compare();
    EXPECT_EQ(run.code, 0) << run.err;
    EXPECT_NE(page().find("all 4 pictures pass"), std::string::npos);
    EXPECT_FALSE(fs::exists(folder_ / "out/differences"));
    EXPECT_EQ(std::string_view(picture(0)["comparison"]["verdict"]), "equal");
}

TEST_F(CliComparison, BEY1_DifferencesAreCountedAndDrawn) {
    change("hierarchy.png", 5, 9);
    ASSERT_EQ(compare().code, 3);
    const auto comparison = picture(1)["comparison"];
    EXPECT_EQ(std::string_view(comparison["verdict"]), "different");
    EXPECT_EQ(std::uint64_t(comparison["differing_pixels"]), 5u);
    EXPECT_EQ(std::uint64_t(comparison["pixels"]), 64u * 48);
    EXPECT_EQ(double(comparison["max_error"]), 9);
    EXPECT_DOUBLE_EQ(double(comparison["mean_error"]), 5 * 9.0 / (64 * 48 * 4));
    // Red where they differ, grey elsewhere.
    const tessera::Image d = tessera::read_image(in_folder("out/differences/hierarchy.png.difference.png"));
    int red = 0;
    for (int i = 0; i < 64 * 48; ++i) {
        const auto* p = d.data<std::uint8_t>() + 4 * i;
        red += p[0] != p[1] || p[1] != p[2];
    }
    EXPECT_EQ(red, 5);
    EXPECT_EQ(compare({"--tolerance", "8.9"}).code, 3);
    EXPECT_EQ(compare({"--max-differing", "4"}).code, 3);
    EXPECT_EQ(compare({"--tolerance", "9"}).code, 0);
    EXPECT_EQ(compare({"--max-differing", "5"}).code, 0);
    EXPECT_EQ(std::string_view(picture(1)["comparison"]["verdict"]), "within");
    // What was there already is compared, too.
    EXPECT_EQ(compare({"--skip-existing"}).code, 3);
}

TEST_F(CliComparison, BEY1_JpegsAreComparedAsWritten) {
    const Strings jpeg{"-o", in_folder("j/{model}.jpg"), "--quality", "60"};
    ASSERT_EQ(batch(jpeg).code, 0);
    fs::rename(folder_ / "j", folder_ / "jref");
    EXPECT_EQ(batch(jpeg + Strings{"--reference", in_folder("jref")}).code, 0);
    EXPECT_EQ(
        batch(Strings{"-o", in_folder("j/{model}.jpg"), "--quality", "20", "--reference", in_folder("jref")}).code, 3);
}

TEST_F(CliComparison, BEY1_ArraysAreComparedInTheirOwnUnit) {
    const Strings depth{"-o", in_folder("d/{model}.npy"), "--aov", "depth", "--report", in_folder("run.json")};
    ASSERT_EQ(batch(depth).code, 0);
    fs::rename(folder_ / "d", folder_ / "dref");
    const Strings compared = depth + Strings{"--reference", in_folder("dref")};
    ASSERT_EQ(batch(compared).code, 0);
    // The last of the values of the first scene, a quarter of a metre nearer.
    std::string file = read_file(in_folder("dref/cornell-box.npy"));
    float value = 0;
    std::size_t at = file.size();
    do {
        at -= 4;
        std::memcpy(&value, file.data() + at, 4);
    } while (!(value < 100));
    const float moved = value - 0.25f;
    std::memcpy(file.data() + at, &moved, 4);
    std::ofstream(in_folder("dref/cornell-box.npy"), std::ios::binary) << file;
    EXPECT_EQ(batch(compared).code, 3);
    const auto comparison = picture(0)["comparison"];
    EXPECT_EQ(std::string_view(comparison["verdict"]), "different");
    EXPECT_EQ(std::string_view(comparison["unit"]), "1");
    EXPECT_EQ(std::uint64_t(comparison["differing_pixels"]), 1u);
    EXPECT_NEAR(double(comparison["max_error"]), 0.25, 1e-6);
    EXPECT_EQ(batch(compared + Strings{"--tolerance", "0.26"}).code, 0);
}

TEST_F(CliComparison, BEY1_EveryKindOfDifferenceHasItsName) {
    make_one_of_each();
    std::ofstream(folder_ / "ref/spheres.png") << "no picture";
    EXPECT_EQ(compare().code, 3);
    EXPECT_EQ(std::string_view(picture(0)["comparison"]["verdict"]), "different");
    EXPECT_EQ(std::string_view(picture(2)["comparison"]["verdict"]), "other-size");
    EXPECT_EQ(std::string_view(picture(3)["comparison"]["verdict"]), "unreadable");
    fs::remove(folder_ / "ref/spheres.png");
    EXPECT_EQ(compare().code, 3);
    EXPECT_EQ(std::string_view(picture(3)["comparison"]["verdict"]), "missing");
    EXPECT_EQ(batch({"-o", in_folder("out/{model}.png"), "--reference", in_folder("nowhere")}).code, 4);
}

TEST_F(CliComparison, BEY1_ThePageStandsAloneAndTheWorstComeFirst) {
    make_one_of_each();
    ASSERT_EQ(compare().code, 3);
    const std::string html = page();
    // Missing and other sizes before shares of pixels, the larger share first.
    const std::size_t spheres = html.find("<h3>" + in_folder("out/spheres.png")),
                      materials = html.find("<h3>" + in_folder("out/materials.png")),
                      hierarchy = html.find("<h3>" + in_folder("out/hierarchy.png")),
                      cornell = html.find("<h3>" + in_folder("out/cornell-box.png"));
    EXPECT_LT(spheres, materials);
    EXPECT_LT(materials, hierarchy);
    EXPECT_LT(hierarchy, cornell);
    EXPECT_LT(cornell, html.size());
    // New; reference and new; twice reference, new, difference.
    EXPECT_EQ(count(html, "<img "), 1 + 2 + 3 + 3);
    EXPECT_EQ(count(html, "src=\"data:image/png;base64,"), count(html, "src="));
    for (const char* outside : {"http:", "https:", "<script", "<link", "url(", "@import"})
        EXPECT_EQ(count(html, outside), 0) << outside;
    // The data of the pictures is that of the files.
    const std::size_t begin = html.find("base64,", spheres) + 7;
    const std::string data = html.substr(begin, html.find('"', begin) - begin);
    const std::string file = read_file(in_folder("out/spheres.png"));
    EXPECT_EQ(data.size(), (file.size() + 2) / 3 * 4);
    std::string decoded;
    unsigned bits = 0, have = 0;
    for (const char c : data) {
        const std::size_t digit =
            std::string("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/").find(c);
        if (digit == std::string::npos) break;
        bits = bits << 6 | static_cast<unsigned>(digit);
        if ((have += 6) >= 8) decoded += static_cast<char>(bits >> (have -= 8) & 255);
    }
    EXPECT_TRUE(decoded == file);
}

TEST_F(CliComparison, BEY1_ThePageSaysWhatIsNotInIt) {
    const Strings webp{"-o", in_folder("w/{model}.webp"), "--reference", in_folder("wref")};
    ASSERT_EQ(batch({"-o", in_folder("wref/{model}.webp")}).code, 0);
    fs::remove(folder_ / "wref/spheres.webp");
    fs::create_directories(folder_ / "wref/spheres.webp");
    std::ofstream(folder_ / "bad.gltf") << "{}";
    EXPECT_EQ(batch(webp + Strings{in_folder("bad.gltf")}).code, 4);
    const std::string html = read_file(in_folder("w/comparison.html"));
    EXPECT_EQ(count(html, "src=\"data:image/webp;base64,"), 4) << "three equal ones, and the new one of the fourth";
    EXPECT_NE(html.find("1 of 4 pictures differ, 1 scene failed</h1>"), std::string::npos);
    EXPECT_NE(html.find("<p>1 file could not be read"), std::string::npos);
}

TEST_F(CliComparison, BEY1_PicturesOfOldDifferencesAreRemoved) {
    change("hierarchy.png", 5, 9);
    ASSERT_EQ(compare().code, 3);
    const fs::path difference = folder_ / "out/differences/hierarchy.png.difference.png";
    ASSERT_TRUE(fs::exists(difference));
    EXPECT_EQ(compare({"--tolerance", "9"}).code, 0);
    EXPECT_FALSE(fs::exists(difference));
    ASSERT_EQ(compare().code, 3);
    fs::remove(folder_ / "ref/hierarchy.png");
    EXPECT_EQ(compare().code, 3);
    EXPECT_FALSE(fs::exists(difference)) << "of a reference that is gone";
}

TEST_F(CliComparison, BEY1_AReferenceInThePlaceOfTheOutputIsRefused) {
    const std::string before = read_file(in_folder("ref/spheres.png"));
    fs::create_directory_symlink(folder_ / "ref", folder_ / "link");
    for (const char* same : {"ref", "ref/", "ref/.", "link"}) {
        const Outcome run =
            batch({"-o", in_folder("ref/{model}.png"), "--reference", in_folder(same), "--ambient", "1"});
        EXPECT_EQ(run.code, 2) << same;
        EXPECT_NE(run.err.find("--reference"), std::string::npos) << run.err;
    }
    EXPECT_TRUE(read_file(in_folder("ref/spheres.png")) == before);
}

TEST_F(CliComparison, BEY1_APipeInThePlaceOfAReferenceIsNotWaitedFor) {
    fs::remove(folder_ / "ref/spheres.png");
    ASSERT_EQ(::mkfifo(in_folder("ref/spheres.png").c_str(), 0600), 0);
    const Outcome run = compare();
    EXPECT_EQ(run.signal, 0);
    EXPECT_EQ(run.code, 3) << run.err;
    EXPECT_EQ(std::string_view(picture(3)["comparison"]["verdict"]), "unreadable");
}

TEST_F(CliComparison, BEY1_InfiniteErrorsSurviveMerging) {
    change("hierarchy.png", 5, 9);
    ASSERT_EQ(compare().code, 3);
    std::string report = read_file(in_folder("run.json"));
    for (const std::string member : {"\"max_error\": ", "\"mean_error\": "}) {
        std::size_t at = report.find(member);
        ASSERT_NE(at, std::string::npos);
        for (; at != std::string::npos; at = report.find(member, at + 1)) {
            const std::size_t value = at + member.size(), end = report.find_first_not_of("0123456789.eE+-", value);
            report.erase(value, end - value).insert(value, "null");
        }
    }
    std::ofstream(folder_ / "run.json") << report;
    const Outcome merged =
        run_command({"merge-report", "-q", in_folder("run.json"), "-o", in_folder("new/folder/merged.json")});
    EXPECT_EQ(merged.code, 3) << merged.err;
    report_ = parser_.load(in_folder("new/folder/merged.json"));
    const auto comparison = report_["scenes"].at(1)["pictures"].at(0)["comparison"];
    EXPECT_TRUE(comparison["max_error"].is_null());
    EXPECT_TRUE(comparison["mean_error"].is_null());
}

TEST_F(CliComparison, BEY1_NamesCannotBreakThePage) {
    fs::create_directories(folder_ / "m");
    fs::copy_file(scene("lattice.png"), folder_ / "m/lattice.png");
    const std::string name = "<b onclick=\"x\">&'.obj";
    std::ofstream(folder_ / "m" / name) << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    fs::create_directories(folder_ / "empty");
    EXPECT_EQ(run_command({"batch", in_folder("m"), "-q", "-s", "16x16", "-o", in_folder("n/{model}.png"),
                           "--reference", in_folder("empty")})
                  .code,
              3);
    const std::string html = read_file(in_folder("n/comparison.html"));
    EXPECT_EQ(html.find("<b onclick"), std::string::npos);
    EXPECT_NE(html.find("&lt;b onclick=&quot;x&quot;&gt;&amp;"), std::string::npos);
}

TEST_F(CliComparison, BEY1_TheMergedPageIsThatOfAllShards) {
    make_one_of_each();
    Strings reports;
    for (const char* shard : {"1/2", "2/2"}) {
        reports.push_back(in_folder(std::string("r") + shard[0] + ".json"));
        EXPECT_EQ(batch({"-o", in_folder("out/{model}.png"), "--reference", in_folder("ref"), "--shard", shard,
                         "--report", reports.back()})
                      .code,
                  3);
    }
    EXPECT_TRUE(fs::exists(folder_ / "out/comparison-1-of-2.html"));
    EXPECT_EQ(run_command(Strings{"merge-report", "-q"} + reports + Strings{"--html", in_folder("all.html")}).code, 3);
    const std::string html = read_file(in_folder("all.html"));
    EXPECT_EQ(count(html, "<img "), 9);
    EXPECT_NE(html.find("4 of 4 pictures differ"), std::string::npos);
}

// Chromium in PATH, or "".
std::string chromium() {
    const char* path = std::getenv("PATH");
    std::stringstream folders(path != nullptr ? path : "");
    for (std::string folder; std::getline(folders, folder, ':');)
        for (const char* name : {"/chromium", "/chromium-browser", "/google-chrome"})
            if (::access((folder + name).c_str(), X_OK) == 0) return folder + name;
    return "";
}

TEST_F(CliComparison, BEY1_ABrowserShowsThePage) {
    const std::string browser = chromium();
    if (browser.empty()) GTEST_SKIP() << "there is no chromium in PATH";
    make_one_of_each();
    change("hierarchy.png", 0, 0);
    ASSERT_EQ(compare().code, 3);
    const Strings quiet{"--headless",
                        "--no-sandbox",
                        "--disable-gpu",
                        "--disable-quic",
                        "--no-first-run",
                        "--disable-background-networking",
                        "--disable-sync",
                        "--disable-component-update",
                        "--disable-extensions",
                        "--hide-scrollbars",
                        "--disable-dev-shm-usage",
                        "--user-data-dir=" + in_folder("profile")};
    const std::string address = "file://" + in_folder("out/comparison.html");
    const Outcome dom =
        run_program(browser, quiet + Strings{"--dump-dom", address}, {}, {"HOME=" + folder_.string()}, 120);
    ASSERT_EQ(dom.code, 0) << dom.err;
    EXPECT_EQ(count(dom.out, "<img "), 9);
    EXPECT_EQ(count(dom.out, "<section>"), 4);
    const Outcome shot = run_program(
        browser, quiet + Strings{"--window-size=1200,1800", "--screenshot=" + in_folder("page.png"), address}, {},
        {"HOME=" + folder_.string()}, 120);
    ASSERT_EQ(shot.code, 0) << shot.err;
    // The difference's red and the words are there: the pictures were decoded and drawn.
    const tessera::Image page = tessera::read_image(in_folder("page.png"));
    ASSERT_EQ(page.width(), 1200);
    int red = 0;
    for (int i = 0; i < page.width() * page.height(); ++i) {
        const auto* p = page.data<std::uint8_t>() + 4 * i;
        red += p[0] > 200 && p[1] < 60 && p[2] < 60;
    }
    EXPECT_GT(red, 300) << "the red of the difference of hierarchy.png, 300 pixels or more of it";
    if (const char* keep = std::getenv("TESSERA_KEEP_PAGE"))
        fs::copy_file(folder_ / "page.png", keep, fs::copy_options::overwrite_existing);
}

}  // namespace
