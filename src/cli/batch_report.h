// What happened in a batch: the report of `tessera batch --report`, as data and as JSON, which `tessera merge-report`
// reads again. Times in milliseconds of wall clock.
#pragma once

#include "cli/exit_code.h"

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tessera::cli {

// Of a file with the one of its name under --reference, from good to bad.
enum class Verdict : std::uint8_t { kEqual, kWithin, kDifferent, kOtherSize, kUnreadable, kMissing };
const char* name(Verdict verdict);

struct Comparison {
    Verdict verdict = Verdict::kEqual;
    std::string reference;   // the file that it was compared with
    std::string difference;  // the picture that was written of it; "" without
    std::uint64_t pixels = 0, differing_pixels = 0;
    bool floating = false;  // errors are in the values' own unit, not in 1/255
    double max_error = 0, mean_error = 0;
    std::optional<double> psnr;  // dB; empty: infinite, or not known

    bool failed() const { return verdict > Verdict::kWithin; }
};

struct PictureReport {
    std::string file, camera, aov;
    std::optional<long> frame;
    std::string hash;  // hash_pixels() of its plane; "" when it was skipped, or has several
    int width = 0, height = 0;
    bool skipped = false;  // it was there already
    std::optional<Comparison> comparison;
};

enum class SceneStatus : std::uint8_t { kDone, kSkipped, kFailed };

struct SceneReport {
    std::string file;
    std::uint64_t number = 0;  // in the list of all shards, from 0
    SceneStatus status = SceneStatus::kDone;
    int exit_code = kFine;
    std::string error;  // one line
    double load_ms = 0, render_ms = 0, encode_ms = 0;
    std::vector<PictureReport> pictures;
    std::vector<std::string> warnings;
};

struct BatchReport {
    std::map<std::string, std::string> options;  // as they were given
    std::uint64_t list_scenes = 0;               // of all shards
    std::string list_hash;                       // of their names
    std::vector<long> shards{1};                 // those in here, from 1
    long shard_count = 1;
    std::string shard_by = "scene";
    int threads = 1, in_flight = 1;
    double wall_ms = 0;  // of the longest shard
    double peak_rss_mb = 0;
    std::vector<SceneReport> scenes;  // by number
};

struct BatchTotals {
    std::uint64_t done = 0, skipped = 0, failed = 0;                         // scenes
    std::uint64_t written = 0, already_there = 0, compared = 0, differ = 0;  // pictures
};
BatchTotals totals(const BatchReport& report);
// That of the first scene that failed, else 3 where pictures differ, else 0.
int exit_code(const BatchReport& report);
// For people: one or two sentences.
std::string summary(const BatchReport& report);

std::string report_json(const BatchReport& report);
// Throws kInput, naming `file`, for what is no such report.
BatchReport read_report(const std::string& file);

}  // namespace tessera::cli
