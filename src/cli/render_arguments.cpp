#include "cli/render_arguments.h"

#include "cli/option_adder.h"
#include "cli/parse.h"
#include "cli/pattern.h"
#include "cli/video.h"

#include <tessera/error.h>

#include <unistd.h>

#include <initializer_list>
#include <utility>

namespace tessera::cli {
namespace {

constexpr double kRadiansPerDegree = 3.14159265358979323846 / 180;

// The value that `text` names, or a refusal that lists the names.
template <class T>
T choose(const std::string& option, const std::string& text, std::initializer_list<std::pair<const char*, T>> choices) {
    std::string names;
    for (const auto& [name, value] : choices) {
        if (text == name) return value;
        names += (names.empty() ? "" : ", ") + std::string(name);
    }
    refuse(option, "'" + text + "' is none of " + names);
}

View parse_view(const RenderArguments& a, bool& z_is_up) {
    View view;
    if (!a.camera.empty() && (!a.eye.empty() || !a.target.empty())) refuse("--camera", "excludes --eye and --target");
    if (!a.target.empty() && a.eye.empty()) refuse("--target", "needs --eye");
    if (!a.eye.empty()) view.eye = parse_vector("--eye", a.eye);
    if (!a.target.empty()) view.target = parse_vector("--target", a.target);
    if (view.eye && view.target && *view.eye == *view.target) refuse("--target", "is the same point as --eye");
    z_is_up = a.up == "z";
    if (a.up != "y" && a.up != "z") view.up = parse_vector("--up", a.up);
    if (view.up == Vec3{}) refuse("--up", "has no length");
    if (!a.fov.empty()) view.yfov = static_cast<float>(parse_number("--fov", a.fov, 0.1, 179) * kRadiansPerDegree);
    return view;
}

Stage parse_stage(const RenderArguments& a, const RenderOptions& render) {
    if (a.show.empty()) return Stage::kPicture;
    const Stage stage = choose<Stage>(
        "--show", a.show,
        {{"bins", Stage::kBins}, {"hiz", Stage::kHiZ}, {"overdraw", Stage::kOverdraw}, {"cost", Stage::kCost}});
    if (render.engine != Engine::kRaster) refuse("--show", "needs --engine raster: " + a.engine + " has no tiles");
    if (render.filter != PixelFilter::kBox) refuse("--show", "needs --filter box");
    if (!render.want_color) refuse("--show", "needs --aov color, in a picture of 8 bits");
    return stage;
}

void parse_animation(const RenderArguments& a, RenderJob& job) {
    job.animation = a.animation;
    if (!a.time.empty()) job.time = parse_number("--time", a.time, -1e9, 1e9);
    job.skip_existing = a.skip_existing;
    job.frames = parse_frames(a.frames, a.fps, a.turntable);
    job.fps = parse_number("--fps", a.fps, 1e-3, 1e6);
    if (!job.frames) {
        if (a.skip_existing && a.poses.empty()) refuse("--skip-existing", "needs --frames, --turntable or --poses");
        if (has_place(a.output, "frame")) refuse("--output", "{frame} needs --frames or --turntable");
        if (job.codec == Codec::kVideo && a.poses.empty())
            refuse("--output", "a video needs --frames, --turntable or --poses");
        return;
    }
    if (job.time && job.frames->plays) refuse("--time", "excludes --frames");
    if (job.frames->turning && !a.camera.empty()) refuse("--turntable", "excludes --camera");
    if (job.codec == Codec::kVideo) {
        if (has_place(a.output, "frame")) refuse("--output", "a video is one file: it has no {frame}");
        check_video(a.output, job.render.width, job.render.height, !job.render.background);
    } else if (a.output.empty() || a.output == "-" || !has_place(a.output, "frame")) {
        refuse("--output",
               "with --frames or --turntable it must say where the number goes, as in frame_{frame:04}.png");
    }
}

Codec parse_codec(const std::string& output, const PlaneTexts& planes) {
    if (!is_video(output)) {
        const std::string extension = extension_of(output);
        if (extension != "npy" && file_content(extension) == FileContent::kUnknown)
            refuse("--output", "'" + output +
                                   "' does not end in .png, .jpg, .jpeg, .webp, .tif, .tiff, .exr, .hdr or "
                                   ".npy, nor in " +
                                   video_endings());
        return Codec::kPicture;
    }
    if (planes.aov != "color") refuse("--aov", "a video shows color");
    return Codec::kVideo;
}

// Cameras of OpenCV, and of a file.
void parse_cameras(const RenderArguments& a, RenderJob& job) {
    View& view = job.render.view;
    if (!a.intrinsics.empty()) {
        if (!a.fov.empty()) refuse("--intrinsics", "excludes --fov");
        view.intrinsics = parse_intrinsics("--intrinsics", a.intrinsics);
    }
    if (a.poses.empty()) return;
    if (!a.camera.empty() || !a.eye.empty()) refuse("--poses", "excludes --camera and --eye");
    if (a.up != "y" && a.up != "z") refuse("--poses", "excludes --up X,Y,Z");
    if (!a.fov.empty()) refuse("--poses", "excludes --fov; give --intrinsics for poses without their own");
    if (job.frames && job.frames->turning) refuse("--poses", "excludes --turntable");
    job.poses = read_poses(a.poses, job.render.width, job.render.height);
    bool used = a.intrinsics.empty();
    for (Pose& pose : job.poses) {
        used = used || !pose.view.intrinsics;
        if (!pose.view.intrinsics) pose.view.intrinsics = view.intrinsics;
    }
    if (!used) refuse("--intrinsics", "all cameras of " + a.poses + " have their own");
    if (job.codec == Codec::kVideo) {
        if (job.frames && job.poses.size() > 1) refuse("--poses", "one picture of a video has one camera");
    } else if (job.poses.size() > 1 && !has_place(a.output, "camera")) {
        refuse("--output", "several cameras need {camera} in the name");
    }
}

Shadows parse_shadows(const RenderArguments& a) {
    if (a.no_shadows && !a.shadows.empty() && a.shadows != "none")
        refuse("--no-shadows", "contradicts --shadows " + a.shadows);
    if (a.no_shadows) return Shadows::kNone;
    if (a.shadows.empty()) return Shadows::kAuto;
    return choose<Shadows>("--shadows", a.shadows, {{"none", Shadows::kNone}, {"traced", Shadows::kTraced}});
}

void check_outputs(const RenderArguments& a) {
    if (a.output.empty() && a.stats.empty())
        refuse("--output", "say where the picture goes: -o FILE, or -o - for stdout");
    if (a.output == "-" && a.stats == "-") refuse("--stats", "stdout already carries the picture (-o -)");
    if (!a.output.empty() && a.output != "-" && a.output == a.stats) refuse("--stats", "is the same file as --output");
    if (a.output == "-" && isatty(STDOUT_FILENO) != 0)
        refuse("--output", "stdout is a terminal: redirect it or name a file");
}

}  // namespace

Engine parse_engine(const std::string& text) {
    return choose<Engine>("--engine", text,
                          {{"raster", Engine::kRaster},
                           {"trace", Engine::kTrace},
                           {"hybrid", Engine::kHybrid},
                           {"reference-raster", Engine::kReferenceRaster},
                           {"reference-trace", Engine::kReferenceTrace}});
}

void add_picture_options(CLI::App& app, RenderArguments& a) {
    const OptionAdder option(app);
    option("Input and output", "--quality", a.quality, "1..100", "quality of JPEG (default 92)");
    option("Input and output", "--png-level", a.png_level, "0..12", "0 stores, 12 is smallest and slowest (default 1)");
    option("Input and output", "--color-bits", a.planes.color_bits, "R-G-B",
           "reduce to so many bits a channel, such as 3-3-2");
    option("Input and output", "--palette", a.planes.palette, "N",
           "reduce to so many colours that fit, 2 .. 256 (PNG)");
    app.add_flag("--dither", a.planes.dither, "with --palette: mix colours in fine patterns")
        ->group("Input and output");
    option("Planes", "--aov", a.planes.aov, "LIST",
           "planes to write, and only these are computed (default color): color, alpha, depth, normal, shading-normal, "
           "uv, position, albedo, node, material, primitive, motion, motion-seen. A file each, {aov} in the name tells "
           "which; or one .exr with named channels. .npy and .exr hold every number as it is; .png ids as R + 256 G + "
           "65536 B, depth in steps of --depth-scale, normals as colours");
    option("Planes", "--depth", a.depth, "NAME", "planar (default: along the view axis) or euclidean (to the eye)");
    option("Planes", "--depth-scale", a.planes.depth_scale, "N", "steps a metre of depth in PNG (default 1000)");
    option("Planes", "--space", a.space, "NAME",
           "of normals and positions: world (default), camera (Y up, looking along -Z) or opencv (Y down, along Z)");
    option("Planes", "--colormap", a.planes.colormap, "NAME",
           "planes of one number as pictures: viridis, magma, turbo, grey, or ids (a colour for each number)");
    option("Planes", "--range", a.planes.range, "LOW,HIGH", "of the colormap (default: what the picture has)");
    app.add_flag("-q,--quiet", a.quiet, "nothing on stderr but errors")->group("Input and output");

    option("Picture", "-s,--size", a.size, "WxH", "size in pixels (default 1024x768)");
    option("Picture", "--variant", a.variant, "NAME|INDEX", "the scene's set of materials of that name");
    option("Picture", "--engine", a.engine, "NAME",
           "raster (the default), trace (rays: shadows, mirrors, glass), hybrid (raster for what is seen, rays for its "
           "light), reference-raster or reference-trace (plain and slow: what the others are held to)");
    option("Picture", "--samples", a.samples, "N", "samples per pixel, 1 .. 256 (default 4)");
    option("Picture", "--filter", a.filter, "NAME",
           "box (default: the mean of a pixel's samples), tent, gaussian or mitchell, which weigh its neighbours' too");
    option("Picture", "--point-size", a.point_size, "PX", "diameter of points in pixels, 0.1 .. 256 (default 2)");
    option("Picture", "--line-width", a.line_width, "PX", "width of lines in pixels, 0.1 .. 256 (default 1)");
    option("Picture", "--show", a.show, "STAGE",
           "draw a stage of the rasterizer in false colours instead: bins, hiz, overdraw or cost");
    option("Picture", "--background", a.background, "COLOUR",
           "none (transparent), #rrggbb, #rrggbbaa, r,g,b[,a] (each 0 .. 1) or a name (default white)");
    option("Picture", "--exposure", a.exposure, "EV", "auto (default), or stops: each doubles the brightness");
    option("Picture", "--tone-map", a.tone_map, "NAME", "neutral (Khronos PBR Neutral, default), aces or none");
    option("Picture", "--encoding", a.encoding, "NAME",
           "srgb (default), or linear: 8-bit linear values, to compare with renderers that do not encode");

    option("Animation", "--time", a.time, "S", "seconds into the animation (default: the scene as it stands)");
    option("Animation", "--animation", a.animation, "NAME|INDEX|all", "which one plays (default: the first)");
    option("Animation", "--frames", a.frames, "A-B",
           "pictures number A to B, at A/fps to B/fps seconds; -o then says where the number goes: f_{frame:04}.png");
    option("Animation", "--turntable", a.turntable, "N",
           "N views, number 0 to N-1, of a full turn around the scene; with --frames the animation plays meanwhile");
    option("Animation", "--fps", a.fps, "N", "frames per second (default 24)");

    option("Camera", "--camera", a.camera, "NAME|INDEX", "one of the scene's cameras (default: the first)");
    option("Camera", "--eye", a.eye, "X,Y,Z", "stand here instead (default: three-quarter view of the whole)");
    option("Camera", "--target", a.target, "X,Y,Z", "look at this point (default: the middle of the scene)");
    option("Camera", "--up", a.up, "y|z|X,Y,Z",
           "y (default), z for files whose up axis is Z, or the camera's up direction");
    option("Camera", "--fov", a.fov, "DEGREES", "vertical field of view (default 35)");
    option("Camera", "--intrinsics", a.intrinsics, "FX,FY,CX,CY",
           "the lens in pixels as OpenCV has it, where (0, 0) is the centre of the top left pixel");
    option("Camera", "--poses", a.poses, "FILE.json",
           "a picture from each camera of the file, {camera} in the name (docs/labels.md; transforms.json works, too)");

    option("Light", "--lighting", a.lighting, "NAME", "auto (default), scene (only its own lights) or studio");
    option("Light", "--ambient", a.ambient, "X", "uniform ambient radiance");
    option("Light", "--shadows", a.shadows, "KIND", "none, or traced (default but for --engine raster)");
    app.add_flag("--no-shadows", a.no_shadows, "the same as --shadows none")->group("Light");
    option("Light", "--max-depth", a.max_depth, "N",
           "how often traced light is mirrored or refracted at most, 0 .. 64 (default 8)");
    option("Light", "--min-contribution", a.min_contribution, "X",
           "part of a sample's light below which it is not followed, 0 .. 1 (default 0.002)");

    option("Machine", "--threads", a.threads, "N", "threads to use (default: all this process may)");
    option("Machine", "--isa", a.isa, "NAME", "auto (default), scalar, sse4, avx2 or avx512; the picture is the same");

    option("Limits", "--max-triangles", a.max_triangles, "N", "refuse scenes with more (default 16777216)");
    option("Limits", "--max-pixels", a.max_pixels, "N", "refuse larger textures (default 67108864) or pictures");
    option("Limits", "--max-memory", a.max_memory, "BYTES",
           "memory for the scene (default 1G), and as much for the frame (default 4G)");
    option("Limits", "--timeout", a.timeout, "S", "give up after so many seconds (exit code 6)");
}

void add_render_options(CLI::App& app, RenderArguments& a) {
    const OptionAdder option(app);
    option("Input and output", "scene", a.scene, "",
           "scene file (.gltf, .glb, .obj, .ply, .stl, .zip), or - to read it from stdin")
        ->required();
    option("Input and output", "-o,--output", a.output, "FILE",
           "picture to write: .png, .jpg, .webp, .tif, or linear .exr, .hdr; .npy for --aov; - streams PNG to stdout; "
           ".mp4, .mov, .mkv, .webm or .gif: a video");
    option("Input and output", "--stats", a.stats, "FILE", "write statistics as JSON to FILE, or to stdout with -");
    add_picture_options(app, a);
    app.add_flag("--skip-existing", a.skip_existing,
                 "with --frames or --turntable: leave out pictures that are there already")
        ->group("Animation");

    app.footer(
        "Examples:\n"
        "  tessera render model.glb -o model.png\n"
        "  tessera render model.glb -o - -s 256x256 --background none > thumbnail.png\n"
        "  tessera render room.gltf -o room.jpg --engine reference-trace --camera front --samples 16\n"
        "  tessera render robot.glb -o walk_{frame:03}.png --frames 0-47 --animation Walk\n"
        "  tessera render model.glb -o turn.mp4 --turntable 72 -s 640x480\n"
        "  tessera render model.glb -o labels.exr --aov color,depth,normal,node\n"
        "  tessera render room.glb -o {camera}_{aov}.npy --aov depth,position --poses cameras.json\n"
        "  tessera render model.glb -o model.png --eye 3,2,4 --target 0,1,0 --fov 35 --stats model.json\n"
        "\nThe color_hash of --stats is the same on every machine, for every --isa and for every --threads.");
}

RenderJob parse_render_arguments(const RenderArguments& a) {
    RenderJob job;
    RenderOptions& render = job.render;
    check_outputs(a);
    job.codec = parse_codec(a.output, a.planes);
    job.planes = parse_planes(a.planes, job.codec == Codec::kVideo ? std::string() : a.output);
    want_planes(job.planes, render);
    if (file_content(job.planes.extension) == FileContent::kLinear) {
        const std::string why = "is for pictures of 8 bits; ." + job.planes.extension + " holds linear radiance";
        if (a.background != "white" && a.background != "none") refuse("--background", why);
        if (a.tone_map != "neutral") refuse("--tone-map", why);
        if (a.encoding != "srgb") refuse("--encoding", why);
    }
    EncodeOptions& encode = job.planes.encode;
    encode.jpeg_quality = encode.webp.quality = static_cast<int>(parse_integer("--quality", a.quality, 1, 100));
    encode.png.level = static_cast<int>(parse_integer("--png-level", a.png_level, 0, 12));
    render.euclidean_depth = choose<bool>("--depth", a.depth, {{"planar", false}, {"euclidean", true}});
    render.label_space = choose<LabelSpace>(
        "--space", a.space,
        {{"world", LabelSpace::kWorld}, {"camera", LabelSpace::kCamera}, {"opencv", LabelSpace::kOpenCvCamera}});
    if (a.depth != "planar" && !render.want_depth) refuse("--depth", "needs --aov depth");
    if (a.space != "world" && !(render.want_normal || render.want_shading_normal || render.want_position))
        refuse("--space", "needs --aov normal, shading-normal or position");

    const Size size = parse_size("--size", a.size);
    render.width = size.width, render.height = size.height;
    render.engine = parse_engine(a.engine);
    render.samples = static_cast<int>(parse_integer("--samples", a.samples, 1, 256));
    render.filter = choose<PixelFilter>("--filter", a.filter,
                                        {{"box", PixelFilter::kBox},
                                         {"tent", PixelFilter::kTent},
                                         {"gaussian", PixelFilter::kGaussian},
                                         {"mitchell", PixelFilter::kMitchell}});
    render.point_size = static_cast<float>(parse_number("--point-size", a.point_size, 0.1, 256));
    render.line_width = static_cast<float>(parse_number("--line-width", a.line_width, 0.1, 256));
    render.show = parse_stage(a, render);
    render.background = parse_background("--background", a.background);
    if (a.exposure != "auto") render.exposure_ev = static_cast<float>(parse_number("--exposure", a.exposure, -40, 40));
    render.tone_map = choose<ToneMap>(
        "--tone-map", a.tone_map, {{"neutral", ToneMap::kNeutral}, {"aces", ToneMap::kAces}, {"none", ToneMap::kNone}});
    render.encoding =
        choose<Encoding>("--encoding", a.encoding, {{"srgb", Encoding::kSrgb}, {"linear", Encoding::kLinear}});
    job.camera = a.camera;
    job.variant = a.variant;
    parse_animation(a, job);
    render.view = parse_view(a, job.z_is_up);
    parse_cameras(a, job);

    render.lighting =
        choose<Lighting>("--lighting", a.lighting,
                         {{"auto", Lighting::kAuto}, {"scene", Lighting::kScene}, {"studio", Lighting::kStudio}});
    if (!a.ambient.empty()) render.ambient = static_cast<float>(parse_number("--ambient", a.ambient, 0, 1e9));
    render.shadows = parse_shadows(a);
    render.max_depth = static_cast<int>(parse_integer("--max-depth", a.max_depth, 0, 64));
    render.min_contribution = static_cast<float>(parse_number("--min-contribution", a.min_contribution, 0, 1));

    if (!a.threads.empty()) render.threads = static_cast<int>(parse_integer("--threads", a.threads, 1, 1024));
    render.isa = parse_isa(a.isa);

    job.load.threads = render.threads;
    if (!a.max_triangles.empty())
        job.load.max_triangles =
            static_cast<std::uint64_t>(parse_integer("--max-triangles", a.max_triangles, 0, INT64_MAX));
    if (!a.max_pixels.empty())
        job.max_picture = job.load.max_pixels =
            static_cast<std::uint64_t>(parse_integer("--max-pixels", a.max_pixels, 1, INT64_MAX));
    if (!a.max_memory.empty()) job.load.max_bytes = render.max_bytes = parse_bytes("--max-memory", a.max_memory);
    if (!a.timeout.empty()) job.timeout = parse_number("--timeout", a.timeout, 0.001, 1e9);
    return job;
}

}  // namespace tessera::cli
