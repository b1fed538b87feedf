// Speed of the image module: writing and reading 1920 x 1080 PNG and JPEG, and a mip chain of a
// 2048 x 2048 texture. Prints the median wall time of 20 runs in milliseconds, and the sizes of files.
#include "core/parallel.h"
#include "image/codecs.h"
#include "image/mipmap.h"
#include "tests/image/pictures.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <string>

namespace {

using namespace tessera;

constexpr int kRepetitions = 20;

template <class F>
double median_ms(F&& work) {
    std::vector<double> times;
    for (int i = 0; i < kRepetitions; ++i) {
        const auto begin = std::chrono::steady_clock::now();
        work();
        times.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count());
    }
    std::sort(times.begin(), times.end());
    return times[times.size() / 2];
}

// A rendering whose surfaces are textured finely, or whose light is sampled: two levels of noise.
Image grainy(Image image) {
    std::mt19937 random(2);
    auto* p = image.data<std::uint8_t>();
    for (std::size_t i = 0; i < image.bytes().size(); ++i)
        if (i % 4 != 3) p[i] = static_cast<std::uint8_t>(std::clamp(p[i] + static_cast<int>(random() % 5) - 2, 0, 255));
    return image;
}

}  // namespace

int main() {
    const Image spheres = test::sphere_picture(1920, 1080);
    const std::pair<const char*, Image> pictures[] = {{"spheres", spheres},
                                                      {"spheres, alpha", test::sphere_picture(1920, 1080, true)},
                                                      {"spheres, grain", grainy(spheres)},
                                                      {"noise", test::noise_picture(1920, 1080)},
                                                      {"flat", test::flat_picture(1920, 1080, 30, 60, 90)}};
    for (const auto& picture : pictures) {
        const char* name = picture.first;
        const Image& image = picture.second;
        for (const int threads : {1, 2}) {
            Arena arena(threads);
            for (const int level : {1, 6}) {
                if (threads == 1 && level == 6) continue;
                std::size_t size = 0;
                const double ms = median_ms([&] { size = encode_png(image, {.level = level}, arena).size(); });
                std::printf("encode png  %-15s level %d  %d threads %7.1f ms  %8zu bytes\n", name, level, threads, ms,
                            size);
            }
        }
        const std::vector<std::byte> file = encode_png(image);
        std::printf("decode png  %-15s %27.1f ms\n", name, median_ms([&] { decode_image(file); }));
    }
    const std::vector<std::byte> jpeg = encode_jpeg(spheres);
    std::printf("encode jpeg %-15s %27.1f ms  %8zu bytes\n", "spheres", median_ms([&] { encode_jpeg(spheres); }),
                jpeg.size());
    std::printf("decode jpeg %-15s %27.1f ms\n", "spheres", median_ms([&] { decode_image(jpeg); }));
    for (const int side : {2048, 2047}) {
        const Image texture = test::noise_picture(side, side);
        for (const bool srgb : {true, false})
            std::printf("mip chain %d^2 %s %31.1f ms\n", side, srgb ? "srgb  " : "linear",
                        median_ms([&] { make_mip_chain(texture, srgb); }));
    }
}
