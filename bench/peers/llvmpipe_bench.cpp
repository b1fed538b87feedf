// The workloads of bench/workloads.h on Mesa's llvmpipe, OpenGL ES 3.0 without a display:
//     tessera_llvmpipe_bench WORKLOAD [FRAMES [WIDTH HEIGHT]]        LP_NUM_THREADS=0: in the calling thread
// A frame is clear, draw and glFinish, RGBA8 and 32-bit float depth, static buffers. Prints one JSON object: wall
// and processor time of a frame, and the pixels covered, which an extra frame in plain white counts.
#include "bench/workloads.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GLES3/gl3.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <glm/gtc/type_ptr.hpp>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

enum class Look { kLit, kTextured, kFlat, kDepthOnly, kWhite };

struct Workload {
    wl::Mesh mesh;
    wl::Camera camera;
    Look look;
    bool clip_space;
};

Workload make_workload(std::string name, int w, int h) {
    Look look = Look::kLit;
    if (name.rfind("depth_", 0) == 0) {
        look = Look::kDepthOnly;
        name = name.substr(6);
    }
    if (name == "sphere1m") return {wl::sphere(500), wl::sphere_camera(w, h), look, false};
    if (name == "sphere100k") return {wl::sphere(158), wl::sphere_camera(w, h), look, false};
    if (name == "sphere10k") return {wl::sphere(50), wl::sphere_camera(w, h), look, false};
    if (name == "terrain1m") return {wl::terrain(707), wl::terrain_camera(w, h), look, false};
    if (name == "terrain100k") return {wl::terrain(224), wl::terrain_camera(w, h), look, false};
    if (look == Look::kLit) {
        if (name == "soup20k") return {wl::soup(20000, 8, w, h), wl::soup_camera(w, h), Look::kTextured, false};
        if (name == "quads_f2b") return {wl::quads(20, 1, w, h), {}, Look::kFlat, true};
        if (name == "quads_b2f") return {wl::quads(20, -1, w, h), {}, Look::kFlat, true};
    }
    throw std::runtime_error("no such workload: " + name);
}

// --- EGL and shaders ---------------------------------------------------------------------------

void make_context() {
    const auto get_display =
        reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(eglGetProcAddress("eglGetPlatformDisplayEXT"));
    if (!get_display) throw std::runtime_error("EGL has no platform displays");
    const EGLDisplay display = get_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
    if (!eglInitialize(display, nullptr, nullptr)) throw std::runtime_error("EGL cannot start without a display");
    eglBindAPI(EGL_OPENGL_ES_API);
    const EGLint wanted[] = {EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE, EGL_OPENGL_ES3_BIT, EGL_NONE};
    EGLConfig config{};
    EGLint count = 0;
    eglChooseConfig(display, wanted, &config, 1, &count);
    const EGLint version[] = {EGL_CONTEXT_MAJOR_VERSION, 3, EGL_CONTEXT_MINOR_VERSION, 0, EGL_NONE};
    const EGLContext context = eglCreateContext(display, count > 0 ? config : nullptr, EGL_NO_CONTEXT, version);
    if (!context || !eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context))
        throw std::runtime_error("no context of OpenGL ES 3.0");
}

constexpr const char* kVertexShader = R"(#version 300 es
precision highp float;
layout(location=0) in vec3 position; layout(location=1) in vec3 normal; layout(location=2) in vec2 uv;
uniform mat4 mvp;
out vec3 n; out vec3 p; out vec2 t;
void main() { gl_Position = mvp * vec4(position, 1.0); n = normal; p = position; t = uv; }
)";

// Clip space itself; the normal is the colour.
constexpr const char* kLayerVertexShader = R"(#version 300 es
precision highp float;
layout(location=0) in vec3 position; layout(location=1) in vec3 normal;
flat out vec4 color;
void main() { gl_Position = vec4(position, 1.0); color = vec4(normal, 0.5); }
)";

