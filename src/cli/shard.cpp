#include "cli/shard.h"

#include "cli/parse.h"

#include <cstdlib>
#include <optional>

namespace tessera::cli {
namespace {

constexpr std::int64_t kMostShards = 1000000;

std::optional<long> from_environment(const char* name) {
    const char* text = std::getenv(name);
    if (text == nullptr || *text == '\0') return std::nullopt;
    return static_cast<long>(parse_integer(name, text, 0, INT64_MAX / 2));
}

// Number, from 1, and count (0: not known).
std::optional<Shard> of_the_farm() {
    if (const auto id = from_environment("SLURM_ARRAY_TASK_ID")) {
        // Arrays begin and step as their owner likes: --array=10-40:10.
        const long first = from_environment("SLURM_ARRAY_TASK_MIN").value_or(0);
        const long step = from_environment("SLURM_ARRAY_TASK_STEP").value_or(1);
        if (*id < first || step < 1 || (*id - first) % step != 0)
            refuse("SLURM_ARRAY_TASK_ID",
                   std::to_string(*id) + " is not in the array that Slurm describes; give --shard");
        return Shard{(*id - first) / step + 1, from_environment("SLURM_ARRAY_TASK_COUNT").value_or(0),
                     "SLURM_ARRAY_TASK_ID"};
    }
    if (const auto index = from_environment("JOB_COMPLETION_INDEX"))
        return Shard{*index + 1, 0, "JOB_COMPLETION_INDEX"};
    if (const auto rank = from_environment("OMPI_COMM_WORLD_RANK"))
        return Shard{*rank + 1, from_environment("OMPI_COMM_WORLD_SIZE").value_or(0), "OMPI_COMM_WORLD_RANK"};
    return std::nullopt;
}

void check(const Shard& shard) {
    if (shard.index >= 1 && shard.index <= shard.count) return;
    refuse(shard.from, "shard " + std::to_string(shard.index) + " of " + std::to_string(shard.count) +
                           ": they are numbered from 1 to the count");
}

}  // namespace

Shard parse_shard(const std::string& text) {
    if (text.empty()) {
        Shard shard = of_the_farm().value_or(Shard{});
        if (shard.count == 0) refuse(shard.from, "says which shard this is, but not of how many; give --shard auto/N");
        check(shard);
        return shard;
    }
    const std::size_t slash = text.find('/');
    if (slash == std::string::npos) refuse("--shard", "'" + text + "' is not a shard such as 3/8 or auto/8");
    Shard shard;
    shard.from = "--shard";
    shard.count = static_cast<long>(parse_integer("--shard", text.substr(slash + 1), 1, kMostShards));
    if (text.compare(0, slash, "auto") == 0) {
        const std::optional<Shard> farm = of_the_farm();
        if (!farm)
            refuse("--shard",
                   "auto needs SLURM_ARRAY_TASK_ID, JOB_COMPLETION_INDEX or OMPI_COMM_WORLD_RANK in the environment");
        shard.index = farm->index, shard.from = farm->from;
    } else {
        shard.index = static_cast<long>(parse_integer("--shard", text.substr(0, slash), 1, kMostShards));
    }
    check(shard);
    return shard;
}

}  // namespace tessera::cli
