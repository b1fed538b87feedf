// GEO6: cameras from JSON: the conventions name the same camera, and what is wrong is refused by its place.
#include <gtest/gtest.h>

#include "load/temporary_folder.h"

#include <tessera/error.h>
#include <tessera/poses.h>

#include <cmath>
#include <fstream>
#include <initializer_list>
#include <string>
#include <string_view>

namespace tessera {
namespace {

// Sums of temporaries, out of line: instrumented, g++ mistakes them for overflows.
[[gnu::noinline]] std::string join(std::initializer_list<std::string_view> parts) {
    std::string text;
    for (const std::string_view part : parts) text.append(part);
    return text;
}

// A quarter turn about Z: columns (0, 1, 0), (-1, 0, 0), (0, 0, 1); eye at (1, 2, 3).
constexpr const char* kOpenGl = "[[0,-1,0,1],[1,0,0,2],[0,0,1,3],[0,0,0,1]]";
constexpr const char* kOpenCv = "[[0,1,0,1],[1,0,0,2],[0,0,-1,3],[0,0,0,1]]";
// The inverse of the last: rows are its columns, and minus those times the eye.
constexpr const char* kWorldToOpenCv = "[[0,1,0,-2],[1,0,0,-1],[0,0,-1,3]]";

std::string cameras(const std::string& convention, const std::string& member, const char* matrix) {
    return R"({"convention": ")" + convention + R"(", "cameras": [{"name": "a", ")" + member + R"(": )" + matrix +
           "}]}";
}

TEST(Poses, GEO6_ConventionsNameTheSameCamera) {
    const auto one = [](const std::string& json) { return parse_poses(json, 64, 48).at(0); };
    const Pose gl = one(cameras("opengl", "camera_to_world", kOpenGl));
    const Mat4 expected{{0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 1, 2, 3, 1}};
    EXPECT_EQ(gl.name, "a");
    EXPECT_EQ(gl.view.camera_to_world, expected);
    EXPECT_FALSE(gl.view.intrinsics);
    EXPECT_EQ(one(cameras("opencv", "camera_to_world", kOpenCv)).view.camera_to_world, expected);
    EXPECT_EQ(one(cameras("opencv", "world_to_camera", kWorldToOpenCv)).view.camera_to_world, expected);
    const std::string nerf =
        std::string(R"({"frames": [{"file_path": "./train/r_0.png", "transform_matrix": )") + kOpenGl + "}]}";
    EXPECT_EQ(one(nerf).name, "r_0");
    EXPECT_EQ(one(nerf).view.camera_to_world, expected);
}

TEST(Poses, GEO6_IntrinsicsOfAllOrOfOne) {
    const std::string json =
        join({R"({"width": 64, "height": 48, "intrinsics": [50, 51, 31.5, 23.25], "cameras": [{"camera_to_world": )",
              kOpenCv, R"(}, {"name": "b", "camera_to_world": )", kOpenCv, R"(, "intrinsics": [1.5, 2.5, 3, 4]}]})"});
    const std::vector<Pose> poses = parse_poses(json, 64, 48);
    ASSERT_EQ(poses.size(), 2u);
    EXPECT_EQ(poses[0].name, "0");
    EXPECT_EQ(poses[0].view.intrinsics, (Intrinsics{50, 51, 31.5, 23.25}));
    EXPECT_EQ(poses[1].view.intrinsics, (Intrinsics{1.5, 2.5, 3, 4}));
}

// A NeRF's lens of angle a: half the width lies at distance 1 / tan(a / 2) times it.
TEST(Poses, GEO6_TransformsOfNeRF) {
    const auto lens = [](const std::string& members) {
        return *parse_poses("{" + members + R"("frames": [{"transform_matrix": )" + kOpenGl + "}]}", 64, 48)
                    .at(0)
                    .view.intrinsics;
    };
    const Intrinsics k = lens(R"("camera_angle_x": 0.6911112070083618, )");
    EXPECT_NEAR(k.fx, 32 / std::tan(0.6911112070083618 / 2), 1e-9);
    EXPECT_EQ(k.fy, k.fx);
    EXPECT_EQ(k.cx, 31.5);
    EXPECT_EQ(k.cy, 23.5);
    EXPECT_EQ(lens(R"("fl_x": 70, "fl_y": 71, "cx": 33, "cy": 20, "w": 64, "h": 48, )"),
              (Intrinsics{70, 71, 32.5, 19.5}));
}

TEST(Poses, FaultsAreNamedByTheirPlace) {
    const auto refused = [](const std::string& json, const std::string& part) {
        try {
            parse_poses(json, 64, 48, "cameras.json");
            ADD_FAILURE() << "accepted: " << json;
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::kInput);
            const std::string what = error.what();
            EXPECT_EQ(what.find("cameras.json"), 0u) << what;
            EXPECT_NE(what.find(part), std::string::npos) << what;
        }
    };
    refused("", "not valid JSON");
    refused("[]", "object");
    refused("{}", "\"cameras\" is missing");
    refused(R"({"cameras": []})", "no camera");
    refused(R"({"cameras": [{}]})", "/cameras/0: needs one of");
    refused(cameras("opencl", "camera_to_world", kOpenCv), "/convention");
    refused(cameras("opencv", "camera_to_world", "[[1,0,0,0],[0,1,0,0]]"), "3 or 4 rows");
    refused(cameras("opencv", "camera_to_world", "[[1,0,0],[0,1,0],[0,0,1]]"), "expected 4 numbers");
    refused(cameras("opencv", "camera_to_world", "[[2,0,0,0],[0,2,0,0],[0,0,2,0]]"), "not rigid");
    refused(cameras("opencv", "camera_to_world", "[[1,0,0,0],[0,1,0,0],[0,0,-1,0]]"), "mirrors");
    refused(cameras("opencv", "camera_to_world", "[[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,1,1]]"), "last row");
    refused(cameras("opencv", "camera_to_world", "[[1,0,0,1e999],[0,1,0,0],[0,0,1,0]]"), "cameras.json");
    refused(std::string(R"({"intrinsics": [0, 1, 1, 1], "cameras": [{"camera_to_world": )") + kOpenCv + "}]}",
            "/intrinsics: focal lengths");
    refused(std::string(R"({"intrinsics": [1, 1, 1], "cameras": [{"camera_to_world": )") + kOpenCv + "}]}",
            "found 3 numbers");
    refused(
        std::string(R"({"width": 640, "height": 480, "intrinsics": [1, 1, 1, 1], "cameras": [{"camera_to_world": )") +
            kOpenCv + "}]}",
        "640x480 pixels, not 64x48");
    refused(std::string(R"({"intrinsic": [1, 1, 1, 1], "cameras": [{"camera_to_world": )") + kOpenCv + "}]}",
            "/intrinsic: there is no such member");
    refused(std::string(R"({"cameras": [{"camera_matrix": 1, "camera_to_world": )") + kOpenCv + "}]}",
            "/cameras/0/camera_matrix: there is no such member");
    refused(std::string(R"({"intrinsics": [1e20, 1, 1, 1], "cameras": [{"camera_to_world": )") + kOpenCv + "}]}",
            "/intrinsics: focal lengths");
    refused(std::string(R"({"intrinsics": [1, 1, 1e20, 1], "cameras": [{"camera_to_world": )") + kOpenCv + "}]}",
            "/intrinsics: the centre");
    refused(cameras("opencv", "world_to_camera", "[[1,0,0,3e38],[0,1,0,0],[0,0,1,0]]"), "too far away");
    refused(R"({"fl_x": 9, "k1": 0.5, "frames": [{"transform_matrix": [[1,0,0,0],[0,1,0,0],[0,0,1,0]]}]})",
            "/k1: lenses");
    refused(
        R"({"fl_x": 9, "camera_model": "FISHEYE", "frames": [{"transform_matrix": [[1,0,0,0],[0,1,0,0],[0,0,1,0]]}]})",
        "/camera_model: only pinhole");
    refused(R"({"fl_x": 9, "frames": [{"w": 10, "transform_matrix": [[1,0,0,0],[0,1,0,0],[0,0,1,0]]}]})",
            "10x48 pixels");
    refused(std::string(R"({"cameras": [{"name": "a", "camera_to_world": )") + kOpenCv +
                R"(}, {"name": "a", "camera_to_world": )" + kOpenCv + "}]}",
            "two cameras have one name");
    refused(R"({"camera_angle_x": 7, "frames": [{"transform_matrix": [[1,0,0,0],[0,1,0,0],[0,0,1,0]]}]})", "below pi");
}

TEST(Poses, FilesAreReadAndNamed) {
    const TemporaryFolder folder;
    const std::string path = (folder.path() / "c.json").string();
    EXPECT_THROW(read_poses(path, 64, 48), Error);
    std::ofstream(path) << cameras("opengl", "camera_to_world", kOpenGl);
    EXPECT_EQ(read_poses(path, 64, 48).size(), 1u);
}

}  // namespace
}  // namespace tessera
