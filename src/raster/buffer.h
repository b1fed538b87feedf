// An array that grows and is used again: its elements are not initialised, its memory stays.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <type_traits>

namespace tessera {

template <class T>
class Buffer {
    static_assert(std::is_trivially_copyable_v<T>);

  public:
    T* data() { return data_.get(); }
    const T* data() const { return data_.get(); }
    std::size_t capacity() const { return capacity_; }
    T& operator[](std::size_t i) { return data_[i]; }
    const T& operator[](std::size_t i) const { return data_[i]; }

    // Room for `count` elements; the first `kept` of them stay.
    T* reserve(std::size_t count, std::size_t kept = 0) {
        if (count > capacity_) {
            const std::size_t larger = std::max(count, capacity_ + capacity_ / 2);
            std::unique_ptr<T[]> data(new T[larger]);
            if (kept > 0) std::copy_n(data_.get(), kept, data.get());
            data_ = std::move(data);
            capacity_ = larger;
        }
        return data_.get();
    }

  private:
    std::unique_ptr<T[]> data_;
    std::size_t capacity_ = 0;
};

}  // namespace tessera
