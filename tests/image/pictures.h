// Pictures that the image tests and the image benchmark make for themselves.
#pragma once

#include <tessera/image.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>

namespace tessera::test {

// Every byte random.
inline Image noise_picture(int width, int height, PixelFormat format = PixelFormat::kRgba8, unsigned seed = 1) {
    Image image(width, height, format);
    std::mt19937 random(seed);
    for (std::byte& b : image.bytes()) b = static_cast<std::byte>(random() & 0xff);
    return image;
}

inline Image flat_picture(int width, int height, std::uint8_t r, std::uint8_t g, std::uint8_t b, std::uint8_t a = 255) {
    Image image(width, height, PixelFormat::kRgba8);
    auto* p = image.data<std::uint8_t>();
    for (std::size_t i = 0; i < image.bytes().size(); i += 4) p[i] = r, p[i + 1] = g, p[i + 2] = b, p[i + 3] = a;
    return image;
}

// What a renderer gives: forty shaded, glossy spheres before a gradient, or before nothing (alpha 0).
inline Image sphere_picture(int width, int height, bool transparent = false) {
    Image image(width, height, PixelFormat::kRgba8);
    auto* out = image.data<std::uint8_t>();
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x, out += 4) {
            const float sky = 0.3f * static_cast<float>(y) / static_cast<float>(height);
            float color[3] = {0.25f + sky, 0.3f + sky, 0.4f + sky};
            float nearest = -1;
            for (int s = 0; s < 40; ++s) {
                const float radius = (0.03f + 0.0015f * static_cast<float>((s * 37) % 60)) * static_cast<float>(width);
                const float dx = static_cast<float>(x - (s * 397) % width),
                            dy = static_cast<float>(y - (s * 211) % height);
                const float inside = radius * radius - dx * dx - dy * dy;
                if (inside < 0) continue;
                const float depth = std::sqrt(inside) + 10 * static_cast<float>(s);
                if (depth <= nearest) continue;
                nearest = depth;
                const float light = std::fmax(0.0f, (-0.5f * dx - 0.6f * dy + 0.62f * std::sqrt(inside)) / radius);
                const float gloss = 0.5f * std::pow(light, 40.0f);
                const int hue[3] = {s % 7, s % 5, s % 4};
                for (int c = 0; c < 3; ++c)
                    color[c] = 0.05f + light * (0.2f + 0.12f * static_cast<float>(hue[c])) + gloss;
            }
            const bool hit = nearest >= 0 || !transparent;
            for (int c = 0; c < 3; ++c)
                out[c] =
                    hit ? static_cast<std::uint8_t>(255 * std::pow(std::fmin(1.0f, color[c]), 1 / 2.2f) + 0.5f) : 0;
            out[3] = hit ? 255 : 0;
        }
    return image;
}

inline bool same_pixels(const Image& a, const Image& b) {
    return a.width() == b.width() && a.height() == b.height() && a.format() == b.format() &&
           std::equal(a.bytes().begin(), a.bytes().end(), b.bytes().begin(), b.bytes().end());
}

}  // namespace tessera::test
