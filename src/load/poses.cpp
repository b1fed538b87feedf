#include <tessera/poses.h>

#include "load/file.h"
#include "load/json.h"
#include "simd/math.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <new>
#include <set>

namespace tessera {
namespace {

constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 28;
constexpr float kFarthest = 1e15f;

// Three or four rows of four numbers, of a rotation and a translation.
Mat4 read_rigid(const Json& json) {
    Mat4 m;
    std::size_t rows = 0;
    json.each([&](const Json& row, std::size_t r) {
        float numbers[4];
        row.numbers(numbers);
        if (r == 3 && !(numbers[0] == 0 && numbers[1] == 0 && numbers[2] == 0 && numbers[3] == 1))
            row.fail("the last row must be 0, 0, 0, 1");
        for (int c = 0; r < 4 && c < 4; ++c) m(static_cast<int>(r), c) = numbers[c];
        rows = r + 1;
    });
    if (rows != 3 && rows != 4) json.fail("expected 3 or 4 rows, found " + std::to_string(rows));
    const auto axis = [&](int c) { return Vec3{m(0, c), m(1, c), m(2, c)}; };
    for (int a = 0; a < 3; ++a)
        for (int b = a; b < 3; ++b)
            if (!(std::fabs(dot(axis(a), axis(b)) - (a == b ? 1.0f : 0.0f)) <= 1e-4f))
                json.fail("not rigid: its columns are no rotation");
    if (!(dot(cross(axis(0), axis(1)), axis(2)) > 0)) json.fail("not rigid: it mirrors");
    return m;
}

// Of a rigid matrix, in double.
Mat4 inverse(const Mat4& m) {
    Mat4 r;
    for (int i = 0; i < 3; ++i) {
        double back = 0;
        for (int j = 0; j < 3; ++j) {
            r(i, j) = m(j, i);
            back -= static_cast<double>(m(j, i)) * static_cast<double>(m(j, 3));
        }
        r(i, 3) = static_cast<float>(back);
    }
    return r;
}

// OpenCV's camera axes to those of glTF, or the reverse: Y and Z the other way.
Mat4 flipped(Mat4 camera_to_world) {
    for (int r = 0; r < 3; ++r)
        camera_to_world(r, 1) = -camera_to_world(r, 1), camera_to_world(r, 2) = -camera_to_world(r, 2);
    return camera_to_world;
}

constexpr double kLeastFocal = 1e-3, kMostPixels = 1e7;

void check_lens(const Json& place, const Intrinsics& k) {
    if (!(k.fx >= kLeastFocal && k.fy >= kLeastFocal && k.fx <= kMostPixels && k.fy <= kMostPixels))
        place.fail("focal lengths must be positive, 0.001 to 10000000 pixels");
    if (!(std::fabs(k.cx) <= kMostPixels && std::fabs(k.cy) <= kMostPixels))
        place.fail("the centre must be within 10000000 pixels");
}

// A misspelt name would otherwise look as if the member were absent.
void check_names(const Json& json, std::initializer_list<std::string_view> known) {
    json.each_member([&](std::string_view key, const Json& value) {
        if (std::find(known.begin(), known.end(), key) != known.end()) return;
        std::string names;
        for (const std::string_view name : known) names.append(names.empty() ? "" : ", ").append(name);
        value.fail("there is no such member; there are " + names);
    });
}

std::optional<Intrinsics> read_intrinsics(const Json& json) {
    const std::optional<Json> given = json.find("intrinsics");
    if (!given) return std::nullopt;
    double k[4];
    std::size_t count = 0;
    given->each([&](const Json& number, std::size_t i) {
        if (i < 4) k[i] = number.real();
        count = i + 1;
    });
    if (count != 4) given->fail("expected fx, fy, cx, cy, found " + std::to_string(count) + " numbers");
    const Intrinsics lens{k[0], k[1], k[2], k[3]};
    check_lens(*given, lens);
    return lens;
}

// A size that the file states is that of its intrinsics.
void check_size(const Json& json, const char* width_name, const char* height_name, int width, int height) {
    const std::optional<Json> w = json.find(width_name), h = json.find(height_name);
    if (!w && !h) return;
    const auto side = [](const std::optional<Json>& given, int own) {
        return given ? given->integer(1u << 30) : static_cast<std::uint64_t>(own);
    };
    const std::uint64_t is_w = side(w, width), is_h = side(h, height);
    if (is_w == static_cast<std::uint64_t>(width) && is_h == static_cast<std::uint64_t>(height)) return;
    json.fail("the cameras are made for pictures of " + std::to_string(is_w) + "x" + std::to_string(is_h) +
              " pixels, not " + std::to_string(width) + "x" + std::to_string(height));
}

std::vector<Pose> read_cameras(const Json& root, int width, int height) {
    const std::string convention = root.string_or("convention", "opencv");
    if (convention != "opencv" && convention != "opengl")
        root.at("convention").fail("'" + convention.substr(0, 80) + "' is none of opencv, opengl");
    check_names(root, {"convention", "width", "height", "intrinsics", "cameras"});
    const std::optional<Intrinsics> common = read_intrinsics(root);
    std::vector<Pose> poses;
    root.at("cameras").each([&](const Json& camera, std::size_t i) {
        check_names(camera, {"name", "camera_to_world", "world_to_camera", "intrinsics"});
        Pose pose;
        pose.name = camera.string_or("name", std::to_string(i));
        const std::optional<Json> to_world = camera.find("camera_to_world"),
                                  from_world = camera.find("world_to_camera");
        if (to_world.has_value() == from_world.has_value())
            camera.fail("needs one of camera_to_world and world_to_camera");
        const Mat4 placement = to_world ? read_rigid(*to_world) : inverse(read_rigid(*from_world));
        for (int r = 0; r < 3; ++r)
            if (!(std::fabs(placement(r, 3)) <= kFarthest)) camera.fail("the camera stands too far away");
        pose.view.camera_to_world = convention == "opencv" ? flipped(placement) : placement;
        pose.view.intrinsics = read_intrinsics(camera);
        if (!pose.view.intrinsics) pose.view.intrinsics = common;
        if (pose.view.intrinsics) check_size(root, "width", "height", width, height);
        poses.push_back(std::move(pose));
    });
    return poses;
}

// "./train/r_0.png": "r_0".
std::string stem(std::string_view path) {
    if (const std::size_t slash = path.rfind('/'); slash != std::string_view::npos) path.remove_prefix(slash + 1);
    if (const std::size_t dot = path.rfind('.'); dot != std::string_view::npos && dot > 0) path = path.substr(0, dot);
    return std::string(path);
}

// What a frame says of its lens, or else the root; nothing where neither does. Only pinholes are drawn.
std::optional<Intrinsics> read_nerf_lens(const Json& frame, const Json& root, int width, int height) {
    const auto find = [&](std::string_view key) {
        const std::optional<Json> own = frame.find(key);
        return own ? own : root.find(key);
    };
    const auto focal = [&](std::string_view pixels, std::string_view angle, int side) -> std::optional<double> {
        if (const std::optional<Json> f = find(pixels)) return f->real();
        const std::optional<Json> a = find(angle);
        if (!a) return std::nullopt;
        const double radians = a->real();
        if (!(radians > 0 && radians < 3.14)) a->fail("the angle must be above 0 and below pi");
        return 0.5 * side / math::tan(0.5 * radians);
    };
    for (const char* distortion : {"k1", "k2", "k3", "k4", "k5", "k6", "p1", "p2"})
        if (const std::optional<Json> d = find(distortion); d && d->real() != 0)
            d->fail("lenses that distort are not drawn; undistort the photographs and leave it out");
    if (const std::optional<Json> model = find("camera_model"))
        if (const std::string_view name = model->string();
            name != "OPENCV" && name != "PINHOLE" && name != "SIMPLE_PINHOLE" && name != "perspective")
            model->fail("only pinhole cameras are drawn");
    const std::optional<double> fx = focal("fl_x", "camera_angle_x", width),
                                fy = focal("fl_y", "camera_angle_y", height);
    if (!fx && !fy) return std::nullopt;
    const auto middle = [&](std::string_view key, int side) {
        const std::optional<Json> c = find(key);
        return (c ? c->real() : 0.5 * side) - 0.5;
    };
    if (find("fl_x") || find("fl_y") || find("cx") || find("cy")) {
        check_size(root, "w", "h", width, height);
        check_size(frame, "w", "h", width, height);
    }
    const Intrinsics lens{fx ? *fx : *fy, fy ? *fy : *fx, middle("cx", width), middle("cy", height)};
    check_lens(frame, lens);
    return lens;
}

std::vector<Pose> read_transforms(const Json& root, int width, int height) {
    std::vector<Pose> poses;
    root.at("frames").each([&](const Json& frame, std::size_t i) {
        Pose pose;
        pose.name = stem(frame.string_or("file_path", std::to_string(i)));
        pose.view.camera_to_world = read_rigid(frame.at("transform_matrix"));
        pose.view.intrinsics = read_nerf_lens(frame, root, width, height);
        poses.push_back(std::move(pose));
    });
    return poses;
}

}  // namespace

std::vector<Pose> parse_poses(std::string_view json, int width, int height, const std::string& name) {
    try {
        if (json.starts_with("\xef\xbb\xbf")) json.remove_prefix(3);
        simdjson::dom::parser parser;
        const simdjson::padded_string padded(json);
        simdjson::dom::element element;
        if (const simdjson::error_code error = parser.parse(padded).get(element))
            throw Error(ErrorCode::kInput, std::string("not valid JSON: ") + simdjson::error_message(error), name);
        const Json root(element, {}, name);
        if (!root.is_object()) root.fail("expected an object with \"cameras\" or \"frames\"");
        const bool nerf = !root.find("cameras") && root.find("frames");
        std::vector<Pose> poses = nerf ? read_transforms(root, width, height) : read_cameras(root, width, height);
        if (poses.empty()) root.fail("there is no camera in it");
        std::set<std::string> names;
        for (std::size_t i = 0; i < poses.size(); ++i)
            if (!names.insert(poses[i].name).second)
                root.at(nerf ? "frames" : "cameras").fail("two cameras have one name: number " + std::to_string(i));
        return poses;
    } catch (const std::bad_alloc&) {
        throw Error(ErrorCode::kLimit, "out of memory", name);
    }
}

std::vector<Pose> read_poses(const std::string& path, int width, int height) {
    LoadOptions options;
    options.max_bytes = kMostBytes;
    LoadContext context(path, options);
    const Bytes file = read_whole_file(context, path);
    const std::span<const std::byte> bytes = file.span();
    return parse_poses({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, width, height, path);
}

}  // namespace tessera