constexpr const char* kLitShader = R"(
in vec3 n; in vec3 p; in vec2 t; out vec4 o;
uniform vec3 eye; uniform vec3 light; uniform sampler2D picture;
void main() {
    vec3 N = normalize(n), L = normalize(light - p), V = normalize(eye - p), H = normalize(L + V);
    float d = max(dot(N, L), 0.0), s = pow(max(dot(N, H), 0.0), 32.0);
    vec3 a = ALBEDO;
    o = vec4(a * (0.1 + 0.9 * d) + vec3(0.4 * s), 1.0);
}
)";

std::string fragment_shader(Look look) {
    const std::string head = "#version 300 es\nprecision highp float;\n";
    switch (look) {
        case Look::kLit:
            return head + "#define ALBEDO vec3(0.8, 0.5, 0.3)\n" + kLitShader;
        case Look::kTextured:
            return head + "#define ALBEDO texture(picture, t).rgb\n" + kLitShader;
        case Look::kFlat:
            return head + "flat in vec4 color; out vec4 o; void main() { o = color; }\n";
        case Look::kDepthOnly:
            return head + "void main() {}\n";
        case Look::kWhite:
            break;
    }
    return head + "out vec4 o; void main() { o = vec4(1.0); }\n";
}

GLuint compile(GLenum kind, const std::string& text) {
    const GLuint shader = glCreateShader(kind);
    const char* source = text.c_str();
    glShaderSource(shader, 1, &source, nullptr);
    glCompileShader(shader);
    GLint compiled = 0;
    glGetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
    if (compiled) return shader;
    char log[2000];
    glGetShaderInfoLog(shader, sizeof log, nullptr, log);
    throw std::runtime_error(std::string("a shader does not compile: ") + log);
}

GLuint make_program(const Workload& w, Look look) {
    const GLuint program = glCreateProgram();
    glAttachShader(program, compile(GL_VERTEX_SHADER, w.clip_space ? kLayerVertexShader : kVertexShader));
    glAttachShader(program, compile(GL_FRAGMENT_SHADER, fragment_shader(look)));
    glLinkProgram(program);
    GLint linked = 0;
    glGetProgramiv(program, GL_LINK_STATUS, &linked);
    if (!linked) throw std::runtime_error("a program does not link");
    glUseProgram(program);
    if (!w.clip_space) {
        glUniformMatrix4fv(glGetUniformLocation(program, "mvp"), 1, GL_FALSE, glm::value_ptr(w.camera.mvp));
        glUniform3fv(glGetUniformLocation(program, "eye"), 1, glm::value_ptr(w.camera.eye));
        glUniform3fv(glGetUniformLocation(program, "light"), 1, glm::value_ptr(w.camera.light));
    }
    return program;
}

// --- buffers -----------------------------------------------------------------------------------

void upload_mesh(const wl::Mesh& mesh) {
    GLuint array = 0, buffers[2];
    glGenVertexArrays(1, &array);
    glBindVertexArray(array);
    glGenBuffers(2, buffers);
    glBindBuffer(GL_ARRAY_BUFFER, buffers[0]);
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(mesh.v.size() * 4), mesh.v.data(), GL_STATIC_DRAW);
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, buffers[1]);
    glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(mesh.idx.size() * 4), mesh.idx.data(),
                 GL_STATIC_DRAW);
    const int components[3] = {3, 3, 2};
    const std::size_t offsets[3] = {0, 12, 24};
    for (GLuint i = 0; i < 3; ++i) {
        glEnableVertexAttribArray(i);
        glVertexAttribPointer(i, components[i], GL_FLOAT, GL_FALSE, 32, reinterpret_cast<const void*>(offsets[i]));
    }
}

void upload_texture() {
    GLuint texture = 0;
    glGenTextures(1, &texture);
    glBindTexture(GL_TEXTURE_2D, texture);
    const std::vector<std::uint8_t> pixels = wl::texture();
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, 1024, 1024, 0, GL_RGBA, GL_UNSIGNED_BYTE, pixels.data());
    glGenerateMipmap(GL_TEXTURE_2D);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
}

