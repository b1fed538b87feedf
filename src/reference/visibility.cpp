#include "reference/visibility.h"

#include <tessera/error.h>

#include <algorithm>

namespace tessera {

void add_fragment(Visibility& visibility, const Fragment& fragment, const RunControl& control) {
    if (visibility.transparent.size() >= control.max_fragments)
        throw Error(ErrorCode::kLimit, "transparent surfaces need more memory than the limit allows");
    visibility.transparent.push_back(fragment);
}

void sort_transparent(Visibility& v) {
    std::erase_if(v.transparent, [&](const Fragment& f) {
        const float z = v.depth[f.pixel];
        return f.depth < z || (f.depth == z && v.triangle[f.pixel] != 0 && v.triangle[f.pixel] <= f.triangle + 1);
    });
    std::sort(v.transparent.begin(), v.transparent.end(), [](const Fragment& a, const Fragment& b) {
        if (a.pixel != b.pixel) return a.pixel < b.pixel;
        if (a.depth != b.depth) return a.depth < b.depth;
        return a.triangle > b.triangle;
    });
}

}  // namespace tessera
