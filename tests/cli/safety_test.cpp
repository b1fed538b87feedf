// What a user's scripts rely on when things go wrong: a full disk and an output that cannot be written leave
// nothing behind, limits hold for every format, hostile meshes are errors.
#include "cli/run_command.h"

#include <sys/stat.h>
#include <sys/statvfs.h>

namespace {

using Strings = std::vector<std::string>;

class CliSafety : public CliTest {
  protected:
    // As the shell runs it under `limit`, "ulimit -f 4" for instance.
    Outcome run_limited(const std::string& limit, const Strings& arguments) const {
        std::string line = "( ";
        line.append(limit).append("; exec '").append(kCommand).append("'");
        for (const std::string& a : arguments) line.append(" '").append(a).append("'");
        const std::string code = in_folder("code"), err = in_folder("err");
        line.append(" ) >/dev/null 2>'").append(err).append("'; echo $? >'").append(code).append("'");
        EXPECT_EQ(std::system(line.c_str()), 0);
        Outcome run;
        run.code = std::stoi(read_file(code));
        run.err = read_file(err);
        std::filesystem::remove(code);
        std::filesystem::remove(err);
        return run;
    }
    // A noisy picture: some 100 KB as PNG.
    Strings picture(const std::string& output) const {
        return {"render", scene("materials.gltf"), "-s", "320x240", "--samples", "1", "-o", output};
    }
    void write(const std::string& name, const std::string& text) const {
        std::ofstream(in_folder(name), std::ios::binary) << text;
    }
};

// A limit on the size of files stops a write in its middle, as a full disk does; the shell's unit is 512 or 1024 bytes.
TEST_F(CliSafety, SAFE_AWriteThatBreaksOffLeavesNothingBehind) {
    for (const char* name : {"a.png", "a.jpg"}) {
        const Outcome run = run_limited("ulimit -f 2", picture(in_folder(name)));
        EXPECT_EQ(run.code, 5) << run.err;
        EXPECT_EQ(run.error_lines(), 1) << run.err;
        EXPECT_NE(run.err.find(name), std::string::npos) << run.err;
        EXPECT_EQ(folder_contents(), Strings{});
    }
    // What was there before stays as it was.
    write("a.png", "old");
    EXPECT_EQ(run_limited("ulimit -f 2", picture(in_folder("a.png"))).code, 5);
    EXPECT_EQ(folder_contents(), Strings{"a.png"});
    EXPECT_EQ(read_file(in_folder("a.png")), "old");
    // Without room for a byte: the statistics, too.
    std::filesystem::remove(in_folder("a.png"));
    EXPECT_EQ(run_limited("ulimit -f 0", picture(in_folder("a.png"))).code, 5);
    const Strings statistics{"render", scene("materials.gltf"), "-s", "8x8", "--stats", in_folder("s.json")};
    EXPECT_EQ(run_limited("ulimit -f 0", statistics).code, 5);  // no room for its message either
    EXPECT_EQ(folder_contents(), Strings{});
}

TEST_F(CliSafety, SAFE_DevFullIsAnOutputError) {
    if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
    const Strings small{"render", scene("cornell-box.gltf"), "-s", "16x12", "--samples", "1"};
    for (const Strings& output :
         {Strings{"-o", "/dev/full"}, {"--stats", "/dev/full"}, {"-o", in_folder("a.png"), "--stats", "/dev/full"}}) {
        Strings arguments = small;
        arguments.insert(arguments.end(), output.begin(), output.end());
        const Outcome run = run_command(arguments);
        EXPECT_EQ(run.code, 5) << run.err;
        EXPECT_EQ(run.error_lines(), 1) << run.err;
        EXPECT_NE(run.err.find("/dev/full"), std::string::npos) << run.err;
    }
    for (const std::string& name : folder_contents()) EXPECT_EQ(name, "a.png");
}

TEST_F(CliSafety, SAFE_AFolderThatIsNotThereOrReadOnly) {
    EXPECT_EQ(run_command(picture(in_folder("none/a.png"))).code, 5);
    if (::geteuid() != 0) {
        std::filesystem::create_directory(in_folder("locked"));
        ::chmod(in_folder("locked").c_str(), 0555);
        EXPECT_EQ(run_command(picture(in_folder("locked/a.png"))).code, 5);
        ::chmod(in_folder("locked").c_str(), 0755);
        std::filesystem::remove(in_folder("locked"));
    }
    // A file system without write access, where there is one: not for root either.
    struct statvfs info {};
    if (::statvfs("/sys", &info) == 0 && (info.f_flag & ST_RDONLY)) {
        const Outcome run = run_command(picture("/sys/a.png"));
        EXPECT_EQ(run.code, 5);
        EXPECT_EQ(run.error_lines(), 1) << run.err;
    }
    EXPECT_EQ(folder_contents(), Strings{});
}

// One square in each mesh format, and each limit on it.
TEST_F(CliSafety, SAFE_LimitsHoldForEveryFormat) {
    write("s.obj", "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nusemtl m\nf 1/1 2/1 3/1 4/1\n");
    write("m.mtl", "newmtl m\nmap_Kd p.png\n");
    write("s.ply",
          "ply\nformat ascii 1.0\ncomment TextureFile p.png\nelement vertex 4\nproperty float x\nproperty float y\n"
          "property float z\nproperty float s\nproperty float t\nelement face 1\nproperty list uchar int vertex_index\n"
          "end_header\n0 0 0 0 0\n1 0 0 1 0\n1 1 0 1 1\n0 1 0 0 1\n4 0 1 2 3\n");
    write("s.stl",
          "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\nendloop\nendfacet\n"
          "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 1 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n");
    ASSERT_EQ(
        run_command({"render", scene("cornell-box.gltf"), "-s", "40x30", "--samples", "1", "-o", in_folder("p.png")})
            .code,
        0);
    const Strings before = folder_contents();
    for (const char* name : {"s.obj", "s.ply", "s.stl"}) {
        const auto render = [&](const Strings& more) {
            Strings arguments{"render", in_folder(name), "-s", "16x16", "--samples", "1", "--quiet"};
            arguments.insert(arguments.end(), more.begin(), more.end());
            return run_command(arguments);
        };
        const std::string out = in_folder("a.png");
        EXPECT_EQ(render({"--stats", "-"}).code, 0) << name;
        EXPECT_EQ(render({"-o", out, "--max-triangles", "1"}).code, 6) << name;
        EXPECT_EQ(render({"-o", out, "--max-memory", "100"}).code, 6) << name;
        // 1,200 pixels of a texture, 256 of the picture.
        const bool textured = std::string(name) != "s.stl";
        const Outcome pixels = render({"--stats", "-", "--max-pixels", "1000"});
        EXPECT_EQ(pixels.code, textured ? 6 : 0) << name << pixels.err;
        if (textured) {
            EXPECT_NE(pixels.err.find("p.png"), std::string::npos) << pixels.err;
        }
        EXPECT_EQ(folder_contents(), before) << name;
    }
}

// A file that takes long to read, of each format; 10 ms are over before a tenth of it is seen.
TEST_F(CliSafety, SAFE_TimeoutEndsTheReadingOfEveryFormat) {
    std::string grid_obj, grid_ply, soup_stl(80, ' ');
    constexpr int kSide = 700;
    for (int y = 0; y <= kSide; ++y)
        for (int x = 0; x <= kSide; ++x) {
            std::string xyz = std::to_string(x);
            xyz.append(" ").append(std::to_string(y)).append(" ").append(std::to_string(x * y % 7)).append("\n");
            grid_obj.append("v ").append(xyz);
            grid_ply.append(xyz);
        }
    for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x) {
            const int a = y * (kSide + 1) + x, b = a + kSide + 1;
            const auto quad = [&](int base) {
                std::string text;
                for (const int i : {a, a + 1, b + 1, b}) text.append(" ").append(std::to_string(i + base));
                return text.append("\n");
            };
            grid_obj.append("f").append(quad(1));
            grid_ply.append("4").append(quad(0));
        }
    constexpr std::uint32_t kTriangles = 1'000'000;
    soup_stl.append(reinterpret_cast<const char*>(&kTriangles), 4);
    soup_stl.resize(84 + 50 * std::size_t{kTriangles});
    write("s.obj", grid_obj);
    std::string ply = "ply\nformat ascii 1.0\nelement vertex ";
    ply.append(std::to_string((kSide + 1) * (kSide + 1)))
        .append("\nproperty float x\nproperty float y\nproperty float z\nelement face ")
        .append(std::to_string(kSide * kSide))
        .append("\nproperty list uchar int vertex_index\nend_header\n")
        .append(grid_ply);
    write("s.ply", ply);
    write("s.stl", soup_stl);
    for (const char* name : {"s.obj", "s.ply", "s.stl"}) {
        const Outcome run =
            run_command({"render", in_folder(name), "-o", in_folder("a.png"), "-s", "64x64", "--timeout", "0.01"});
        EXPECT_EQ(run.code, 6) << name;
        EXPECT_EQ(run.error_lines(), 1) << run.err;
        EXPECT_NE(run.err.find("--timeout"), std::string::npos) << run.err;
        EXPECT_FALSE(std::filesystem::exists(in_folder("a.png"))) << name;
    }
}

}  // namespace