void make_framebuffer(int width, int height) {
    GLuint framebuffer = 0, planes[2];
    glGenFramebuffers(1, &framebuffer);
    glGenRenderbuffers(2, planes);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    const GLenum formats[2] = {GL_RGBA8, GL_DEPTH_COMPONENT32F};
    const GLenum places[2] = {GL_COLOR_ATTACHMENT0, GL_DEPTH_ATTACHMENT};
    for (int i = 0; i < 2; ++i) {
        glBindRenderbuffer(GL_RENDERBUFFER, planes[i]);
        glRenderbufferStorage(GL_RENDERBUFFER, formats[i], width, height);
        glFramebufferRenderbuffer(GL_FRAMEBUFFER, places[i], GL_RENDERBUFFER, planes[i]);
    }
    if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
        throw std::runtime_error("the framebuffer is incomplete");
}

// --- frames ------------------------------------------------------------------------------------

void draw(const Workload& w, bool color) {
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    if (!color) glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(w.mesh.idx.size()), GL_UNSIGNED_INT, nullptr);
}

std::size_t count_covered(const Workload& w, int width, int height) {
    make_program(w, Look::kWhite);
    draw(w, true);
    std::vector<std::uint8_t> pixels(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 4);
    glReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, pixels.data());
    std::size_t covered = 0;
    for (std::size_t i = 0; i < pixels.size(); i += 4) covered += pixels[i] != 0;
    return covered;
}

double now_ms(clockid_t clock) {
    timespec t{};
    clock_gettime(clock, &t);
    return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
}

void run(const std::string& name, int frames, int width, int height) {
    const Workload w = make_workload(name, width, height);
    make_context();
    upload_mesh(w.mesh);
    if (w.look == Look::kTextured) upload_texture();
    make_framebuffer(width, height);
    glViewport(0, 0, width, height);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LESS);
    if (!w.clip_space) glEnable(GL_CULL_FACE);
    glClearColor(0, 0, 0, 0);

    make_program(w, w.look);
    const bool color = w.look != Look::kDepthOnly;
    for (int i = 0; i < 3; ++i) {
        draw(w, color);
        glFinish();
    }
    std::vector<double> times;
    double cpu = 0, wall = 0;
    for (int i = 0; i < frames; ++i) {
        const double cpu_start = now_ms(CLOCK_PROCESS_CPUTIME_ID), start = now_ms(CLOCK_MONOTONIC);
        draw(w, color);
        glFinish();
        times.push_back(now_ms(CLOCK_MONOTONIC) - start);
        cpu += now_ms(CLOCK_PROCESS_CPUTIME_ID) - cpu_start;
        wall += times.back();
    }
    if (const GLenum error = glGetError(); error != GL_NO_ERROR)
        throw std::runtime_error("OpenGL error " + std::to_string(error));
    std::sort(times.begin(), times.end());
    // Last: freeing its large buffer makes glibc keep more memory, and frames of many triangles a quarter faster
    // (MALLOC_TRIM_THRESHOLD_ does the same).
    const std::size_t covered = count_covered(w, width, height);
    const char* threads = std::getenv("LP_NUM_THREADS");
    std::printf(
        "{\"workload\": \"%s\", \"renderer\": \"%s\", \"lp_num_threads\": \"%s\", \"width\": %d, \"height\": %d, "
        "\"triangles\": %zu, \"frames\": %d, \"ms_median\": %.4f, \"ms_min\": %.4f, \"cpu_ms\": %.4f, "
        "\"cpu_per_wall\": %.3f, \"pixels_covered\": %zu}\n",
        name.c_str(), reinterpret_cast<const char*>(glGetString(GL_RENDERER)), threads ? threads : "", width, height,
        w.mesh.tris(), frames, times[times.size() / 2], times.front(), cpu / frames, cpu / wall, covered);
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 2 && argc != 3 && argc != 5) {
        std::fprintf(stderr, "usage: %s WORKLOAD [FRAMES [WIDTH HEIGHT]]\n", argv[0]);
        return 2;
    }
    const int frames = argc > 2 ? std::atoi(argv[2]) : 11;
    const int width = argc > 3 ? std::atoi(argv[3]) : 1920, height = argc > 3 ? std::atoi(argv[4]) : 1080;
    if (frames < 1 || width < 1 || height < 1) {
        std::fprintf(stderr, "%s: frames, width and height must be above 0\n", argv[0]);
        return 2;
    }
    try {
        run(argv[1], frames, width, height);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s: %s\n", argv[0], error.what());
        return 1;
    }
    return 0;
}
