// Numbered pictures of one scene: of an animation (--frames), of a turntable (--turntable), or of both at once. Picture
// k is at k / fps seconds and at k / views of a full turn.
#pragma once

#include <tessera/render.h>

#include <optional>
#include <string>

namespace tessera::cli {

struct Frames {
    long first = 0, last = 0;
    double fps = 24;
    bool plays = true;            // else the animation stands still
    std::optional<long> turning;  // views in a full turn

    long count() const { return last - first + 1; }
    Moment moment(Moment start, long frame) const;
    View view(View first_view, long frame) const;
};

// What --frames, --fps and --turntable say; empty without them.
std::optional<Frames> parse_frames(const std::string& frames, const std::string& fps, const std::string& turntable);

}  // namespace tessera::cli
