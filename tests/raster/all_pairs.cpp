#include "raster/all_pairs.h"

#include <algorithm>

namespace tessera::test {
namespace {

// Which pairs no row has yet.
class Uncovered {
  public:
    explicit Uncovered(const std::vector<int>& sizes) {
        int values = 0;
        for (const int size : sizes) {
            first_.push_back(values);
            values += size;
        }
        values_ = static_cast<std::size_t>(values);
        open_.assign(values_ * values_, false);
        for (std::size_t f = 0; f < sizes.size(); ++f)
            for (std::size_t g = f + 1; g < sizes.size(); ++g)
                for (int a = 0; a < sizes[f]; ++a)
                    for (int b = 0; b < sizes[g]; ++b) set(f, a, g, b, true);
    }
    bool has(std::size_t f, int a, std::size_t g, int b) const { return open_[place(f, a, g, b)]; }
    void cover(const std::vector<int>& row) {
        for (std::size_t f = 0; f < row.size(); ++f)
            for (std::size_t g = f + 1; g < row.size(); ++g) set(f, row[f], g, row[g], false);
    }

  private:
    std::size_t place(std::size_t f, int a, std::size_t g, int b) const {
        return static_cast<std::size_t>(first_[f] + a) * values_ + static_cast<std::size_t>(first_[g] + b);
    }
    void set(std::size_t f, int a, std::size_t g, int b, bool open) {
        open_[place(f, a, g, b)] = open_[place(g, b, f, a)] = open;
    }

    std::vector<int> first_;
    std::size_t values_ = 0;
    std::vector<bool> open_;
};

// The value of factor `f` that covers most with what the row has; of equal ones the next after `last`.
int best_value(const Uncovered& uncovered, const std::vector<int>& row, std::size_t f, int size, int last) {
    int best = 0, most = -1;
    for (int i = 1; i <= size; ++i) {
        const int value = (last + i) % size;
        int covers = 0;
        for (std::size_t g = 0; g < row.size(); ++g)
            if (row[g] >= 0 && g != f) covers += uncovered.has(f, value, g, row[g]);
        if (covers > most) {
            most = covers;
            best = value;
        }
    }
    return best;
}

}  // namespace

std::vector<std::vector<int>> all_pairs(const std::vector<int>& sizes) {
    Uncovered uncovered(sizes);
    std::vector<std::vector<int>> rows;
    std::vector<int> last(sizes.size(), -1);
    for (std::size_t f = 0; f < sizes.size(); ++f)
        for (std::size_t g = f + 1; g < sizes.size(); ++g)
            for (int a = 0; a < sizes[f]; ++a)
                for (int b = 0; b < sizes[g]; ++b) {
                    if (!uncovered.has(f, a, g, b)) continue;
                    std::vector<int> row(sizes.size(), -1);
                    row[f] = a;
                    row[g] = b;
                    for (std::size_t h = 0; h < sizes.size(); ++h)
                        if (row[h] < 0) row[h] = best_value(uncovered, row, h, sizes[h], last[h]);
                    uncovered.cover(row);
                    last = row;
                    rows.push_back(std::move(row));
                }
    return rows;
}

std::vector<std::vector<int>> full_product(const std::vector<int>& sizes) {
    std::vector<std::vector<int>> rows{std::vector<int>(sizes.size(), 0)};
    for (;;) {
        std::vector<int> next = rows.back();
        std::size_t f = sizes.size();
        while (f > 0 && ++next[f - 1] == sizes[f - 1]) next[--f] = 0;
        if (f == 0) return rows;
        rows.push_back(std::move(next));
    }
}

}  // namespace tessera::test
