// Embedding Tessera: loads the scene named on the command line, or builds a triangle in code,
// renders it and gets at the pixels.
#include <tessera/tessera.h>

#include <cstdio>
#include <exception>

int main(int argc, char** argv) try {
    tessera::Scene scene;
    if (argc > 1) {
        scene = tessera::load_scene(argv[1]);
    } else {
        tessera::Primitive triangle;
        triangle.positions = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
        scene.meshes.resize(1);
        scene.meshes[0].primitives.push_back(triangle);
        scene.nodes.resize(1);
        scene.nodes[0].mesh = 0;
        scene.scenes.resize(1);
        scene.scenes[0].nodes = {0};
    }
    tessera::RenderOptions options;
    options.width = 320, options.height = 240;
    const tessera::RenderResult result = tessera::render(scene, options);
    const auto* center = result.color.data<unsigned char>() + 4 * (320 * 120 + 160);
    std::printf("pixels covered: %llu, centre: #%02x%02x%02x\n",
                static_cast<unsigned long long>(result.stats.pixels_covered), center[0], center[1], center[2]);
    tessera::write_image("embed.png", result.color);
} catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
