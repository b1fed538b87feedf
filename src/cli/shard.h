// Which part of a batch this process does: shard i of n, from --shard or from what farms put into the environment of
// their jobs: Slurm's arrays, Kubernetes' indexed jobs, MPI.
#pragma once

#include <string>

namespace tessera::cli {

struct Shard {
    long index = 1, count = 1;  // 1 <= index <= count
    std::string from;           // where it was said: "--shard", "SLURM_ARRAY_TASK_ID", ...; "" when nobody did

    bool whole() const { return count == 1; }
    // Whether the job with that number, from 0, is one of this shard: they go round.
    bool has(std::size_t number) const {
        return static_cast<long>(number % static_cast<std::size_t>(count)) == index - 1;
    }
};

// `text` is "i/n" with i from 1, "auto/n" with i from the environment, or "" for all of it from the environment. Throws
// kUsage.
Shard parse_shard(const std::string& text);

}  // namespace tessera::cli
