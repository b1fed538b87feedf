// Video files: frames go as raw RGBA through a pipe to an `ffmpeg` that is looked for in PATH and started without a
// shell. The file appears under its name when it is complete, like every output. A Video belongs to one thread, the one
// that made it: when that ends, or the process does, the encoder ends with it. Throws tessera::Error: kUsage for what a
// format cannot hold, kOutput when there is no ffmpeg or it fails, kCancelled when `cancel` says so.
#pragma once

#include <tessera/image.h>

#include <functional>
#include <memory>
#include <string>

namespace tessera::cli {

// Told by the ending of the name.
bool is_video(const std::string& path);
// ".mp4, .mov, ...", for messages.
std::string video_endings();
// Refuses sizes and transparency that the format has no place for.
void check_video(const std::string& path, int width, int height, bool transparent);
// The path of ffmpeg; kOutput, naming `path`, when there is none.
std::string find_ffmpeg(const std::string& path);

struct VideoOptions {
    double fps = 24;
    bool transparent = false;  // the frames' alpha counts, where the format has a place for it
};

class Video {
  public:
    // `cancel` may be empty.
    Video(std::string path, VideoOptions options, std::function<bool()> cancel);
    // Without finish() nothing is left.
    ~Video();
    Video(const Video&) = delete;
    Video& operator=(const Video&) = delete;

    // The next frame, kRgba8; all have the size of the first.
    void add(const Image& frame);
    // Waits for the encoder and gives the file its name.
    void finish();

  private:
    struct Encoder;

    std::string path_;
    VideoOptions options_;
    std::function<bool()> cancel_;
    std::unique_ptr<Encoder> encoder_;
};

}  // namespace tessera::cli
