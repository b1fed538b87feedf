#include <tessera/poses.h>

#include "load/file.h"
#include "load/json.h"
#include "simd/math.h"

#include <cmath>
#include <new>
#include <set>

namespace tessera {
namespace {

constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 28;

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

void check_lens(const Json& place, const Intrinsics& k) {
    if (!(k.fx > 0 && k.fy > 0)) place.fail("focal lengths must be positive");
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
    const double is_w = w ? w->real() : width, is_h = h ? h->real() : height;
    if (is_w == width && is_h == height) return;
    const auto text = [](double side) {
        return side >= 0 && side < 1e9 ? std::to_string(static_cast<long>(side)) : std::string("?");
    };
    json.fail("the cameras are made for pictures of " + text(is_w) + "x" + text(is_h) + " pixels, not " +
              std::to_string(width) + "x" + std::to_string(height));
}

std::vector<Pose> read_cameras(const Json& root, int width, int height) {
    const std::string convention = root.string_or("convention", "opencv");
    if (convention != "opencv" && convention != "opengl")
        root.at("convention").fail("'" + convention.substr(0, 80) + "' is none of opencv, opengl");
    check_size(root, "width", "height", width, height);
    const std::optional<Intrinsics> common = read_intrinsics(root);
    std::vector<Pose> poses;
    root.at("cameras").each([&](const Json& camera, std::size_t i) {
        Pose pose;
        pose.name = camera.string_or("name", std::to_string(i));
        const std::optional<Json> to_world = camera.find("camera_to_world"),
                                  from_world = camera.find("world_to_camera");
        if (to_world.has_value() == from_world.has_value())
            camera.fail("needs one of camera_to_world and world_to_camera");
        const Mat4 placement = to_world ? read_rigid(*to_world) : inverse(read_rigid(*from_world));
        pose.view.camera_to_world = convention == "opencv" ? flipped(placement) : placement;
        pose.view.intrinsics = read_intrinsics(camera);
        if (!pose.view.intrinsics) pose.view.intrinsics = common;
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

// The lens of a frame, or of all; nothing where neither says one.
std::optional<Intrinsics> read_nerf_lens(const Json& json, int width, int height) {
    const auto number = [&](const char* key, double otherwise) {
        const std::optional<Json> value = json.find(key);
        return value ? value->real() : otherwise;
    };
    double fx = number("fl_x", 0);
    if (!json.find("fl_x")) {
        const std::optional<Json> angle = json.find("camera_angle_x");
        if (!angle) return std::nullopt;
        const double radians = angle->real();
        if (!(radians > 0 && radians < 3.14)) angle->fail("the angle must be above 0 and below pi");
        fx = 0.5 * width / math::tan(0.5 * radians);
    }
    const Intrinsics lens{fx, number("fl_y", fx), number("cx", 0.5 * width) - 0.5, number("cy", 0.5 * height) - 0.5};
    check_lens(json, lens);
    return lens;
}

std::vector<Pose> read_transforms(const Json& root, int width, int height) {
    check_size(root, "w", "h", width, height);
    const std::optional<Intrinsics> common = read_nerf_lens(root, width, height);
    std::vector<Pose> poses;
    root.at("frames").each([&](const Json& frame, std::size_t i) {
        Pose pose;
        pose.name = stem(frame.string_or("file_path", std::to_string(i)));
        pose.view.camera_to_world = read_rigid(frame.at("transform_matrix"));
        pose.view.intrinsics = read_nerf_lens(frame, width, height);
        if (!pose.view.intrinsics) pose.view.intrinsics = common;
        poses.push_back(std::move(pose));
    });
    return poses;
}

}  // namespace

std::vector<Pose> parse_poses(std::string_view json, int width, int height, const std::string& name) {
    try {
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
